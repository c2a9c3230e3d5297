"""Pictures: direct light times visibility."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, logs, notebook, plots
from .camera import Camera
from .checks import choice, color, memory_limit_bytes, real
from .device import Device, announce, context
from .errors import SettingsError
from .files import output_format, write, write_csv, write_npz
from .lights import Light, built_lights
from .progress import Progress, callback
from .result_files import arrays_of, names_of, places_of, rgb
from .scene import Scene
from .techniques import RayTraced, Technique, technique_json
from .visibility import Visibility, receivers_of, scene_of, shaped


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Picture:
    """The result of :func:`render`.

    Attributes
    ----------
    linear : float32, (H, W, 3)
        Exposed linear red, green, blue.
    srgb : uint8, (H, W, 3)
        The same clipped to 0..1 and encoded for display.
    visibility : Visibility
        The visibility that the picture was made of, with a first axis of lights where a list was given.
    """

    linear: NDArray[np.float32]
    srgb: NDArray[np.uint8]
    visibility: Visibility

    @property
    def info(self) -> dict[str, Any]:
        """What made the picture: adapter, technique, settings, times and bytes."""
        return self.visibility.info

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file of the kind that its extension names.

        ``.png``
            sRGB, 8 bits.
        ``.npy``
            The linear colours.
        ``.npz``
            `linear`, `srgb`, and what :meth:`Visibility.save` writes.
        ``.csv``
            A row for each pixel: `column` and `row` from the upper left corner, linear `R`, `G` and `B`,
            `valid` as 0 or 1.
        ``.exr``
            Channels `R`, `G`, `B` of linear float32; `info` as JSON text in the attribute `softshadow`.

        Parameters
        ----------
        path : path
            Where to; the case of its extension does not matter.

        Raises
        ------
        SettingsError
            For another extension.
        OSError
            Where the file cannot be written.
        """
        match output_format(path):
            case "png":
                write(path, self._repr_png_())
            case "npy":
                write(path, self.linear)
            case "npz":
                write_npz(path, {"linear": self.linear, "srgb": self.srgb, **arrays_of(self.visibility)})
            case "csv":
                seen = self.visibility
                write_csv(path, places_of(seen) | rgb(self.linear) | {"valid": seen.valid.ravel()})
            case "exr":
                height, width, _ = self.linear.shape
                write(path, _core.exr(list(rgb(self.linear).items()), (width, height), json.dumps(self.info)))

    def _repr_png_(self) -> bytes:
        height, width, _ = self.srgb.shape
        return _core.png_srgb8(self.srgb.ravel(), (width, height))

    def _repr_html_(self) -> str:
        return notebook.page(self._repr_png_(), self.srgb.shape, self.info)

    def plot(self, *, axes: Any = None) -> Any:
        """Shows the picture with matplotlib, which the extra ``[plot]`` installs.

        Parameters
        ----------
        axes : matplotlib Axes, optional
            Where to draw; else a figure is made.

        Returns
        -------
        matplotlib Axes

        Raises
        ------
        MissingExtra
            Where matplotlib is not installed.
        """
        return plots.picture(self, axes)

    def __repr__(self) -> str:
        height, width, _ = self.srgb.shape
        return f"<Picture of {width} × {height} pixels>"


def render(
    scene: Scene,
    lights: Light | Sequence[Light],
    *,
    camera: Camera,
    technique: Technique = RayTraced(),  # noqa: B008 - frozen
    shading: str = "integrated",
    exposure: float = 0.0,
    background: ArrayLike | None = None,
    device: Device | str = "auto",
    memory_limit: int | None = None,
    progress: Progress | bool | None = None,
) -> Picture:
    """A picture of the scene under direct light.

    Parameters
    ----------
    scene : Scene
        Meshes with their base colours.
    lights : light or list of lights
        Their contributions are added.
    camera : Camera
        The view.
    technique : RayTraced, DepthComplexity, OcclusionCamera, OcclusionLayers, PenumbraMap or HardShadowMap
        How visibility is computed.
    shading : {"integrated", "modulated"}
        Light summed over the samples that are visible, or the unshadowed sum times visibility.
    exposure : float
        In stops: each doubles the brightness.
    background : (3,) float, optional
        Linear colour where the camera sees nothing; not exposed.
    device, memory_limit, progress
        As in :func:`visibility`.

    Returns
    -------
    Picture

    Raises
    ------
    SceneError, SettingsError, TooLargeError, NoAdapterError, GpuError, Interrupted, MissingExtra
        As :func:`visibility`.
    """
    built, several = built_lights(lights)
    where = receivers_of(camera, None, None)
    stops = real("exposure", exposure, SettingsError)
    if not np.isfinite(stops):
        raise SettingsError(f"exposure: must be finite, got {exposure}")
    arrays = _core.render(
        context(device),
        scene_of(scene),
        built,
        camera=where.arguments["camera"],
        technique=technique_json("technique", technique),
        shading=choice("shading", shading, ("integrated", "modulated")),
        exposure=stops,
        background=None if background is None else color("background", background),
        memory_limit=memory_limit_bytes(memory_limit),
        progress=callback(progress, "render", lambda _: technique),
    )
    names = names_of(lights if isinstance(lights, Sequence) else [lights])
    seen = shaped(arrays["visibility"], (len(built),) if several else (), where.shape, names)
    announce(device, seen.info["adapter"])
    logs.call_done("render", seen.info)
    return Picture(
        linear=arrays["linear"].reshape(*where.shape, 3),
        srgb=arrays["srgb"].reshape(*where.shape, 3),
        visibility=seen,
    )
