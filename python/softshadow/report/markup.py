"""Pieces of HTML that several parts of the page have."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from html import escape

from .charts import Chart, svg


def table(
    label: str,
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    words: int | None = 1,
    dimmed: Collection[int] = (),
) -> str:
    """A table that scrolls within itself; cells are HTML.

    The first cell of a row names it. The first `words` columns stand left, the others are numbers and stand right;
    None makes all of them words. `dimmed` are rows that matter less.
    """
    lines = [f"<tr>{''.join(_cell(text, k, words, 'col') for k, text in enumerate(head))}</tr>"]
    for index, row in enumerate(rows):
        cells = _cell(row[0], 0, words, "row") + "".join(_cell(text, k, words) for k, text in enumerate(row[1:], 1))
        lines.append(f'<tr class="dominated">{cells}</tr>' if index in dimmed else f"<tr>{cells}</tr>")
    kind = ' class="words"' if words is None else ""
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(label)}"><table{kind}>'
        f"<thead>{lines[0]}</thead><tbody>{''.join(lines[1:])}</tbody></table></div>"
    )


def figures(charts: Sequence[Chart], identity: str) -> str:
    """Figures side by side where there is room."""
    drawn = "".join(
        f"<figure>{svg(chart, f'{identity}-{k}')}<figcaption>{escape(chart.title)}</figcaption></figure>"
        for k, chart in enumerate(charts)
    )
    return f'<div class="figures">{drawn}</div>'


def section(identity: str, title: str, *parts: str) -> str:
    """A part of the page with a heading; the title is text."""
    return f'<section id="{identity}"><h2>{escape(title)}</h2>{"".join(parts)}</section>'


def note(html: str) -> str:
    """A remark."""
    return f'<p class="note">{html}</p>'


def _cell(html: str, column: int, words: int | None, scope: str = "") -> str:
    left = ' class="word"' if words is not None and column < words else ""
    return f'<th scope="{scope}"{left}>{html}</th>' if scope else f"<td{left}>{html}</td>"
