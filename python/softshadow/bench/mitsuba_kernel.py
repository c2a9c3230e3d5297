"""Mitsuba's LLVM backend: one fused kernel, in which every receiver loops over the samples and counts those it sees.

With probes: a kernel that counts a few samples, and another that counts all for receivers near which probes disagree.
"""

from __future__ import annotations

import time
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from .rays import Points, Query

mi.set_variant("llvm_ad_rgb")

_REACH = 4
"""Pixels to each side in which probes must agree. With 2 the error of 256 samples grows by a quarter on the bunny."""
_LIT, _DARK = 1, 2


class Mitsuba:
    """A kernel written by hand, as fast as Mitsuba answers this question."""

    def __init__(self, vertices: Points, faces: NDArray[np.uint32]) -> None:
        mesh = mi.Mesh("scene", len(vertices), len(faces))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = vertices.ravel()
        parameters["faces"] = faces.ravel()
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})

    def visibility(self, query: Query) -> tuple[Points, float]:
        """(receivers,) and milliseconds of the kernel."""
        p, n, s = mi.Point3f(query.origins.T), mi.Normal3f(query.normals.T), mi.Point3f(query.targets.T)
        dr.eval(p, n, s)
        dr.sync_thread()
        start = time.perf_counter()
        result = _traced(self.scene, p, n, s, len(query.targets)) / len(query.targets)
        dr.eval(result)
        dr.sync_thread()
        ms = (time.perf_counter() - start) * 1e3
        return np.array(result, dtype=np.float32), ms


class Probing(Mitsuba):
    """All samples only where the probes of a receiver or of its neighbours disagree; elsewhere the probes answer."""

    def visibility(self, query: Query) -> tuple[Points, float]:
        """(receivers,) and milliseconds of both kernels, and of what lies between them."""
        p, n, s = mi.Point3f(query.origins.T), mi.Normal3f(query.normals.T), mi.Point3f(query.targets.T)
        probes = mi.Point3f(query.probes.T)
        row, column = np.nonzero(query.seen)
        # With a margin, so that no neighbour lies outside.
        width = query.seen.shape[1] + 2 * _REACH
        size = (query.seen.shape[0] + 2 * _REACH) * width
        pixel = mi.UInt32((row + _REACH) * width + column + _REACH)
        dr.eval(p, n, s, probes, pixel)
        dr.sync_thread()
        start = time.perf_counter()
        share = _traced(self.scene, p, n, probes, len(query.probes)) / len(query.probes)
        dr.eval(share)
        classes = dr.zeros(mi.UInt32, size)
        dr.scatter(classes, dr.select(share > 0, mi.UInt32(_LIT), 0) | dr.select(share < 1, mi.UInt32(_DARK), 0), pixel)
        dr.eval(classes)
        around = mi.UInt32(0)
        for y in range(-_REACH, _REACH + 1):
            for x in range(-_REACH, _REACH + 1):
                around |= dr.gather(mi.UInt32, classes, pixel + mi.UInt32((y * width + x) % (1 << 32)))
        mixed = dr.compress(around == (_LIT | _DARK))
        if len(mixed) > 0:
            origins, normals = dr.gather(mi.Point3f, p, mixed), dr.gather(mi.Normal3f, n, mixed)
            dr.scatter(share, _traced(self.scene, origins, normals, s, len(query.targets)) / len(query.targets), mixed)
        dr.eval(share)
        dr.sync_thread()
        ms = (time.perf_counter() - start) * 1e3
        return np.array(share, dtype=np.float32), ms


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
