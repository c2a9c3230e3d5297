"""Shared scenes: a square card over a floor, small enough for a software adapter."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from PIL import Image

import softshadow as ss

FLOOR = np.array([[-4.0, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]])
CARD = np.array([[-0.5, 1.0, -0.5], [0.5, 1, -0.5], [0.5, 1, 0.5], [-0.5, 1, 0.5]])
SQUARE = np.array([[0, 1, 2], [0, 2, 3]])

visibility = functools.partial(ss.visibility, device="software")
render = functools.partial(ss.render, device="software")
compare = functools.partial(ss.compare, device="software")


def light_above(side: float = 1.0, **settings: object) -> ss.RectLight:
    pose = ss.look_at((0, 3, 0), (0, 0, 0))
    return ss.RectLight(width=side, height=side, world_from_light=pose, **settings)


def camera_above(size: tuple[int, int] = (16, 12)) -> ss.Camera:
    return ss.Camera.look_at(eye=(3, 4, 3), target=(0, 0, 0), fov_y_deg=50, size=size)


def read_png(source: object) -> np.ndarray:
    with Image.open(source) as image:
        return np.array(image)


@pytest.fixture
def scene() -> ss.Scene:
    return ss.Scene(
        [
            ss.Mesh(vertices=FLOOR, faces=SQUARE, name="floor"),
            ss.Mesh(vertices=CARD, faces=SQUARE, name="card"),
        ]
    )


@pytest.fixture
def floor_points() -> np.ndarray:
    """A row of points on the floor, from the umbra of the card to full light."""
    return np.stack([np.linspace(0, 3, 13), np.full(13, 1e-3), np.zeros(13)], axis=1)
