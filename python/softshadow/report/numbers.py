"""Numbers of the page: each is looked up in what ``report.json`` holds, and says where."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

NOTHING = "–"

_MIB = 1 << 20
FORMATS: dict[str, Callable[[float], str]] = {
    "ms": lambda value: f"{value:.1f}" if value < 100 else f"{value:,.0f}",
    "error": lambda value: f"{value:.4f}",
    "signed": lambda value: f"{value:+.4f}",
    "share": lambda value: f"{100 * value:.2f} %",
    "count": lambda value: f"{value:,}",
    "MiB": lambda value: f"{value / _MIB:.2f}",
    "ratio": lambda value: f"{value:.2f}",
}
"""How a number of each kind is written."""


class Numbers:
    """Writes numbers of a document into a page."""

    def __init__(self, document: dict[str, Any]) -> None:
        self._document = document

    def __call__(self, pointer: str, kind: str) -> str:
        """The number at a JSON pointer as an element whose `value` has all digits; a dash where there is none."""
        value: Any = self._document
        for step in pointer.split("/")[1:]:
            if value is None:
                break
            value = value[int(step)] if isinstance(value, list) else value[step]
        if value is None:
            return NOTHING
        text = FORMATS[kind](value)
        return f'<data value="{value!r}" data-of="{escape(pointer)}" data-kind="{kind}">{text}</data>'
