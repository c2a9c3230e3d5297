"""The measured scenes: real meshes on a ground, placed so that their float32 coordinates are the same for everybody.

The bounds are symmetric about the origin and 6 wide. The library's local frame then only scales by a power of two, so
positions in world units are float32 numbers, and another renderer traces exactly the same rays. ``softshadow-bench``
places its models in the same way.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from softshadow.camera import Camera, look_at
from softshadow.lights import RectLight
from softshadow.scene import Mesh, Scene


@dataclass(frozen=True)
class Measured:
    """A scene, its light and camera, and all its triangles as float32 corners."""

    name: str
    scene: Scene
    light: RectLight
    camera: Camera
    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


def meshes_folder() -> Path:
    """Where the public models are."""
    return Path(os.environ.get("SOFTSHADOW_MESHES", "../shared/meshes"))


def on_ground(file: str, size: int = 512) -> Measured:
    """A model of height 1 on a ground of 6 by 6 under a light of 1 by 1."""
    mesh = Scene.load(meshes_folder() / file).meshes[0]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    model = ((mesh.vertices - foot) / (high[1] - low[1]) - [0, 0.5, 0]).astype(np.float32)
    ground = np.array([[-3, -0.5, -3], [3, -0.5, -3], [3, -0.5, 3], [-3, -0.5, 3]], dtype=np.float32)
    floor = np.array([[0, 2, 1], [0, 3, 2]], dtype=np.uint32)
    scene = Scene(
        [
            Mesh(name="model", vertices=model.astype(np.float64), faces=mesh.faces),
            Mesh(name="ground", vertices=ground.astype(np.float64), faces=floor),
        ]
    )
    pose = look_at((1.5, 3.0, 1.0), (0, -0.2, 0))
    return Measured(
        name=Path(file).stem,
        scene=scene,
        light=RectLight(width=1.0, height=1.0, world_from_light=pose),
        camera=Camera.look_at(eye=(2.2, 1.4, 3.0), target=(0, -0.1, 0), fov_y_deg=40, size=(size, size)),
        vertices=np.vstack([model, ground]),
        faces=np.vstack([mesh.faces, floor + len(model)]).astype(np.uint32),
    )
