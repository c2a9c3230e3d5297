"""Embree's answers on a shipped scene, stored so that every test run can be held against an independent tracer.

Run as a script where Open3D is installed, this makes ``tests/python/embree_sample.npz`` anew.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import softshadow as ss
from softshadow.bench.embree_open3d import Open3D

STORED = Path(__file__).parents[1] / "python" / "embree_sample.npz"


def main() -> None:
    """Receivers of a small camera, their samples, and which of them Embree sees."""
    shipped = ss.scenes.load("toruses")
    meshes = shipped.scene.meshes
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    vertices = np.concatenate([mesh.vertices for mesh in meshes]).astype(np.float32)
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=False)]).astype(np.uint32)
    look = shipped.camera
    camera = ss.Camera(world_from_camera=look.world_from_camera, fov_y_deg=look.fov_y_deg, size=(72, 48))
    placed = ss.visibility(shipped.scene, shipped.light, camera=camera, receivers=True, device="software")
    # A hair further off the surface: in world float32 the receivers are rounded anew.
    lifted = placed.positions[placed.valid] + 1e-5 * placed.normals[placed.valid]
    origins = lifted.astype(np.float32)
    samples = ss.light_points(shipped.light, 16, scene=shipped.scene).positions.reshape(-1, 3).astype(np.float32)
    visible, _ = Open3D(vertices, faces).visible(origins, samples)
    np.savez_compressed(STORED, origins=origins, samples=samples, visible=np.packbits(visible, axis=1))
    print(f"{STORED}: {visible.size} rays, {visible.mean():.3f} of them visible")


if __name__ == "__main__":
    main()
