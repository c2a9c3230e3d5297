"""Results drawn by matplotlib, which is imported only here, and only when something is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .errors import SettingsError
from .extras import needed
from .result_files import by_light

if TYPE_CHECKING:
    from .picture import Picture
    from .visibility import Visibility


_GREY: dict[str, Any] = {"vmin": 0, "vmax": 1, "cmap": "gray"}
# Neither black nor white: both are values.
_BEHIND_POINTS = "lightsteelblue"


def picture(shown: Picture, axes: Any) -> Any:
    """The picture on axes of its own, or on those given."""
    axes = _pyplot().subplots(layout="constrained")[1] if axes is None else _checked(axes)
    axes.imshow(shown.srgb)
    axes.set_axis_off()
    return axes


def visibility(shown: Visibility, axes: Any) -> Any:
    """Every light on axes of its own; one light on those given."""
    lights = len(shown.light_names)
    if axes is None:
        _, grid = _pyplot().subplots(1, lights, squeeze=False, layout="constrained", figsize=(6.4 * lights, 4.8))
        row = grid[0]
    elif lights == 1:
        row = np.array([_checked(axes)])
    else:
        raise SettingsError(f"axes: one light fits on given axes, not {lights}; leave them out")
    for one, values, name in zip(row, by_light(shown, shown.values), shown.light_names, strict=True):
        drawn = _image(one, shown, values) if shown.points is None else _scattered(one, shown.points, values)
        if values.shape[1] == 1:
            one.figure.colorbar(drawn, ax=one, label="visibility")
        if lights > 1:
            one.set_title(name)
    return row if lights > 1 else row[0]


def _image(axes: Any, shown: Visibility, values: NDArray[np.float32]) -> Any:
    axes.set_axis_off()
    if values.shape[1] == 3:
        return axes.imshow(np.nan_to_num(values).reshape(*shown.valid.shape, 3))
    return axes.imshow(values.reshape(shown.valid.shape), **_GREY)


def _scattered(axes: Any, points: NDArray[np.float64], values: NDArray[np.float32]) -> Any:
    """Points as seen along the axis in which they spread least."""
    spread = np.ptp(points, axis=0) if len(points) else np.zeros(3)
    across, up = sorted(np.argsort(spread, kind="stable")[1:])
    axes.set(xlabel="xyz"[across], ylabel="xyz"[up], aspect="equal", facecolor=_BEHIND_POINTS)
    colors = {"c": values} if values.shape[1] == 3 else {"c": values[:, 0], **_GREY}
    return axes.scatter(points[:, across], points[:, up], s=4, **colors)


def _checked(axes: Any) -> Any:
    if not isinstance(axes, needed("plot", "plot", "matplotlib.axes").Axes):
        raise SettingsError(f"axes: matplotlib Axes expected, got {axes!r:.80}")
    return axes


def _pyplot() -> Any:
    return needed("plot", "plot", "matplotlib.pyplot")
