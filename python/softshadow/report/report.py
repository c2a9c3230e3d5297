"""A report as a value, and its files."""

from __future__ import annotations

import json
import os
import platform
import re
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from softshadow import _core
from softshadow._core import __version__
from softshadow.comparison import Comparison
from softshadow.errors import OutputError, SettingsError

from .charts import alone
from .fronts import front
from .lines import Line, absent_of, peers_of, ratios_of
from .page import page

_SCALE = 2.5
"""Of PNGs: figures are 480 units wide."""


@dataclass(frozen=True, eq=False)
class Report:
    """Comparisons, and what was measured beside them.

    Parameters
    ----------
    comparisons : list of Comparison
        A section each, in this order. Those of one name that differ in the size of their light, their triangles or
        their receivers alone also make growth curves.
    growth : list of Comparison
        More of them that serve as points of growth curves alone.
    lines : list of dict
        Lines of :func:`read_lines`: other tracers of ``python -m softshadow.bench.peers --json FILE``, published ratios
        of ``softshadow-bench --ratios --json FILE``, and what was skipped or failed there. Lines of other kinds are
        left out.
    title : str
        The heading.

    Raises
    ------
    SettingsError
        For anything else, and for lines that lack what their kind has.
    """

    comparisons: Sequence[Comparison]
    _: KW_ONLY
    growth: Sequence[Comparison] = ()
    lines: Sequence[Line] = ()
    title: str = "Speed against error"

    def __post_init__(self) -> None:
        for what, given in (("comparisons", self.comparisons), ("growth", self.growth)):
            if not isinstance(given, (list, tuple)) or not all(isinstance(one, Comparison) for one in given):
                raise SettingsError(f"{what}: a list of Comparison expected, got {given!r:.80}")
        if not self.comparisons:
            raise SettingsError("comparisons: at least one expected")
        # Lines that lack something are told of here.
        self.to_dict()

    def to_dict(self) -> dict[str, Any]:
        """All numbers of the report."""
        return {
            "title": self.title,
            "version": __version__,
            "made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
            "system": {"system": platform.system(), "machine": platform.machine(), "threads": os.cpu_count()},
            "comparisons": [
                {"id": identity, "title": title, **comparison.to_dict()}
                for comparison, identity, title in zip(
                    self.comparisons, _identities(self.comparisons), _titles(self.comparisons), strict=True
                )
            ],
            "growth": [comparison.to_dict() for comparison in self.growth],
            "peers": peers_of(self.lines),
            "ratios": ratios_of(self.lines),
            "absent": absent_of(self.lines),
        }

    def to_html(self) -> str:
        """The page: one file, which fetches nothing."""
        return page(self.to_dict(), self.comparisons)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes ``index.html``, ``report.json``, and ``front-NAME.png`` for every comparison with a penumbra.

        Raises
        ------
        OutputError
            For what names no folder, and where it cannot be made or written to.
        """
        path = folder_of(folder)
        document = self.to_dict()
        files: dict[str, bytes] = {}
        for comparison in document["comparisons"]:
            chart = front(comparison["title"], comparison["rows"], comparison["reference_standard_error"])
            if chart is not None:
                files[f"front-{comparison['id']}.png"] = _core.svg_png(alone(chart), _SCALE)
        files["report.json"] = (json.dumps(document, indent=1, allow_nan=False) + "\n").encode()
        # Last, so that a page is never older than its numbers.
        files["index.html"] = page(document, self.comparisons).encode()
        try:
            path.mkdir(parents=True, exist_ok=True)
            for name, content in files.items():
                (path / name).write_bytes(content)
        except OSError as error:
            raise OutputError(f"{os.fspath(folder)}: {error.strerror or error}") from error


def folder_of(folder: object) -> Path:
    """A path that names a folder."""
    try:
        path = Path(os.fsdecode(folder))  # type: ignore[arg-type]
        os.fsencode(path)
    except (TypeError, UnicodeError):
        raise OutputError(f"folder: a path expected, got {folder!r:.80}") from None
    if "\0" in str(path):
        raise OutputError(f"folder: a path without null characters expected, got {folder!r:.80}")
    return path


def _identities(comparisons: Sequence[Comparison]) -> list[str]:
    """A short word for each, safe in addresses and names of files, that no other has."""
    reserved = ["summary", "growth", "peers", "ratios"]
    words: list[str] = []
    for comparison in comparisons:
        word = own = re.sub(r"[^a-z0-9]+", "-", comparison.name.lower()).strip("-")[:40] or "scene"
        count = 1
        while word in words or word in reserved:
            count += 1
            word = f"{own}-{count}"
        words.append(word)
    return words


def _titles(comparisons: Sequence[Comparison]) -> list[str]:
    """The name, and what tells it from others of that name."""
    titles = []
    for comparison in comparisons:
        alike = [other for other in comparisons if other.name == comparison.name]
        parts = [comparison.name]
        if len({(other.reference["receivers"], *(other.size or ())) for other in alike}) > 1:
            size = comparison.size
            parts.append(f"{size[0]} × {size[1]}" if size else f"{comparison.reference['receivers']:,} points")
        if len({other.triangles for other in alike}) > 1:
            parts.append(f"{comparison.triangles:,} triangles")
        if len({(other.light["shape"], other.light["extent"]) for other in alike}) > 1:
            parts.append(f"{comparison.light['shape']} of {comparison.light['extent']:.4g}")
        titles.append(", ".join(parts))
    return titles
