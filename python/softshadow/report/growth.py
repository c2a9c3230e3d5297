"""How time and error grow: with samples in a comparison; with light, triangles, receivers from one to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from .charts import Chart, Point, Series
from .judgement import Row, families, family, full_name, rmse

Comparison = dict[str, Any]
"""As :meth:`softshadow.Comparison.to_dict` gives it."""


@dataclass(frozen=True)
class Measure:
    """What grows from one comparison to the next."""

    words: str
    axis: str
    of: Callable[[Comparison], Any]


MEASURES = (
    Measure("light size", "extent of the light", lambda c: c["light"]["extent"]),
    Measure("triangles", "triangles", lambda c: c["triangles"]),
    Measure("receivers", "receivers", lambda c: c["reference"]["receivers"]),
)


def with_samples(comparison: Comparison) -> Chart | None:
    """Milliseconds over samples, a curve a family that has two or more."""
    rows = comparison["rows"]
    series = []
    for name, members in families(rows).items():
        points = [_point(rows[i], _samples(rows[i])) for i in members if "samples" in rows[i]["technique"]]
        if len({point.x for point in points}) > 1:
            series.append(Series(name=name, points=points))
    if not series:
        return None
    title = f"Growth with samples: {comparison['name']}"
    return _chart(title, "light samples a receiver", series)


def across(comparisons: Sequence[Comparison]) -> list[Chart]:
    """Charts of time and of error for whatever alone differs between comparisons of one name."""
    charts = []
    for measure in MEASURES:
        groups: dict[tuple[Any, ...], list[Comparison]] = {}
        for comparison in comparisons:
            others = (other.of(comparison) for other in MEASURES if other is not measure)
            groups.setdefault((comparison["name"], comparison["light"]["shape"], *others), []).append(comparison)
        for (name, *_), group in groups.items():
            if len({measure.of(comparison) for comparison in group}) > 1:
                ordered = sorted(group, key=measure.of)
                charts += _pair(f"Growth with {measure.words}: {name}", measure, ordered)
    return charts


def _pair(title: str, measure: Measure, group: Sequence[Comparison]) -> list[Chart]:
    by_setting: dict[str, list[tuple[float, Row]]] = {}
    for comparison in group:
        for row in comparison["rows"]:
            by_setting.setdefault(full_name(row["technique"]), []).append((measure.of(comparison), row))
    curves = {name: rows for name, rows in by_setting.items() if len({x for x, _ in rows}) > 1}
    if not curves:
        return []
    times = [Series(name=name, points=[_point(row, x) for x, row in rows]) for name, rows in curves.items()]
    charts = [_chart(title, measure.axis, times)]
    errors = []
    for name, rows in curves.items():
        points = [Point(x=x, y=e, tip=f"{e:.4f}") for x, row in rows if (e := rmse(row))]
        if len(points) > 1:
            errors.append(Series(name=name, points=points))
    if errors:
        charts.append(_chart(f"{title}, error", measure.axis, errors, "RMSE in the penumbra"))
    return charts


def _chart(title: str, x_label: str, series: Sequence[Series], y_label: str = "ms") -> Chart:
    names = ", ".join(one.name for one in series)
    description = f"{y_label} over {x_label}, both logarithmic, for {names}."
    return Chart(title=title, description=description, x_label=x_label, y_label=y_label, series=series)


def _point(row: Row, x: float) -> Point:
    low, high = row["range_ms"]
    error = rmse(row)
    words = "" if error is None else f", RMSE {error:.4f}"
    return Point(
        x=x,
        y=row["median_ms"],
        y_range=(low, high),
        tip=f"{family(row['technique'])}: {row['median_ms']:.1f} ms ({low:.1f} to {high:.1f}){words}",
    )


def _samples(row: Row) -> int:
    return int(row["technique"]["samples"] * row["technique"].get("passes", 1))
