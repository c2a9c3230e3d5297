"""Where pictures are taken: size, reference and device, and what is measured beside."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from softshadow.camera import Camera
from softshadow.device import Device
from softshadow.lights import Light
from softshadow.picture import Picture, render
from softshadow.scene import Scene
from softshadow.techniques import RayTraced, Technique
from softshadow.visibility import visibility

from . import colors
from .exhibit import Panel

# As `compare` has it: visibility up to which a pixel is umbra; from 1 minus it, it is lit.
_UMBRA_LIMIT = 0.002
# Kernels are compiled and scenes prepared on a picture of this size at most, which is not timed.
_WARM_UP = (48, 36)
# Independent sets of samples tell their standard error; of a single one it can only be guessed, far too large.
_PASSES = 4
# A standard error is a mean over many pixels, and a few of them tell it.
_COARSER = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """What is photographed. The camera's own size does not count.

    Areas are no samples that light could be summed over: they show where shading is "modulated".
    """

    scene: Scene
    light: Light
    camera: Camera
    exposure: float = 0.0
    shading: str = "integrated"


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """What errors are measured against."""

    panel: Panel
    visibility: NDArray[np.float32]
    penumbra: NDArray[np.bool_]
    standard_error: float

    @property
    def note(self) -> str:
        """How well it is known."""
        return f"The reference's own standard error in the penumbra is {self.standard_error:.4f}."


@dataclass(frozen=True, kw_only=True)
class Studio:
    """How large pictures are, how many samples a reference has, and who computes."""

    size: tuple[int, int] = (384, 288)
    reference_samples: int = 512
    device: Device | str = "auto"

    def picture(self, view: View, technique: Technique) -> Picture:
        """A picture by warm kernels."""
        first = (min(self.size[0], _WARM_UP[0]), min(self.size[1], _WARM_UP[1]))
        for size in (first, self.size):
            picture = render(
                view.scene,
                view.light,
                camera=replace(view.camera, size=size),
                technique=technique,
                shading=view.shading,
                exposure=view.exposure,
                background=colors.WALL,
                device=self.device,
            )
        return picture

    def panel(
        self, name: str, caption: str, view: View, technique: Technique, reference: Reference | None = None
    ) -> Panel:
        """A picture with its time, and with its error where there is a reference."""
        picture = self.picture(view, technique)
        values, ms = picture.visibility.values, picture.info["wall_ms"]
        rmse = None if reference is None else _rmse(values - reference.visibility, reference.penumbra)
        return Panel(name=name, caption=caption, image=picture.srgb, values=values, ms=ms, rmse=rmse)

    def reference(self, view: View, share: int = 1) -> Reference:
        """Many shadow rays a receiver; `share` divides their number where they are slow."""
        each = max(self.reference_samples // (share * _PASSES), 1)
        rays = RayTraced(samples=each, passes=_PASSES, pattern="low_discrepancy", seed=1)
        picture = self.picture(view, rays)
        values = picture.visibility.values
        panel = Panel(
            name="reference",
            caption=f"reference: {each * _PASSES} rays",
            image=picture.srgb,
            values=values,
            ms=picture.info["wall_ms"],
        )
        known = self._standard_error(view, rays)
        return Reference(panel=panel, visibility=values, penumbra=_penumbra(values), standard_error=known)

    def _standard_error(self, view: View, technique: Technique) -> float:
        """Mean over the penumbra. Pictures do not know it, and visibility at a part of their size does."""
        size = max(self.size[0] // _COARSER, 1), max(self.size[1] // _COARSER, 1)
        coarse = visibility(
            view.scene, view.light, camera=replace(view.camera, size=size), technique=technique, device=self.device
        )
        penumbra = _penumbra(coarse.values)
        assert coarse.standard_error is not None
        return float(coarse.standard_error[penumbra].mean()) if penumbra.any() else math.nan


def difference(panel: Panel, other: Panel, limit: float) -> Panel:
    """False colours of what one panel shows more (red) or less (blue) than another, saturated at `limit`."""
    assert panel.values is not None
    assert other.values is not None
    errors = panel.values - other.values
    if errors.ndim == 3:
        errors = errors.mean(axis=-1)
    return Panel(
        name=f"{panel.name}_error",
        caption=f"{panel.name} − {other.name}, ±{limit:g}",
        image=colors.signed(errors / limit),
        values=errors,
    )


def _penumbra(values: NDArray[np.float32]) -> NDArray[np.bool_]:
    with np.errstate(invalid="ignore"):
        return np.asarray((values > _UMBRA_LIMIT) & (values < 1 - _UMBRA_LIMIT))


def _rmse(errors: NDArray[np.float32], penumbra: NDArray[np.bool_]) -> float:
    return float(np.sqrt(np.square(errors[penumbra], dtype=np.float64).mean())) if penumbra.any() else math.nan
