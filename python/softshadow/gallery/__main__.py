"""Makes the gallery: ``python -m softshadow.gallery --output gallery``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from softshadow.device import quiet_driver

from . import EXHIBITS, Studio

_INTRODUCTION = """\
# Gallery

Made by `python -m softshadow.gallery`, after the figures of V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by
Depth Complexity Sampling", 2008, and of Q. Mo, V. Popescu, C. Wyman, "The Soft Shadow Occlusion Camera", 2007.
Milliseconds are those of one whole picture by compiled kernels on a prepared scene, taken once; RMSE is that of
visibility over the penumbra, against a reference of many rays. In differences red is too
bright, blue too dark."""


def main() -> int:
    """Makes the exhibits named, or all; the exit code is 0."""
    quiet_driver()
    parser = argparse.ArgumentParser(prog="softshadow.gallery", description=__doc__)
    parser.add_argument("exhibits", nargs="*", metavar="EXHIBIT", help=f"default: all of {', '.join(_BY_NAME)}")
    parser.add_argument("--output", type=Path, default=Path("gallery"))
    parser.add_argument("--device", default="auto")
    chosen = parser.parse_args()
    if unknown := [name for name in chosen.exhibits if name not in _BY_NAME]:
        parser.error(f"unknown exhibit {unknown[0]!r}; there are {', '.join(_BY_NAME)}")
    chosen.output.mkdir(parents=True, exist_ok=True)
    studio = Studio(device=chosen.device)
    pages = [_INTRODUCTION]
    for name in chosen.exhibits or _BY_NAME:
        begun = time.perf_counter()
        exhibit = _BY_NAME[name](studio)
        exhibit.save(chosen.output)
        pages.append(exhibit.page())
        measured = "; ".join(f"{panel.name}: {panel.numbers}" for panel in exhibit.panels if panel.numbers)
        print(f"{name}, {time.perf_counter() - begun:.1f} s: {measured}", flush=True)
    page = chosen.output / "index.md"
    page.write_text("\n\n".join(pages) + "\n", encoding="utf-8")
    print(f"page {page}")
    return 0


_BY_NAME = {exhibit.__name__: exhibit for exhibit in EXHIBITS}


if __name__ == "__main__":
    sys.exit(main())
