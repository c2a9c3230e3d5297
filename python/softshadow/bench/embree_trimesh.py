"""Embree through trimesh and embreex."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.ray.ray_pyembree import RayMeshIntersector

from . import rays
from .rays import Points, Query


class Trimesh:
    """``intersects_any``. Its rays do not end at the light: nothing may lie beyond."""

    def __init__(self, vertices: Points, faces: NDArray[np.uint32]) -> None:
        self.tracer: Any = RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))

    def visible(self, origins: Points, targets: Points) -> tuple[NDArray[np.bool_], float]:
        """(receivers, samples) and milliseconds of the query alone."""
        ways = (targets[None] - origins[:, None]).reshape(-1, 3)
        starts = np.repeat(origins, len(targets), axis=0)
        start = time.perf_counter()
        hidden: NDArray[np.bool_] = self.tracer.intersects_any(starts, ways)
        ms = (time.perf_counter() - start) * 1e3
        return ~hidden.reshape(len(origins), len(targets)), ms

    def visibility(self, query: Query) -> tuple[Points, float]:
        """(receivers,) and milliseconds of the queries."""
        return rays.visibility(self.visible, query)
