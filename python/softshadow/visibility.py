"""How much of each light every receiver sees."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, logs, notebook, plots
from .camera import Camera
from .checks import flag, floats, memory_limit_bytes, real
from .device import Device, announce, context
from .errors import BoundNotMet, SceneError, SettingsError
from .files import output_format, write, write_csv, write_npz
from .lights import Light, built_lights
from .progress import Progress, callback
from .result_files import arrays_of, channels_of, columns_of, names_of
from .scene import Scene
from .techniques import DepthComplexity, RayTraced, Technique, technique_json

ErrorNorm = Literal["rmse", "p99", "max"]
"""How errors are measured: root mean square, 99th percentile or largest."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Visibility:
    """The result of :func:`visibility`.

    Attributes
    ----------
    values : float32, (H, W) or (points,), with several lights (lights, H, W) or (lights, points)
        The visible share of the light: 1 is fully lit. A textured light adds a last axis of 3. NaN only
        where the camera sees nothing.
    valid : bool, (H, W) or (points,)
        False only where the camera sees nothing.
    standard_error : float32 like `values`, or None
        Of the mean over the samples, as a share; None where the technique has none or it was not asked for.
    positions : float64, (H, W, 3) or (points, 3), or None
        World coordinates of the receivers as they were used.
    normals : float32, (H, W, 3) or (points, 3), or None
        Geometric, on the camera's side; for points as given.
    triangles : int64, (H, W) or (points,), or None
        Triangle ids, counted through the scene's meshes; -1 where there is none.
    visible_samples : bool, the shape of one value's array with a last axis of samples, or None
        Which light samples of the last pass are visible, in the order of :func:`light_points`: those to which anything
        passes, so that semi-opaque triangles alone hide none.
    points : float64, (points, 3), or None
        The receivers as they were given; None for a camera.
    light_names : tuple of str
        A name for each light that no other has: its own, or ``light0`` and so on by its place.
    info : dict
        What made the result: adapter, technique, settings, times and bytes.
    """

    values: NDArray[np.float32]
    valid: NDArray[np.bool_]
    standard_error: NDArray[np.float32] | None
    positions: NDArray[np.float64] | None
    normals: NDArray[np.float32] | None
    triangles: NDArray[np.int64] | None
    visible_samples: NDArray[np.bool_] | None
    points: NDArray[np.float64] | None
    light_names: tuple[str, ...]
    info: dict[str, Any]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file of the kind that its extension names.

        ``.png``
            16-bit linear grey, black where nothing is seen.
        ``.npy``
            The values.
        ``.npz``
            All arrays that are there, by their names here, `light_names`, and `info` as JSON text.
        ``.csv``
            A row for each receiver: `x`, `y` and `z` of points as given, or `column` and `row` of a pixel from the
            upper left corner (and `x`, `y`, `z` where positions were asked for); visibility and standard error;
            `valid` as 0 or 1.
        ``.exr``
            Channels of linear float32: visibility and standard error, `valid`, and `position` and `normal` where asked
            for; `info` as JSON text in the attribute `softshadow`.

        Visibility is called ``visibility`` for a light without a name, else ``visibility.NAME``, and ends in ``.R``,
        ``.G``, ``.B`` where it is coloured; standard errors likewise. OpenEXR knows printable ASCII only: other letters
        of a name become ``_``.

        Parameters
        ----------
        path : path
            Where to; the case of its extension does not matter.

        Raises
        ------
        SettingsError
            For another extension, for a PNG of anything but one grey image, and for an EXR of points.
        OSError
            Where the file cannot be written.
        """
        match output_format(path):
            case "npy":
                write(path, self.values)
            case "npz":
                write_npz(path, arrays_of(self))
            case "csv":
                write_csv(path, columns_of(self))
            case "exr":
                write(path, self._exr(path))
            case "png":
                write(path, self._png(path))

    def _png(self, path: str | os.PathLike[str]) -> bytes:
        png = self._repr_png_()
        if png is None:
            words = f"a PNG holds one grey image, not values of shape {self.values.shape}; use .npy, .npz or .csv"
            raise SettingsError(f"{os.fspath(path)}: {words}")
        return png

    def _exr(self, path: str | os.PathLike[str]) -> bytes:
        if self.valid.ndim != 2:
            raise SettingsError(f"{os.fspath(path)}: an EXR holds images, not points; use .npy, .npz or .csv")
        height, width = self.valid.shape
        return _core.exr(list(channels_of(self).items()), (width, height), json.dumps(self.info))

    def _repr_png_(self) -> bytes | None:
        if self.valid.ndim != 2 or self.values.shape != self.valid.shape:
            return None
        height, width = self.values.shape
        return _core.png_grey16(self.values.ravel(), (width, height))

    def _repr_html_(self) -> str:
        return notebook.page(self._repr_png_(), self.values.shape, self.info)

    def plot(self, *, axes: Any = None) -> Any:
        """Draws the values with matplotlib, which the extra ``[plot]`` installs.

        Images are shown in linear grey, or in their colours; points as seen along the axis in which they spread least.

        Parameters
        ----------
        axes : matplotlib Axes, optional
            Where to draw, for a result of one light; else a figure is made.

        Returns
        -------
        matplotlib Axes, or for several lights an array of them, one each

        Raises
        ------
        MissingExtra
            Where matplotlib is not installed.
        SettingsError
            For `axes` with several lights.
        """
        return plots.visibility(self, axes)

    def __repr__(self) -> str:
        return f"<Visibility of shape {self.values.shape}>"


def visibility(
    scene: Scene,
    lights: Light | Sequence[Light],
    *,
    camera: Camera | None = None,
    points: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    technique: Technique | None = None,
    max_error: float | None = None,
    max_ms: float | None = None,
    error_norm: ErrorNorm = "rmse",
    confidence: float | None = None,
    device: Device | str = "auto",
    memory_limit: int | None = None,
    progress: Progress | bool | None = None,
    standard_error: bool = True,
    receivers: bool = False,
    sample_masks: bool = False,
) -> Visibility:
    """The share of each light that every receiver sees: 1 is fully lit, 0 is full shadow.

    Parameters
    ----------
    scene : Scene
        What casts shadows. In an empty scene visibility is 1.
    lights : light or list of lights
        With a list, even of one, results have a first axis of lights.
    camera : Camera
        Receivers are the surface points behind its pixels; either this or `points`.
    points : (n, 3) float
        Receivers in world coordinates.
    normals : (n, 3) float, optional
        For each point, of any length but zero: light from below the horizon is then not visible. A flat light
        is never visible from behind.
    technique : RayTraced, DepthComplexity, OcclusionCamera, OcclusionLayers, PenumbraMap or HardShadowMap
        How it is computed; ``RayTraced()`` unless an error or a time is asked for.
    max_error : float, optional
        Takes the fastest technique and settings that keep this error for this scene, instead of `technique`. The
        result is checked against rays at random receivers; ``info["choice"]`` says how it was chosen, what it reaches,
        and how that is known: ``certified``, ``statistical`` or ``measured``.
    max_ms : float, optional
        Takes the smallest error within so many milliseconds instead, check included.
    error_norm : {"rmse", "p99", "max"}
        How errors are measured, over the penumbra and whatever else is wrong by more than 1/255. The largest error can
        be estimated, and the share of receivers beyond it bounded; promised it cannot be.
    confidence : float, optional
        Of statistical bounds; 0.95 unless given.
    device : {"auto", "gpu", "native", "software"} or int
        ``"auto"`` takes a graphics card, else the processor without any driver (``"native"``), and a software driver
        for what draws triangles; the environment variable ``SOFTSHADOW_DEVICE`` overrides it. A number is an index in
        :func:`doctor`.
    memory_limit : int, optional
        Bytes of device memory for one block of receivers.
    progress : True or callable, optional
        True shows a bar of tqdm's, which the extra ``[progress]`` installs. A callable gets ``(done, total, info)``
        between blocks, `info` with the `call`, the `technique` and `elapsed_ms`; returning ``False`` stops.
    standard_error : bool
        Whether to return it, where the technique has one.
    receivers : bool
        Whether to return positions, normals and triangle ids.
    sample_masks : bool
        Whether to return which samples are visible. Only `RayTraced` without probes and `DepthComplexity`
        decide all of them.

    Returns
    -------
    Visibility

    Raises
    ------
    SceneError
        For arrays of wrong dtype or shape or with a number that is not finite, by name and first bad index.
    SettingsError, TooLargeError
        For options out of range.
    NoAdapterError, GpuError
        Where no device fits, or it fails.
    BoundNotMet
        Where nothing keeps `max_error` or `max_ms`; its `best` is the result that comes closest.
    Interrupted
        When `progress` returned ``False``.
    MissingExtra
        Where a bar is asked for and tqdm is not installed.
    """
    built, several = built_lights(lights)
    where = receivers_of(camera, points, normals)
    given, names = where.points, names_of(lights if isinstance(lights, Sequence) else [lights])
    leading = (len(built),) if several else ()
    masks = flag("sample_masks", sample_masks)
    common: dict[str, Any] = {
        **where.arguments,
        "memory_limit": memory_limit_bytes(memory_limit),
        "standard_error": flag("standard_error", standard_error),
        "receivers": flag("receivers", receivers),
        "progress": callback(progress, "visibility", lambda _: technique),
    }
    if max_error is not None or max_ms is not None:
        goal = _goal(technique, max_error, max_ms, error_norm, confidence, masks)
        arrays, reason = _core.visibility_within(context(device), scene_of(scene), built, **common, **goal)
        result = shaped(arrays, leading, where.shape, names, given)
        if reason is not None:
            unmet = BoundNotMet(reason)
            unmet.best = result
            raise unmet
    else:
        technique = RayTraced() if technique is None else technique
        is_ray_traced = isinstance(technique, RayTraced) and technique.probes == 0
        if masks and not (is_ray_traced or isinstance(technique, DepthComplexity)):
            raise SettingsError("sample_masks: only RayTraced without probes and DepthComplexity decide every sample")
        arrays = _core.visibility(
            context(device),
            scene_of(scene),
            built,
            **common,
            technique=technique_json("technique", technique),
            sample_masks=masks,
        )
        result = shaped(arrays, leading, where.shape, names, given)
    announce(device, result.info["adapter"])
    logs.call_done("visibility", result.info)
    return result


def _goal(
    technique: Technique | None,
    max_error: float | None,
    max_ms: float | None,
    error_norm: str,
    confidence: float | None,
    sample_masks: bool,
) -> dict[str, Any]:
    """What is asked for instead of a technique."""
    if technique is not None:
        raise SettingsError("technique: max_error and max_ms choose it; leave it out")
    if sample_masks:
        raise SettingsError("sample_masks: a technique that is chosen may have none; name one")
    if not isinstance(error_norm, str):
        raise SettingsError(f"error_norm: 'rmse', 'p99' or 'max' expected, got {error_norm!r}")
    numbers = {"max_error": max_error, "max_ms": max_ms, "confidence": confidence}
    checked = {name: None if x is None else real(name, x, SettingsError) for name, x in numbers.items()}
    return checked | {"error_norm": error_norm}


@dataclass(frozen=True)
class WhereReceived:
    """Checked receivers: the arguments of the core, and the shape of what comes back."""

    arguments: dict[str, Any]
    shape: tuple[int, ...]

    @property
    def points(self) -> NDArray[np.float64] | None:
        """A copy of the points, which the caller may change; None for a camera."""
        points: NDArray[np.float64] | None = self.arguments["points"]
        return None if points is None else points.copy()


def receivers_of(camera: object, points: ArrayLike | None, normals: ArrayLike | None) -> WhereReceived:
    """Either a camera or points."""
    if (camera is None) == (points is None):
        raise SceneError("receivers: give either a camera or points")
    if points is None:
        if normals is not None:
            raise SceneError("normals: only points take normals; a camera sees the surface's own")
        if not isinstance(camera, Camera):
            raise SceneError(f"camera: a softshadow.Camera expected, got {type(camera).__name__}")
        return WhereReceived({"camera": camera._built(), "points": None, "normals": None}, camera.shape)
    positions = floats("points", points, ("n", 3))
    directions = None if normals is None else floats("normals", normals, ("n", 3))
    return WhereReceived({"camera": None, "points": positions, "normals": directions}, (len(positions),))


def scene_of(scene: object) -> _core.Scene:
    """The scene of the core."""
    if not isinstance(scene, Scene):
        raise SceneError(f"scene: a softshadow.Scene expected, got {type(scene).__name__}")
    return scene._built()


def shaped(
    arrays: _core._VisibilityArrays,
    leading: tuple[int, ...],
    shape: tuple[int, ...],
    light_names: tuple[str, ...],
    points: NDArray[np.float64] | None = None,
) -> Visibility:
    """The core's flat arrays in their public shapes: `leading` is (lights,) or nothing."""
    channels = arrays["channels"]
    full = leading + shape + ((channels,) if channels > 1 else ())
    error, placed, seen = arrays["standard_error"], arrays["placed"], arrays["visible_samples"]
    info = json.loads(arrays["info"])
    return Visibility(
        values=arrays["values"].reshape(full),
        valid=arrays["valid"].reshape(shape),
        standard_error=None if error is None else error.reshape(full),
        positions=None if placed is None else placed["positions"].reshape(*shape, 3),
        normals=None if placed is None else placed["normals"].reshape(*shape, 3),
        triangles=None if placed is None else placed["triangles"].reshape(shape),
        visible_samples=None if seen is None else seen.reshape(*leading, *shape, info["technique"]["samples"]),
        points=points,
        light_names=light_names,
        info=info,
    )
