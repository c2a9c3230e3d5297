"""Techniques against a reference: error and time."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from . import _core
from .camera import Camera
from .checks import whole
from .device import Device, context
from .errors import SceneError, SettingsError
from .lights import Light
from .progress import Progress, callback
from .scene import Scene
from .techniques import RayTraced, Technique, technique_json
from .visibility import receivers_of, scene_of


@dataclass(frozen=True, kw_only=True, repr=False)
class Comparison:
    """The result of :func:`compare`; printing it shows a table.

    Attributes
    ----------
    rows : list of dict
        One a technique, in the order given: settings, error metrics and milliseconds.
    reference : dict
        What made the reference.
    reference_standard_error : float or None
        Root mean square of the reference's own standard error over the penumbra: errors below it say nothing.
    """

    rows: list[dict[str, Any]]
    reference: dict[str, Any]
    reference_standard_error: float | None

    def to_json(self) -> str:
        """All numbers as JSON."""
        return json.dumps(vars(self), indent=2)

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
    where = receivers_of(camera, points, normals)

    def running(done: int) -> Technique:
        """The core's order: the reference, every technique once to warm up, then all of them in turn."""
        return techniques[(done - 1) % len(techniques)] if done else reference

    text = _core.compare(
        context(device),
        scene_of(scene),
        light._built(),
        **where.arguments,
        techniques=[technique_json(f"techniques[{i}]", technique) for i, technique in enumerate(techniques)],
        reference=technique_json("reference", reference),
        repeats=whole("repeats", repeats, low=1, high=1000),
        progress=callback(progress, "compare", running),
    )
    return Comparison(**json.loads(text))


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
        settings = ", ".join(f"{name}={setting}" for name, setting in value.items() if name != "name")
        return f"{value['name']}({settings})"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
