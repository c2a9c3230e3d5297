"""Area lights.

A light lies in its local XY plane and emits along local −Z; sizes are full widths and heights in world units.
It does not block light itself. ``world_from_light`` is a rotation and a translation, which
:func:`softshadow.look_at` makes. A light of size zero is allowed: its shadow is hard.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .by_value import ByValue, set_fields
from .checks import choice, color, floats, frozen, matrix, real, text
from .errors import SceneError

WHITE = (1.0, 1.0, 1.0)


class Light(ByValue, ABC):
    """Base of all lights; only its kinds can be made."""

    name: str

    @abstractmethod
    def _built(self) -> _core.Light:
        """The checked light of the core."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RectLight(Light):
    """A rectangle that emits from one side.

    Parameters
    ----------
    width, height : float
        Full extent along local X and Y, in world units.
    world_from_light : (4, 4) float
        Pose of the light.
    radiance : (3,) float
        Linear red, green, blue.
    texture : (h, w, 3) float, optional
        Multiplies the radiance; row 0 lies at local +Y. Results then have a last axis of 3.
    name : str
        What columns and channels of saved results are called.

    Raises
    ------
    SceneError
        For sizes, matrices or colours that have no meaning.
    """

    width: float
    height: float
    world_from_light: NDArray[np.float64]
    radiance: tuple[float, float, float] = WHITE
    texture: NDArray[np.float32] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        set_fields(
            self,
            width=real("light width", self.width),
            height=real("light height", self.height),
            texture=None if self.texture is None else _texture(self.texture),
            **_pose_and_radiance(self),
        )
        self._built()

    def _built(self) -> _core.Light:
        pose = self.world_from_light.tolist()
        return _core.Light.rectangle(self.width, self.height, pose, self.radiance, self.texture)


@dataclass(frozen=True, kw_only=True, eq=False)
class DiscLight(Light):
    """A disc that emits from one side.

    Parameters
    ----------
    radius : float
        In world units.
    world_from_light : (4, 4) float
        Pose of the light.
    radiance : (3,) float
        Linear red, green, blue.
    name : str
        What columns and channels of saved results are called.

    Raises
    ------
    SceneError
        For sizes, matrices or colours that have no meaning.
    """

    radius: float
    world_from_light: NDArray[np.float64]
    radiance: tuple[float, float, float] = WHITE
    name: str = ""

    def __post_init__(self) -> None:
        set_fields(self, radius=real("light radius", self.radius), **_pose_and_radiance(self))
        self._built()

    def _built(self) -> _core.Light:
        return _core.Light.disc(self.radius, self.world_from_light.tolist(), self.radiance)


@dataclass(frozen=True, kw_only=True, eq=False)
class SphereLight(Light):
    """A ball. Every receiver sees its own disc of it; visibility is a share of solid angle.

    Parameters
    ----------
    radius : float
        In world units.
    world_from_light : (4, 4) float
        Pose of the light; only its centre matters.
    radiance : (3,) float
        Linear red, green, blue.
    name : str
        What columns and channels of saved results are called.

    Raises
    ------
    SceneError
        For sizes, matrices or colours that have no meaning.
    """

    radius: float
    world_from_light: NDArray[np.float64]
    radiance: tuple[float, float, float] = WHITE
    name: str = ""

    def __post_init__(self) -> None:
        set_fields(self, radius=real("light radius", self.radius), **_pose_and_radiance(self))
        self._built()

    def _built(self) -> _core.Light:
        return _core.Light.sphere(self.radius, self.world_from_light.tolist(), self.radiance)


@dataclass(frozen=True, kw_only=True, eq=False)
class PolygonLight(Light):
    """A simple polygon that emits from one side.

    Parameters
    ----------
    outline : (n, 2) float
        Corners in the light's XY plane, wound either way, in world units.
    world_from_light : (4, 4) float
        Pose of the light.
    radiance : (3,) float
        Linear red, green, blue.
    name : str
        What columns and channels of saved results are called.

    Raises
    ------
    SceneError
        For outlines without area or that cross themselves, and as for the other lights.
    """

    outline: NDArray[np.float64]
    world_from_light: NDArray[np.float64]
    radiance: tuple[float, float, float] = WHITE
    name: str = ""

    def __post_init__(self) -> None:
        outline = frozen(floats("light outline", self.outline, ("n", 2)))
        set_fields(self, outline=outline, **_pose_and_radiance(self))
        self._built()

    def _built(self) -> _core.Light:
        return _core.Light.polygon(self.outline.tolist(), self.world_from_light.tolist(), self.radiance)


@dataclass(frozen=True, eq=False)
class SunLight(Light):
    """A disc at infinity.

    Parameters
    ----------
    azimuth : float
        Degrees clockwise from north, seen from above. East is +X; north is −Z with ``up="y"`` and +Y with
        ``up="z"``.
    elevation : float
        Degrees above the horizon.
    diameter_deg : float
        Angle that the disc spans, in degrees.
    up : {"y", "z"}
        The world's up axis.
    radiance : (3,) float
        Linear red, green, blue.
    name : str
        What columns and channels of saved results are called.

    Raises
    ------
    SceneError, SettingsError
        For angles or colours that have no meaning, and an unknown axis.
    """

    azimuth: float
    elevation: float
    _: KW_ONLY
    diameter_deg: float = 0.53
    up: str = "y"
    radiance: tuple[float, float, float] = WHITE
    name: str = ""

    def __post_init__(self) -> None:
        set_fields(
            self,
            azimuth=real("sun azimuth", self.azimuth),
            elevation=real("sun elevation", self.elevation),
            diameter_deg=real("sun diameter_deg", self.diameter_deg),
            up=choice("sun up", self.up, ("y", "z")),
            radiance=color("light radiance", self.radiance),
            name=text("light name", self.name),
        )
        self._built()

    def _built(self) -> _core.Light:
        return _core.Light.sun(self.azimuth, self.elevation, self.diameter_deg, self.up, self.radiance)


def built_lights(lights: Light | Sequence[Light]) -> tuple[list[_core.Light], bool]:
    """The lights of the core, and whether the caller gave several."""
    if isinstance(lights, Light):
        return [lights._built()], False
    if not isinstance(lights, (list, tuple)) or not all(isinstance(light, Light) for light in lights):
        raise SceneError(f"lights: a light or a list of lights expected, got {lights!r:.80}")
    if not lights:
        raise SceneError("lights: at least one is needed")
    return [light._built() for light in lights], True


def _pose_and_radiance(light: Any) -> dict[str, object]:
    return {
        "world_from_light": matrix("world_from_light", light.world_from_light),
        "radiance": color("light radiance", light.radiance),
        "name": text("light name", light.name),
    }


def _texture(texture: NDArray[Any]) -> NDArray[np.float32]:
    wide = floats("light texture", texture, ("h", "w", 3))
    with np.errstate(over="ignore"):  # What float32 cannot hold becomes infinite, which is refused by name.
        return frozen(wide.astype(np.float32))
