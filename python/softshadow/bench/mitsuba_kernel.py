"""Mitsuba's LLVM backend: one fused kernel, in which every receiver loops over the samples and counts those it sees."""

from __future__ import annotations

import time
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from .rays import Points

mi.set_variant("llvm_ad_rgb")


class Mitsuba:
    """A kernel written by hand, as fast as Mitsuba answers this question."""

    def __init__(self, vertices: Points, faces: NDArray[np.uint32]) -> None:
        mesh = mi.Mesh("scene", len(vertices), len(faces))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = vertices.ravel()
        parameters["faces"] = faces.ravel()
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})

    def visibility(self, origins: Points, normals: Points, targets: Points) -> tuple[Points, float]:
        """(receivers,) and milliseconds of the kernel."""
        p = mi.Point3f(np.ascontiguousarray(origins.T))
        n = mi.Normal3f(np.ascontiguousarray(normals.T))
        s = mi.Point3f(np.ascontiguousarray(targets.T))
        dr.eval(p, n, s)
        dr.sync_thread()
        start = time.perf_counter()
        result = _traced(self.scene, p, n, s, len(targets))
        dr.eval(result)
        dr.sync_thread()
        ms = (time.perf_counter() - start) * 1e3
        return np.array(result, dtype=np.float32) / np.float32(len(targets)), ms


def _count(scene: Any, p: Any, n: Any, s: Any, samples: int) -> Any:
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


_traced = dr.syntax(_count)
"""Symbolic: the loop is compiled, not unrolled."""
