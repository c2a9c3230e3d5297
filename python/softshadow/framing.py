"""A light and a camera for a scene that brings none. +Y is taken for up."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, look_at
from .lights import RectLight
from .scene import Scene

_FOV_Y_DEG = 40.0
_MARGIN = 1.05


def lit_from_above(scene: Scene) -> RectLight:
    """A square light above the scene's bounds, to one side, as bright as a white floor under it can show."""
    center, radius = _ball(scene)
    offset = np.array([0.8, 2.0, 0.6]) * radius
    side = 0.6 * radius
    # A small light of radiance L and area A gives the irradiance L·A/d² at distance d; π makes white 1.
    radiance = float(math.pi * (offset @ offset) / side**2)
    pose = look_at(center + offset, center)
    return RectLight(width=side, height=side, world_from_light=pose, radiance=(radiance,) * 3)


def framed(scene: Scene, size: tuple[int, int]) -> Camera:
    """A camera that has the whole scene in view."""
    center, radius = _ball(scene)
    half_y = math.radians(_FOV_Y_DEG) / 2
    half_angle = math.atan(math.tan(half_y) * min(1.0, size[0] / max(size[1], 1)))
    direction = np.array([0.5, 0.45, 1.0])
    distance = _MARGIN * radius / math.sin(half_angle)
    eye = center + direction / np.linalg.norm(direction) * distance
    return Camera.look_at(eye=eye, target=center, fov_y_deg=_FOV_Y_DEG, size=size)


def _ball(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """A ball around the scene; the unit ball where there is nothing or a single point."""
    bounds = scene.bounds
    if bounds is None:
        return np.zeros(3), 1.0
    low, high = bounds
    return low / 2 + high / 2, float(np.linalg.norm(high / 2 - low / 2)) or 1.0
