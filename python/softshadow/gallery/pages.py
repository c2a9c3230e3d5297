"""All exhibits and the page that shows them."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from softshadow.device import context
from softshadow.logs import adapter_words

from .exhibit import Exhibit, Panel
from .lamps import shapes, textures
from .maps import forks, growing, stairs
from .matter import counters, foliage, glass
from .penumbra import concavities, penumbrae
from .samples import areas, silhouettes, spreads
from .studio import Studio

EXHIBITS: dict[str, Callable[[Studio], Exhibit]] = {
    exhibit.__name__: exhibit
    for exhibit in (
        silhouettes,
        spreads,
        textures,
        glass,
        areas,
        counters,
        shapes,
        foliage,
        penumbrae,
        concavities,
        growing,
        forks,
        stairs,
    )
}
"""Every exhibit by its name, in the order in which they hang; `guests` only where pygfx is installed."""

if find_spec("pygfx") is not None:
    from .guests import guests

    EXHIBITS["guests"] = guests

_INTRODUCTION = """\
# Gallery

Made by `softshadow gallery`, after the figures of V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by Depth
Complexity Sampling", 2008, of C. Wyman, C. Hansen, "Penumbra Maps", 2003, and of Q. Mo, V. Popescu, C. Wyman, "The Soft
Shadow Occlusion Camera", 2007.
Milliseconds are those of one whole picture by compiled kernels on a prepared scene, taken
once; RMSE is that of visibility over the penumbra, against a reference of many rays. In differences red is too bright,
blue too dark. Times are those of {device}."""


def make(
    folder: Path, names: Sequence[str], studio: Studio, on_exhibit: Callable[[Exhibit, float], None]
) -> dict[str, Any]:
    """Writes the named exhibits, or all, with a page ``index.md``; tells of each when it is done, with its seconds.

    Returns the page's path, the device, and what was measured, by exhibit and panel.
    """
    folder.mkdir(parents=True, exist_ok=True)
    adapter = json.loads(context(studio.device).adapter)
    # The processor alone draws no triangles.
    stand_in = "; hard shadows are drawn by a software driver" if adapter["device_type"] == "native" else ""
    device = adapter_words(adapter) + stand_in
    pages, measured = [_INTRODUCTION.format(device=device)], {}
    for name in names or EXHIBITS:
        begun = time.perf_counter()
        exhibit = EXHIBITS[name](studio)
        exhibit.save(folder)
        pages.append(exhibit.page())
        measured[name] = {panel.name: _numbers(panel) for panel in exhibit.panels if panel.numbers}
        on_exhibit(exhibit, time.perf_counter() - begun)
    page = folder / "index.md"
    page.write_text("\n\n".join(pages) + "\n", encoding="utf-8")
    return {"page": str(page), "device": device, "exhibits": measured}


def _numbers(panel: Panel) -> dict[str, float | None]:
    """JSON has no word for an error where there is no penumbra."""
    rmse = None if panel.rmse is None or math.isnan(panel.rmse) else panel.rmse
    return {"ms": panel.ms, "rmse": rmse}
