"""Figures on two logarithmic axes, as SVG. Colours come from a style: the page's, or one that goes with a PNG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

_WIDTH, _PLOT_HEIGHT = 480, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 60, 14, 12, 46
_LEGEND_LINE = 19
_MOST_TICKS = 7
# Places of a label beside its mark, in the order in which they are tried; how high and about how wide its digits are.
_PLACES = ((7, -6, "start"), (7, 15, "start"), (-7, 15, "end"), (-7, -6, "end"))
_DIGIT_HEIGHT, _DIGIT_WIDTH = 10, 6.3
# An axis spans at least so many times: what hardly differs must not seem to differ a lot.
_SMALLEST_SPAN = 1.6

_Box = tuple[float, float, float, float]

COLORS = 8
"""Colours of the style; further series take them again with other marks."""

STYLE = """\
text { font-family: sans-serif; font-size: 12px; fill: #30343b }
.grid { stroke: #e3e5e9; stroke-width: 1 }
.frame { fill: none; stroke: #9aa0aa; stroke-width: 1 }
.floor { fill: #8a8f99; fill-opacity: 0.14 }
.small { font-size: 10.5px; fill: #5a606b }
.curve { fill: none; stroke-width: 1.8 }
.bar { stroke-width: 1.2; stroke-opacity: 0.7 }
.dashed { stroke-dasharray: 6 4 }
.dominated .mark { fill: #fff; stroke: #9aa0aa }
.dominated .bar { stroke: #9aa0aa }
.dominated text { fill: #8a8f99 }
.mark { stroke-width: 1.5 }
"""
"""Of figures that stand alone; the page has its own for the same classes."""
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#b4488c", "#8a6d00", "#3a3f9c", "#a33a2f", "#4a7d20")


@dataclass(frozen=True, kw_only=True)
class Point:
    """One measurement."""

    x: float
    y: float
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    label: str = ""
    tip: str = ""
    is_dominated: bool = False


@dataclass(frozen=True, kw_only=True)
class Series:
    """One curve; its points in the order in which it runs."""

    name: str
    points: Sequence[Point]
    is_dashed: bool = False


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Curves on two logarithmic axes."""

    title: str
    description: str
    x_label: str
    y_label: str
    series: Sequence[Series]
    floor: float | None = None
    """Below this nothing can be said of y."""
    floor_label: str = ""


def svg(chart: Chart, identity: str) -> str:
    """The figure for a page, whose style colours it; `identity` is unique there."""
    title, description = f"{identity}-title", f"{identity}-description"
    return (
        f'<svg class="chart" viewBox="0 0 {_WIDTH} {_height(chart)}" role="img" '
        f'aria-labelledby="{title} {description}">'
        f'<title id="{title}">{escape(chart.title)}</title><desc id="{description}">{escape(chart.description)}</desc>'
        f"{_body(chart)}</svg>"
    )


def alone(chart: Chart) -> str:
    """The figure as a file of its own, with its colours."""
    colors = "".join(
        f".s{i} .mark {{ fill: {color}; stroke: {color} }} .s{i} .curve, .s{i} .bar {{ stroke: {color} }}\n"
        for i, color in enumerate(PALETTE)
    )
    # What is said last of a class counts.
    style = colors + STYLE
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_height(chart)}">'
        f"<style>{style}</style>{_body(chart)}</svg>"
    )


def _height(chart: Chart) -> int:
    return _PLOT_HEIGHT + _BOTTOM + _LEGEND_LINE * len(chart.series) + 8


@dataclass(frozen=True)
class _Axis:
    """From values to pixels."""

    low: float
    high: float
    start: float
    end: float

    @staticmethod
    def of(values: Iterable[float], start: float, end: float) -> _Axis:
        logs = [math.log10(value) for value in values if value > 0 and math.isfinite(value)] or [0.0]
        low, high = min(logs), max(logs)
        room = max(0.06 * (high - low), (math.log10(_SMALLEST_SPAN) - (high - low)) / 2, 0.04)
        return _Axis(low - room, high + room, start, end)

    def at(self, value: float) -> float:
        share = (math.log10(max(value, 1e-300)) - self.low) / (self.high - self.low)
        return self.start + min(max(share, 0.0), 1.0) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Round values within the axis, no more than there is room for."""
        for steps in ((1, 1.5, 2, 3, 4, 5, 7), (1, 2, 5), (1, 3), (1,)):
            found = [
                step * 10.0**decade
                for decade in range(math.floor(self.low), math.ceil(self.high) + 1)
                for step in steps
                if self.low <= math.log10(step * 10.0**decade) <= self.high
            ]
            if len(found) <= _MOST_TICKS:
                break
        if len(found) < 2:
            found = [10.0 ** (self.low + share * (self.high - self.low)) for share in (0.1, 0.5, 0.9)]
        return found


def _body(chart: Chart) -> str:
    points = [point for series in chart.series for point in series.points]
    x_values = [x for point in points for x in (point.x, *(point.x_range or ()))]
    y_values = [y for point in points for y in (point.y, *(_above(point) or ()))]
    across = _Axis.of(x_values, _LEFT, _WIDTH - _RIGHT)
    up = _Axis.of(y_values, _PLOT_HEIGHT, _TOP)
    return "".join([*_frame(chart, across, up), *_curves(chart, across, up), *_legend(chart)])


def _above(point: Point) -> tuple[float, ...] | None:
    """Ends of the vertical bar that a logarithmic axis can show; what reaches down to nothing is cut off."""
    if point.y_range is None:
        return None
    low, high = point.y_range
    return (max(low, point.y / 2), high)


def _frame(chart: Chart, across: _Axis, up: _Axis) -> list[str]:
    right, width, height = _WIDTH - _RIGHT, _WIDTH - _RIGHT - _LEFT, _PLOT_HEIGHT - _TOP
    parts, words = [], []
    if chart.floor is not None and chart.floor > 0 and math.log10(chart.floor) > up.low:
        top = up.at(chart.floor)
        parts.append(
            f'<rect class="floor" x="{_LEFT}" y="{top:.1f}" width="{width}" height="{_PLOT_HEIGHT - top:.1f}"/>'
        )
        words.append(f'<text class="small" x="{_LEFT + 6}" y="{_PLOT_HEIGHT - 6}">{escape(chart.floor_label)}</text>')
    for x in across.ticks():
        at = across.at(x)
        parts.append(f'<path class="grid" d="M{at:.1f} {_TOP}V{_PLOT_HEIGHT}"/>')
        parts.append(f'<text x="{at:.1f}" y="{_PLOT_HEIGHT + 17}" text-anchor="middle">{_number(x)}</text>')
    for y in up.ticks():
        at = up.at(y)
        parts.append(f'<path class="grid" d="M{_LEFT} {at:.1f}H{right}"/>')
        parts.append(f'<text x="{_LEFT - 7}" y="{at + 4:.1f}" text-anchor="end">{_number(y)}</text>')
    parts.append(f'<rect class="frame" x="{_LEFT}" y="{_TOP}" width="{width}" height="{height}"/>')
    middle = (_TOP + _PLOT_HEIGHT) / 2
    parts.append(
        f'<text x="{(_LEFT + right) / 2}" y="{_PLOT_HEIGHT + 36}" text-anchor="middle">{escape(chart.x_label)}</text>'
        f'<text transform="translate(15 {middle}) rotate(-90)" text-anchor="middle">{escape(chart.y_label)}</text>'
    )
    return parts + words


def _curves(chart: Chart, across: _Axis, up: _Axis) -> list[str]:
    parts = []
    taken: list[_Box] = []
    for index, series in enumerate(chart.series):
        places = [(across.at(point.x), up.at(point.y)) for point in series.points]
        way = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        dashed = " dashed" if series.is_dashed else ""
        parts.append(f'<g class="s{index % COLORS}"><path class="curve{dashed}" d="{way}"/>')
        for point, (x, y) in zip(series.points, places, strict=True):
            parts.append(_point(point, x, y, across, up, index, _label(point.label, x, y, taken)))
        parts.append("</g>")
    return parts


def _label(text: str, x: float, y: float, taken: list[_Box]) -> str:
    """Digits beside a mark, where there is room; else the mark's tip alone has them."""
    for dx, dy, anchor in _PLACES if text else ():
        width = _DIGIT_WIDTH * len(text)
        left = x + dx - (width if anchor == "end" else 0)
        box = (left, y + dy - _DIGIT_HEIGHT, left + width, y + dy)
        inside = box[0] >= _LEFT and box[2] <= _WIDTH - _RIGHT and box[1] >= _TOP and box[3] <= _PLOT_HEIGHT
        apart = all(box[2] <= b[0] or b[2] <= box[0] or box[3] <= b[1] or b[3] <= box[1] for b in taken)
        if inside and apart:
            taken.append(box)
            place = f'x="{x + dx:.1f}" y="{y + dy:.1f}" text-anchor="{anchor}"'
            return f'<text class="small" {place}>{escape(text)}</text>'
    return ""


def _point(point: Point, x: float, y: float, across: _Axis, up: _Axis, index: int, label: str) -> str:
    bars = []
    if point.x_range is not None:
        low, high = (across.at(end) for end in point.x_range)
        bars.append(f'<path class="bar" d="M{low:.1f} {y:.1f}H{high:.1f}"/>')
    if (ends := _above(point)) is not None:
        low, high = (up.at(end) for end in ends)
        bars.append(f'<path class="bar" d="M{x:.1f} {low:.1f}V{high:.1f}"/>')
    dominated = ' class="dominated"' if point.is_dominated else ""
    tip = f"<title>{escape(point.tip)}</title>" if point.tip else ""
    return f"<g{dominated}>{tip}{''.join(bars)}{_mark(index, x, y)}{label}</g>"


def _mark(index: int, x: float, y: float) -> str:
    """Shapes differ as colours do, for those who do not tell these apart."""
    match index % 4:
        case 0:
            return f'<circle class="mark" cx="{x:.1f}" cy="{y:.1f}" r="4.2"/>'
        case 1:
            return f'<path class="mark" d="M{x - 4:.1f} {y - 4:.1f}h8v8h-8z"/>'
        case 2:
            return f'<path class="mark" d="M{x:.1f} {y - 5:.1f}l5 8.6h-10z"/>'
        case _:
            return f'<path class="mark" d="M{x:.1f} {y - 5.4:.1f}l5.4 5.4l-5.4 5.4l-5.4 -5.4z"/>'


def _legend(chart: Chart) -> list[str]:
    parts = []
    for index, series in enumerate(chart.series):
        y = _PLOT_HEIGHT + _BOTTOM + _LEGEND_LINE * index + 8
        dashed = " dashed" if series.is_dashed else ""
        parts.append(
            f'<g class="s{index % COLORS}"><path class="curve{dashed}" d="M{_LEFT} {y}h34"/>'
            f'{_mark(index, _LEFT + 17, y)}<text x="{_LEFT + 44}" y="{y + 4}">{escape(series.name)}</text></g>'
        )
    return parts


def _number(value: float) -> str:
    return f"{value:,.0f}" if value >= 1000 else f"{value:.2g}" if value < 100 else f"{value:.0f}"
