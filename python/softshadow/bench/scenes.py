"""The measured scenes: real meshes on a ground, placed so that their float32 coordinates are the same for everybody.

The library rounds positions to float32 about the centre of a scene's bounds, scaled by a power of two. About that
centre its vertices, receivers and light samples are float32 numbers, so another renderer can trace exactly the same
rays. Models stand in bounds that are symmetric about the origin and 6 wide, the tallest is 1 high: there world
coordinates are such numbers themselves. ``softshadow-bench`` places its models in the same way.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from softshadow import scenes
from softshadow.camera import Camera, look_at
from softshadow.errors import SceneError
from softshadow.lights import Light, RectLight
from softshadow.scene import Mesh, Scene


@dataclass(frozen=True, eq=False)
class Measured:
    """A scene, its light and camera."""

    name: str
    scene: Scene
    light: Light
    camera: Camera

    @cached_property
    def center(self) -> NDArray[np.float64]:
        """The middle of the scene's bounds in world coordinates, about which positions are float32 numbers."""
        if self.scene.bounds is None:
            raise SceneError(f"{self.name}: a scene without vertices has no center")
        low, high = self.scene.bounds
        center: NDArray[np.float64] = low * 0.5 + high * 0.5
        return center

    @cached_property
    def vertices(self) -> NDArray[np.float32]:
        """All corners about the center, rounded as the library rounds them."""
        return (_joined(self.scene.meshes)[0] - self.center).astype(np.float32)

    @cached_property
    def faces(self) -> NDArray[np.uint32]:
        """All triangles, three of the corners each, in the order of the library's ids."""
        return _joined(self.scene.meshes)[1]

    def stored(self, positions: NDArray[np.float64]) -> NDArray[np.float32]:
        """Receivers or light samples of a result about the center, as the library stores them.

        World coordinates have lost at most a rounding of float64 on their way; anything farther from a float32 number
        was never one.

        Raises
        ------
        SceneError
            For positions that are no float32 numbers about the center.
        """
        about = positions - self.center
        rounded = about.astype(np.float32)
        largest = max(float(np.abs(positions).max(initial=0.0)), float(np.abs(self.center).max()))
        if not (np.abs(rounded - about) <= 2.0**-52 * largest).all():
            raise SceneError(f"{self.name}: positions are no float32 numbers about the center of the scene's bounds")
        return rounded


@dataclass(frozen=True)
class Model:
    """A mesh file; x and z of the middle of its foot, and its turn about the upright axis."""

    file: str
    foot: tuple[float, float] = (0.0, 0.0)
    turned_deg: float = 0.0
    height: float = 1.0


PLACED = {
    "bunny": (Model("stanford-bunny.obj"),),
    "teapots": (
        Model("teapot.obj", (-0.7, 0.4), 20.0, 0.6),
        Model("teapot.obj", (0.8, 0.9), 130.0, 0.45),
        Model("cow.obj", (0.2, -0.5), 70.0),
    ),
}
"""Scenes of models by name."""


def meshes_folder() -> Path:
    """Where the public models are."""
    return Path(os.environ.get("SOFTSHADOW_MESHES", "../shared/meshes"))


def find(name: str, size: int = 512) -> Measured:
    """A scene by name, shipped or placed, or a mesh file on its own; in a square image."""
    if name in scenes.names():
        return _shipped(name, size)
    if name in PLACED:
        return _on_ground(name, PLACED[name], size)
    return _on_ground(Path(name).stem, (Model(name),), size)


def _shipped(name: str, size: int) -> Measured:
    shipped = scenes.load(name)
    look = shipped.camera
    camera = Camera(world_from_camera=look.world_from_camera, fov_y_deg=look.fov_y_deg, size=(size, size))
    return Measured(name, shipped.scene, shipped.light, camera)


def _on_ground(name: str, models: tuple[Model, ...], size: int) -> Measured:
    """Models on a ground of 6 by 6 under a light of 1 by 1."""
    ground = np.array([[-3, -0.5, -3], [3, -0.5, -3], [3, -0.5, 3], [-3, -0.5, 3]])
    floor = Mesh(name="ground", vertices=ground, faces=np.array([[0, 2, 1], [0, 3, 2]], dtype=np.uint32))
    scene = Scene([*(_placed(model) for model in models), floor])
    light = RectLight(width=1.0, height=1.0, world_from_light=look_at((1.5, 3.0, 1.0), (0, -0.2, 0)))
    camera = Camera.look_at(eye=(2.2, 1.4, 3.0), target=(0, -0.1, 0), fov_y_deg=40, size=(size, size))
    return Measured(name, scene, light, camera)


def _placed(model: Model) -> Mesh:
    """All meshes of a file as one; its coordinates are float32 numbers."""
    vertices, faces = _joined(Scene.load(meshes_folder() / model.file).meshes)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    x, y, z = ((vertices - foot) * model.height / (high[1] - low[1])).T
    angle = np.deg2rad(model.turned_deg)
    sine, cosine = np.sin(angle), np.cos(angle)
    turned = [model.foot[0] + cosine * x + sine * z, y - 0.5, model.foot[1] - sine * x + cosine * z]
    rounded = np.stack(turned, axis=1).astype(np.float32).astype(np.float64)
    return Mesh(name=Path(model.file).stem, vertices=rounded, faces=faces)


def _joined(meshes: Sequence[Mesh]) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.faces + start for mesh, start in zip(meshes, first, strict=False)]
    return np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces).astype(np.uint32)
