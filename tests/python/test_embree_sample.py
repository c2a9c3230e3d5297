"""An independent tracer's rays: Embree's stored answers on a shipped scene (see tests/evidence/embree_sample.py)."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

import softshadow as ss
from conftest import visibility

STORED = Path(__file__).with_name("embree_sample.npz")
SHA256 = "ac0efb78084c20768bbf3fc11236696b4e47b19752be93da876d9bbd729dcfc8"


def differing(scene: ss.Scene) -> tuple[int, int]:
    """Rays that differ from Embree's, and how many there are."""
    light = ss.scenes.load("toruses").light
    with np.load(STORED) as stored:
        origins, samples, visible = (stored[name] for name in ("origins", "samples", "visible"))
    ours = ss.light_points(light, 16, scene=ss.scenes.load("toruses").scene).positions.reshape(-1, 3)
    np.testing.assert_allclose(ours, samples, atol=1e-6)
    result = visibility(
        scene,
        light,
        points=origins.astype(np.float64),
        technique=ss.RayTraced(samples=16),
        sample_masks=True,
    )
    theirs = np.unpackbits(visible, axis=1, count=16).astype(bool)
    return int((result.visible_samples != theirs).sum()), theirs.size


def test_no_ray_differs_from_embree():
    assert hashlib.sha256(STORED.read_bytes()).hexdigest() == SHA256, "the stored answers are those that were made"
    count, of = differing(ss.scenes.load("toruses").scene)
    assert of > 40_000
    # At most 1e-5 of the rays may be decided otherwise, by rounding; of so few that is none.
    assert count <= 1e-5 * of, f"{count} of {of} rays differ"


def test_a_moved_mesh_is_seen():
    scene = ss.scenes.load("toruses").scene
    # The same bounds, so the same frame: some vertices of the toruses move towards the middle.
    moved = []
    for mesh in scene.meshes:
        vertices = mesh.vertices.copy()
        vertices[100::50] *= [0.98, 1.0, 0.98]
        moved.append(ss.Mesh(name=mesh.name, vertices=vertices, faces=mesh.faces))
    count, of = differing(ss.Scene(moved))
    assert count > 1e-5 * of
