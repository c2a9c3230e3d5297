"""Random scenes on which nothing was tuned: what stands or hangs over a ground, any light, any view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import softshadow as ss

Floats = NDArray[np.float64]
Part = tuple[Floats, NDArray[np.uint32]]
FIRST_SEED = 50_000
"""Development used seeds below this."""


@dataclass(frozen=True)
class HeldBack:
    """A scene with the light and the camera that it is judged with."""

    seed: int
    words: str
    scene: ss.Scene
    light: ss.Light
    camera: ss.Camera


def held_back(seed: int, size: tuple[int, int]) -> HeldBack:
    """The scene of a seed."""
    random = np.random.default_rng(seed)
    kind = ("boxes", "spheres", "leaves", "blinds", "mixed")[int(random.integers(5))]
    makers = {"boxes": [_boxes], "spheres": [_spheres], "leaves": [_leaves], "blinds": [_blinds]}
    makers["mixed"] = [_boxes, _spheres, _leaves]
    parts = [_ground(), *(make(random) for make in makers[kind])]
    meshes = [ss.Mesh(vertices=vertices, faces=faces) for vertices, faces in parts]
    light, words = _light(random)
    eye = np.array([random.uniform(1.5, 4), random.uniform(1, 4), random.uniform(1.5, 4)])
    camera = ss.Camera.look_at(
        eye=tuple(eye), target=(0, random.uniform(0, 0.8), 0), fov_y_deg=random.uniform(30, 55), size=size
    )
    triangles = sum(len(faces) for _, faces in parts)
    return HeldBack(seed, f"{kind}, {triangles:,} triangles, {words}", ss.Scene(meshes), light, camera)


def _light(random: np.random.Generator) -> tuple[ss.Light, str]:
    place = (random.uniform(-1.5, 1.5), random.uniform(2.5, 5), random.uniform(-1.5, 1.5))
    pose = ss.look_at(place, (random.uniform(-0.5, 0.5), 0, random.uniform(-0.5, 0.5)))
    size = float(random.uniform(0.2, 1.5))
    match int(random.integers(4)):
        case 0:
            return ss.RectLight(width=size, height=size * random.uniform(0.3, 1), world_from_light=pose), "rectangle"
        case 1:
            return ss.DiscLight(radius=size / 2, world_from_light=pose), "disc"
        case 2:
            return ss.SphereLight(radius=size / 2, world_from_light=pose), "sphere"
        case _:
            azimuth, elevation = float(random.uniform(0, 360)), float(random.uniform(35, 80))
            return ss.SunLight(azimuth, elevation, diameter_deg=float(random.uniform(0.5, 8))), "sun"


def _ground() -> Part:
    corners = np.array([[-5.0, 0, -5], [5, 0, -5], [5, 0, 5], [-5, 0, 5]])
    return corners, np.array([[0, 2, 1], [0, 3, 2]], dtype=np.uint32)


def _joined(pieces: list[Part]) -> Part:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces[:-1])])
    faces = [faces + start for (_, faces), start in zip(pieces, starts, strict=True)]
    return np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces).astype(np.uint32)


def _turned(random: np.random.Generator, points: Floats) -> Floats:
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return points @ turn.T


def _boxes(random: np.random.Generator) -> Part:
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])
    places = random.uniform([-1.5, 0.3, -1.5], [1.5, 1.5, 1.5], (int(random.integers(3, 40)), 3))
    return _joined([(_turned(random, corners * random.uniform(0.05, 0.3, 3)) + place, faces) for place in places])


def _spheres(random: np.random.Generator) -> Part:
    rings, around = int(random.integers(8, 40)), int(random.integers(12, 60))
    up, turn = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, around), indexing="ij")
    ball = np.stack([np.sin(up) * np.cos(turn), np.cos(up), np.sin(up) * np.sin(turn)], axis=-1).reshape(-1, 3)
    at = np.arange((rings - 1) * around).reshape(rings - 1, around)[:, :-1].ravel()
    faces = np.concatenate(
        [np.stack([at, at + 1, at + around], 1), np.stack([at + 1, at + around + 1, at + around], 1)]
    )
    places = random.uniform([-1.5, 0.3, -1.5], [1.5, 1.5, 1.5], (int(random.integers(1, 12)), 3))
    return _joined([(ball * random.uniform(0.1, 0.5) + place, faces) for place in places])


def _leaves(random: np.random.Generator) -> Part:
    count = int(random.integers(300, 12_000))
    side = random.uniform(0.03, 0.12)
    middle = random.normal(size=(count, 1, 3))
    middle *= 0.8 * random.uniform(0, 1, (count, 1, 1)) ** (1 / 3) / np.linalg.norm(middle, axis=2, keepdims=True)
    corners = middle + [0, 1.4, 0] + side * random.normal(size=(count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)


def _blinds(random: np.random.Generator) -> Part:
    count, wide = int(random.integers(5, 40)), random.uniform(0.3, 0.9)
    places = np.linspace(-1.5, 1.5, count)
    half = wide * 1.5 / count
    slat = np.array([[-half, 0, -1.5], [half, 0, -1.5], [half, 0, 1.5], [-half, 0, 1.5]])
    height = random.uniform(0.3, 2)
    faces = np.array([[0, 2, 1], [0, 3, 2]])
    return _joined([(slat + [x, height, 0], faces) for x in places])
