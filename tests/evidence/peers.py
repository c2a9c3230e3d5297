"""Independent ray tracers on the same receivers and samples: Embree through Open3D, and Mitsuba's LLVM kernel."""

from __future__ import annotations

import time

import drjit as dr
import mitsuba as mi
import numpy as np
import open3d as o3d
from numpy.typing import NDArray

mi.set_variant("llvm_ad_rgb")


class Embree:
    """Open3D's ``test_occlusions``: what a Python user types."""

    def __init__(self, vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> None:
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))

    def visible(self, origins: NDArray[np.float32], targets: NDArray[np.float32]) -> tuple[NDArray[np.bool_], float]:
        """(receivers, samples) and milliseconds of the query alone."""
        ways = targets[None] - origins[:, None]
        rays = np.concatenate([np.broadcast_to(origins[:, None], ways.shape), ways], axis=2).reshape(-1, 6)
        query = o3d.core.Tensor(np.ascontiguousarray(rays))
        start = time.perf_counter()
        hidden = self.scene.test_occlusions(query, tnear=0.0, tfar=1.0)
        ms = (time.perf_counter() - start) * 1e3
        return ~hidden.numpy().reshape(len(origins), len(targets)), ms


class Mitsuba:
    """One fused kernel: every receiver loops over the samples and counts those it sees."""

    def __init__(self, vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> None:
        mesh = mi.Mesh("scene", len(vertices), len(faces))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = vertices.ravel()
        parameters["faces"] = faces.ravel()
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})

    def visibility(
        self, origins: NDArray[np.float32], normals: NDArray[np.float32], targets: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float]:
        """(receivers,) and milliseconds of the kernel."""
        p = mi.Point3f(np.ascontiguousarray(origins.T))
        n = mi.Normal3f(np.ascontiguousarray(normals.T))
        s = mi.Point3f(np.ascontiguousarray(targets.T))
        dr.eval(p, n, s)
        dr.sync_thread()
        start = time.perf_counter()
        result = _count(self.scene, p, n, s, len(targets))
        dr.eval(result)
        dr.sync_thread()
        ms = (time.perf_counter() - start) * 1e3
        return np.array(result) / len(targets), ms


@dr.syntax
def _count(scene: mi.Scene, p: mi.Point3f, n: mi.Normal3f, s: mi.Point3f, samples: int) -> mi.Float:
    count = mi.Float(0)
    i = mi.UInt32(0)
    while i < samples:
        target = dr.gather(mi.Point3f, s, i)
        way = target - p
        ray = mi.Ray3f(p, way)
        ray.maxt = mi.Float(1)
        lit = (dr.dot(n, way) > 0) & ~scene.ray_test(ray)
        count += dr.select(lit, 1.0, 0.0)
        i += 1
    return count
