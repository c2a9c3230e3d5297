"""Techniques against a reference: error, time and images."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .camera import Camera
from .checks import whole
from .device import Device, announce, context
from .errors import SceneError, SettingsError
from .lights import Light
from .progress import Progress, callback
from .scene import Scene
from .techniques import TECHNIQUES, RayTraced, Technique, technique_json
from .visibility import receivers_of, scene_of


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Comparison:
    """The result of :func:`compare`; printing it shows a table.

    Attributes
    ----------
    name : str
        What a report calls it.
    triangles : int
        How many the scene has.
    light : dict
        Its `shape`, and its `extent`: the side of the square of the same area, or a diameter, of suns in degrees.
    size : [width, height] or None
        Pixels; None for points.
    channels : int
        1, or 3 with a textured light.
    rows : list of dict
        One a technique, in the order given: settings, error metrics, every run's milliseconds, bytes by resource, and
        `penumbra_rmse_interval`: where the error against the truth lies, as far as the reference's own standard error
        lets that be said.
    reference : dict
        What made the reference.
    reference_standard_error : float or None
        Root mean square of the reference's own standard error over the penumbra: errors below it say nothing.
    reference_values : (H, W) or (points,) float32, with a textured light a last axis of 3
        The reference; NaN where the camera sees nothing.
    values : tuple of float32, like `reference_values`
        The visibility of each technique.
    """

    name: str
    triangles: int
    light: dict[str, Any]
    size: list[int] | None
    channels: int
    rows: list[dict[str, Any]]
    reference: dict[str, Any]
    reference_standard_error: float | None
    reference_values: NDArray[np.float32]
    values: tuple[NDArray[np.float32], ...]

    def to_dict(self) -> dict[str, Any]:
        """All numbers but those of the images."""
        return {name: value for name, value in vars(self).items() if name not in ("reference_values", "values")}

    def to_json(self) -> str:
        """The same as JSON."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes a report into a folder: ``index.html``, which stands alone, ``report.json`` and the front as PNG.

        :class:`softshadow.report.Report` writes one of several comparisons, with other tracers and published ratios.

        Parameters
        ----------
        folder : path
            Made where there is none; files of these names in it are replaced.

        Raises
        ------
        OutputError
            Where the folder cannot be made or written to.
        """
        from .report import Report

        Report(comparisons=[self], title=f"Speed against error: {self.name}").save(folder)

    def __str__(self) -> str:
        lines = [list(_COLUMNS)] + [[_cell(row, path) for path in _COLUMNS.values()] for row in self.rows]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join("  ".join(map(str.rjust, line, widths)) for line in lines)

    def __repr__(self) -> str:
        return f"<Comparison of {len(self.rows)} techniques>"


def compare(
    scene: Scene,
    light: Light,
    *,
    camera: Camera | None = None,
    points: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    techniques: Sequence[Technique],
    reference: Technique = RayTraced(samples=4096),  # noqa: B008 - frozen
    repeats: int = 3,
    name: str = "scene",
    device: Device | str = "auto",
    progress: Progress | bool | None = None,
) -> Comparison:
    """Error and time of techniques on the same receivers.

    Parameters
    ----------
    scene, light, camera, points, normals, device, progress
        As in :func:`visibility`; one light.
    techniques : list of techniques
        What is judged.
    reference : technique
        What it is judged by.
    repeats : int
        Timed runs of each technique after a warm-up, in turn; the time is their median.
    name : str
        What a report calls it. Comparisons of one name that differ in their light's size, their triangles or their
        receivers alone show how a technique grows.

    Returns
    -------
    Comparison

    Raises
    ------
    SceneError, SettingsError, TooLargeError, NoAdapterError, GpuError, Interrupted, MissingExtra
        As :func:`visibility`.
    """
    if not isinstance(light, Light):
        raise SceneError(f"light: one light expected, got {light!r:.80}")
    if not isinstance(techniques, (list, tuple)) or not techniques:
        raise SettingsError(f"techniques: a list of at least one technique expected, got {techniques!r:.80}")
    if not isinstance(name, str) or not name.strip():
        raise SettingsError(f"name: a word expected, got {name!r:.80}")
    where = receivers_of(camera, points, normals)

    def running(done: int) -> Technique:
        """The core's order: the reference, every technique once to warm up, then all of them in turn."""
        return techniques[(done - 1) % len(techniques)] if done else reference

    arrays = _core.compare(
        context(device),
        scene_of(scene),
        light._built(),
        **where.arguments,
        techniques=[technique_json(f"techniques[{i}]", technique) for i, technique in enumerate(techniques)],
        reference=technique_json("reference", reference),
        repeats=whole("repeats", repeats, low=1, high=1000),
        progress=callback(progress, "compare", running),
    )
    measured = json.loads(arrays["measured"])
    shape = where.shape + ((measured["channels"],) if measured["channels"] > 1 else ())
    result = Comparison(
        name=name,
        reference_values=arrays["reference_values"].reshape(shape),
        values=tuple(values.reshape(shape) for values in arrays["values"]),
        **measured,
    )
    announce(device, result.reference["adapter"])
    return result


# What the table shows, and where a row keeps it. Errors are those of the penumbra.
_COLUMNS: dict[str, tuple[str, ...]] = {
    "technique": ("technique",),
    "ms": ("median_ms",),
    "bytes": ("bytes",),
    "RMSE": ("penumbra", "rmse"),
    "p99": ("penumbra", "p99"),
    "max": ("penumbra", "max"),
    "bias": ("penumbra", "bias"),
    "leaks": ("leak_fraction",),
    "false shadows": ("false_shadow_fraction",),
    "gross": ("gross_count",),
}


def _cell(row: dict[str, Any], path: tuple[str, ...]) -> str:
    value: Any = row
    for name in path:
        value = None if value is None else value[name]
    if value is None:
        return "-"
    if isinstance(value, dict):
        usual = vars(TECHNIQUES[value["name"]]())
        settings = {name: setting for name, setting in value.items() if name != "name"}
        first = next(iter(settings), None)
        changed = (f"{k}={v}" for k, v in settings.items() if k == first or v != usual[k])
        return f"{value['name']}({', '.join(changed)})"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
