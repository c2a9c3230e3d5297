"""Exhibits as values, their files, and the page that shows them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from softshadow import _core
from softshadow.files import write

_COLUMNS = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One picture of an exhibit.

    Attributes
    ----------
    name : str
        The last part of its file's name.
    caption : str
        What stands over it.
    image : uint8, (H, W, 3)
        As displayed.
    values : float, (H, W) or (H, W, 3), or None
        The numbers that it shows: visibility, errors or layers; NaN where there are none.
    ms, rmse : float or None
        Time of the picture, and its error in the penumbra.
    """

    name: str
    caption: str
    image: NDArray[np.uint8]
    values: NDArray[np.float32] | None = None
    ms: float | None = None
    rmse: float | None = None

    @property
    def numbers(self) -> str:
        """What was measured, in words."""
        rmse = [] if self.rmse is None else [f"RMSE {self.rmse:.4f}"]
        return ", ".join(rmse + ([] if self.ms is None else [f"{self.ms:.0f} ms"]))


@dataclass(frozen=True, kw_only=True, eq=False)
class Exhibit:
    """Pictures that show one thing.

    Attributes
    ----------
    name, title : str
        What files and the page call it.
    look : str
        One sentence: what to look at.
    panels : tuple of Panel
        The pictures in order.
    notes : tuple of str
        What else was measured.
    """

    name: str
    title: str
    look: str
    panels: tuple[Panel, ...]
    notes: tuple[str, ...] = field(default=())

    def __getitem__(self, name: str) -> Panel:
        return next(panel for panel in self.panels if panel.name == name)

    def save(self, folder: Path) -> None:
        """Writes a PNG for each panel."""
        for panel in self.panels:
            height, width, _ = panel.image.shape
            write(folder / self.file(panel), _core.png_srgb8(panel.image.ravel(), (width, height)))

    def file(self, panel: Panel) -> str:
        """The name of a panel's file."""
        return f"{self.name}_{panel.name}.png"

    def page(self) -> str:
        """Markdown: the sentence, and the pictures in rows of three with captions and numbers."""
        rows = [self.panels[i : i + _COLUMNS] for i in range(0, len(self.panels), _COLUMNS)]
        tables = [
            "\n".join(
                (
                    _row(panel.caption for panel in row),
                    _row("---" for _ in row),
                    _row(f"![{panel.caption}]({self.file(panel)})" for panel in row),
                    _row(panel.numbers for panel in row),
                )
            )
            for row in rows
        ]
        return "\n\n".join((f"## {self.title}", self.look, *tables, *self.notes))


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
