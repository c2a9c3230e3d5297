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
    positions : float64, (samples, 3), or one such array a receiver: (n, samples, 3), (H, W, samples, 3)
        World coordinates; directions towards the light where `at_infinity`; NaN from inside a sphere. One array a
        receiver for a sphere, and where receivers do not share their samples.
    parameters : float32, (samples, 2), or one such array a receiver
        Place on the light: [-1, 1]² on a rectangle, the unit disc on disc, sphere and sun, light-local world
        units on a polygon. One array a receiver only where receivers do not share their samples.
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
    spread: str = RayTraced.spread,
    tile: int = RayTraced.tile,
) -> LightPoints:
    """The samples that a technique with these settings uses, as stored in float32 around the scene's centre.

    Parameters
    ----------
    light : light
        The light.
    samples : int
        How many.
    receivers : (n, 3) float, or (H, W, 3) for a camera's pixels
        World coordinates, all receivers of a call in its order: which of several sets one takes follows from its place.
        Needed for a sphere, of which every receiver sees its own disc, and where receivers do not share their samples;
        an image where samples interleave. A pixel that sees nothing may have any finite position.
    scene : Scene
        Its centre and extent decide the rounding.
    pattern, seed, spread, tile
        As in :class:`RayTraced`.

    Returns
    -------
    LightPoints

    Raises
    ------
    SceneError, SettingsError
        For bad arrays and settings, and where receivers are needed and not given.
    """
    if not isinstance(light, Light):
        raise SceneError(f"light: one light expected, got {light!r:.80}")
    is_sphere = isinstance(light, SphereLight)
    shared = choice("spread", spread, ("correlated", "decorrelated", "interleaved")) == "correlated"
    if is_sphere and receivers is None:
        raise SceneError("receivers: a sphere shows every receiver its own disc; give (n, 3) positions")
    if not shared and receivers is None:
        raise SceneError(f"receivers: {spread} receivers have samples of their own; give (n, 3) or (H, W, 3) positions")
    shape = ("height", "width", 3) if getattr(receivers, "ndim", 2) == 3 else ("n", 3)
    where = floats("receivers", np.empty((0, 3)) if receivers is None else receivers, shape)
    arrays = _core.light_points(
        scene_of(scene),
        light._built(),
        choice("pattern", pattern, ("stratified", "low_discrepancy")),
        whole("samples", samples, low=1),
        whole("seed", seed),
        spread,
        whole("tile", tile),
        where.reshape(-1, 3),
        where.shape[1] if where.ndim == 3 else 0,
    )
    positions, parameters = arrays["positions"], arrays["parameters"]
    return LightPoints(
        positions=positions.reshape((samples, 3) if shared and not is_sphere else (*where.shape[:-1], samples, 3)),
        parameters=parameters.reshape((samples, 2) if shared else (*where.shape[:-1], samples, 2)),
        at_infinity=arrays["at_infinity"],
    )
