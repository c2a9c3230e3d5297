"""The front of a comparison, or of tracers side by side, as a chart: log ms against log error."""

from __future__ import annotations

from collections.abc import Sequence

from .charts import Chart, Point, Series
from .judgement import Row, domination, families, full_name, rmse, short_knob


def front(title: str, rows: Sequence[Row], standard_error: float | None, peers: Sequence[str] = ()) -> Chart | None:
    """A curve a family, those of `peers` dashed; None without an error that a logarithmic axis can show."""
    beaten = domination(rows, standard_error)
    series = []
    for name, members in families(rows).items():
        points = [_point(rows[i], beaten[i] is not None) for i in members if rmse(rows[i])]
        if points:
            series.append(Series(name=name, points=points, is_dashed=name in peers))
    if not series:
        return None
    words = ", ".join(f"{one.name} with {len(one.points)} settings" for one in series)
    return Chart(
        title=title,
        description=f"Milliseconds against the root mean square error in the penumbra, both logarithmic: {words}. "
        "Hollow grey marks are dominated: another takes no more time and errs no more.",
        x_label="ms: median, fastest to slowest run",
        y_label="RMSE in the penumbra",
        series=series,
        floor=None if standard_error is None else 2 * standard_error,
        floor_label="below twice the reference's own standard error",
    )


def _point(row: Row, is_dominated: bool) -> Point:
    error, (low, high) = rmse(row) or 0.0, row["range_ms"]
    settings = row["technique"]
    interval = row.get("penumbra_rmse_interval")
    words = f"{full_name(settings)}: {row['median_ms']:.1f} ms ({low:.1f} to {high:.1f}), RMSE {error:.4f}"
    return Point(
        x=row["median_ms"],
        y=error,
        x_range=(low, high),
        y_range=None if interval is None else (interval[0], interval[1]),
        label=short_knob(settings),
        tip=words + (", dominated" if is_dominated else ""),
        is_dominated=is_dominated,
    )
