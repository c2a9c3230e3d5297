"""Embree through Open3D: what a Python user types."""

from __future__ import annotations

import time

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from . import rays
from .rays import Points, Query


class Open3D:
    """``RaycastingScene.test_occlusions``."""

    def __init__(self, vertices: Points, faces: NDArray[np.uint32]) -> None:
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))

    def visible(self, origins: Points, targets: Points) -> tuple[NDArray[np.bool_], float]:
        """(receivers, samples) and milliseconds of the query alone."""
        ways = targets[None] - origins[:, None]
        both = np.concatenate([np.broadcast_to(origins[:, None], ways.shape), ways], axis=2).reshape(-1, 6)
        query = o3d.core.Tensor(np.ascontiguousarray(both))
        start = time.perf_counter()
        hidden = self.scene.test_occlusions(query, tnear=0.0, tfar=1.0)
        ms = (time.perf_counter() - start) * 1e3
        return ~hidden.numpy().reshape(len(origins), len(targets)), ms

    def along(self, origins: Points, targets: Points) -> tuple[NDArray[np.bool_], float]:
        """(receivers,), each to a target of its own, and milliseconds of the query alone."""
        query = o3d.core.Tensor(np.concatenate([origins, targets - origins], axis=1))
        start = time.perf_counter()
        hidden = self.scene.test_occlusions(query, tnear=0.0, tfar=1.0)
        ms = (time.perf_counter() - start) * 1e3
        return ~hidden.numpy(), ms

    def visibility(self, query: Query) -> tuple[Points, float]:
        """(receivers,) and milliseconds of the queries."""
        return rays.visibility(self.visible, query)
