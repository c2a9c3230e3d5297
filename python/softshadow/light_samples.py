"""Where the samples of a light lie, for comparison with other programs sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .checks import choice, floats, whole
from .errors import SceneError
from .lights import Light, SphereLight
from .scene import Scene
from .techniques import RayTraced
from .visibility import scene_of


@dataclass(frozen=True, kw_only=True, eq=False)
class LightPoints:
    """The result of :func:`light_points`.

    Attributes
    ----------
    positions : float64, (samples, 3), for a sphere (receivers, samples, 3)
        World coordinates; directions towards the light where `at_infinity`; NaN from inside a sphere.
    parameters : float32, (samples, 2)
        Place on the light: [-1, 1]² on a rectangle, the unit disc on disc, sphere and sun, light-local world
        units on a polygon.
    at_infinity : bool
        True for a sun.
    """

    positions: NDArray[np.float64]
    parameters: NDArray[np.float32]
    at_infinity: bool


def light_points(
    light: Light,
    samples: int,
    receivers: ArrayLike | None = None,
    *,
    scene: Scene,
    pattern: str = RayTraced.pattern,
    seed: int = RayTraced.seed,
) -> LightPoints:
    """The samples that a technique with these settings uses, as stored in float32 around the scene's centre.

    Parameters
    ----------
    light : light
        The light.
    samples : int
        How many.
    receivers : (n, 3) float
        World coordinates; needed for a sphere, of which every receiver sees its own disc.
    scene : Scene
        Its centre and extent decide the rounding.
    pattern, seed
        As in :class:`RayTraced`.

    Raises
    ------
    SceneError, SettingsError
        For bad arrays and settings, and for a sphere without receivers.
    """
    if not isinstance(light, Light):
        raise SceneError(f"light: one light expected, got {light!r:.80}")
    is_sphere = isinstance(light, SphereLight)
    if is_sphere and receivers is None:
        raise SceneError("receivers: a sphere shows every receiver its own disc; give (n, 3) positions")
    arrays = _core.light_points(
        scene_of(scene),
        light._built(),
        choice("pattern", pattern, ("stratified", "low_discrepancy")),
        whole("samples", samples, low=1),
        whole("seed", seed),
        floats("receivers", np.empty((0, 3)) if receivers is None else receivers, ("n", 3)),
    )
    positions = arrays["positions"].reshape(arrays["rows"], samples, 3)
    return LightPoints(
        positions=positions if is_sphere else positions[0],
        parameters=arrays["parameters"].reshape(-1, 2),
        at_infinity=arrays["at_infinity"],
    )
