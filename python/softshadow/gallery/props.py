"""What is built for exhibits: meshes of a few lines, +Y up."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softshadow.scene import Mesh

_SQUARE = np.array([[0, 1, 2], [0, 2, 3]])
_CUBE_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)


def quads(name: str, corners: ArrayLike, color: tuple[float, float, float], opacity: float = 1.0) -> Mesh:
    """Quads of (n, 4, 3) corners."""
    vertices = np.asarray(corners, np.float64).reshape(-1, 3)
    faces = (4 * np.arange(len(vertices) // 4)[:, None, None] + _SQUARE).reshape(-1, 3)
    return Mesh(name=name, vertices=vertices, faces=faces, base_color=color, opacity=opacity, specular=0.0)


def floor(side: float, color: tuple[float, float, float] = (0.75, 0.73, 0.7)) -> Mesh:
    """A square at height 0."""
    h = side / 2
    return quads("floor", [[-h, 0, -h], [-h, 0, h], [h, 0, h], [h, 0, -h]], color)


def boxes(name: str, lower: ArrayLike, upper: ArrayLike, color: tuple[float, float, float]) -> Mesh:
    """Boxes along the axes between (n, 3) lower and upper corners."""
    ends = np.stack([np.asarray(lower, np.float64), np.asarray(upper, np.float64)])
    bits = (np.arange(8)[:, None] >> np.array([2, 1, 0])) & 1
    corners = np.where(bits[None] == 1, ends[1][:, None], ends[0][:, None])
    return quads(name, corners[:, _CUBE_SIDES], color)


def ball(center: ArrayLike, radius: float, color: tuple[float, float, float], segments: int = 48) -> Mesh:
    """A sphere of rings; its poles are fans."""
    rings = segments // 2
    theta, phi = np.meshgrid(
        np.linspace(0, math.pi, rings + 1)[1:-1], np.arange(segments) * (2 * math.pi / segments), indexing="ij"
    )
    around = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)
    vertices = np.concatenate([around.reshape(-1, 3), [[0, 1, 0], [0, -1, 0]]]) * radius + np.asarray(center)
    top, bottom = len(vertices) - 2, len(vertices) - 1
    here = np.arange((rings - 1) * segments).reshape(rings - 1, segments)
    right = np.roll(here, -1, axis=1)
    bands = [np.stack([a, b, c], axis=-1).reshape(-1, 3) for a, b, c in (
        (here[:-1], right[:-1], here[1:]), (right[:-1], right[1:], here[1:])
    )]  # fmt: skip
    fans = [
        np.stack([right[0], here[0], np.full(segments, top)], axis=-1),
        np.stack([here[-1], right[-1], np.full(segments, bottom)], axis=-1),
    ]
    return Mesh(
        name="ball",
        vertices=vertices,
        faces=np.concatenate(bands + fans),
        base_color=color,
        roughness=0.5,
        specular=0.1,
    )


def leaves(count: int, center: ArrayLike, reach: ArrayLike, size: float, opacity: float) -> Mesh:
    """Rectangles of `size` by half of it, at random in a box of half extents `reach`, lying more than standing."""
    chance = np.random.default_rng(7)
    middle = np.asarray(center) + np.asarray(reach) * chance.uniform(-1, 1, (count, 3))
    tips = chance.normal(size=(count, 3)) * [1, 0.4, 1]
    along = size / 2 * tips / np.linalg.norm(tips, axis=1, keepdims=True)
    across = np.cross(along, [0, 1, 0] + 0.5 * chance.normal(size=(count, 3)))
    across *= size / 4 / np.linalg.norm(across, axis=1, keepdims=True)
    corners = np.stack([middle - along, middle + across, middle + along, middle - across], axis=1)
    return quads("leaves", corners, (0.3, 0.55, 0.2), opacity)


def radiance(distance: float, area: float) -> tuple[float, float, float]:
    """Of a light of this area that makes a white surface white which faces it at this distance."""
    power = math.pi * distance**2 / area
    return power, power, power


def flame(moment: float, rows: int = 72, columns: int = 96) -> NDArray[np.float32]:
    """A frame of a fire, (rows, columns, 3): hot and wide below, swaying tongues above."""
    height = np.linspace(1, 0, rows)[:, None]
    across = np.linspace(-1, 1, columns)[None, :]
    tongues = ((-0.45, 0.7, 0.2), (0.1, 1.0, 0.28), (0.55, 0.6, 0.18))
    body = np.zeros((rows, columns))
    for foot, tall, wide in tongues:
        rise = np.clip(height / tall, 0, 1)
        sway = foot + 0.35 * rise * np.sin(4 * rise + 5 * foot - 2 * math.pi * moment)
        body += np.exp(-(((across - sway) / (wide * (1.15 - rise))) ** 2)) * (1 - rise**3)
    body = np.minimum(body, 1)
    return np.stack([body, 0.55 * body**2, 0.16 * body**4], axis=-1).astype(np.float32)
