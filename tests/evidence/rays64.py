"""The verdict on a single ray in float64, over all triangles: who is right where two tracers differ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def judge(
    vertices: NDArray[np.float32],
    faces: NDArray[np.uint32],
    origin: NDArray[np.float32],
    target: NDArray[np.float32],
    own_triangle: int,
) -> tuple[bool, float]:
    """Whether the segment is free, and how near to an edge the nearest decision was.

    The second number is the smallest deciding determinant over the sum of its absolute products, in float32 roundings
    (2^-24): below about 8 a float32 tracer may decide either way.
    """
    corners = vertices[faces].astype(np.float64)
    p, d = origin.astype(np.float64), target.astype(np.float64) - origin.astype(np.float64)
    a, b = corners[:, 0] - p, corners[:, 1] - p
    e01, e12, e02 = (corners[:, j] - corners[:, i] for i, j in ((0, 1), (1, 2), (0, 2)))
    normal = np.cross(e01, e02)
    pairs = [
        _triple(d, a, e01),
        _triple(d, b, e12),
        _triple(d, a, -e02),
    ]
    along, offset = normal @ d, (normal * a).sum(1)
    values = np.array([value for value, _ in pairs])
    inside = (values >= 0).all(0) | (values <= 0).all(0)
    ahead = (offset * along > 0) & (np.abs(offset) < np.abs(along))
    blocks = inside & ahead
    blocks[own_triangle] = False
    # Only triangles whose plane is crossed can be decided either way by an edge.
    relative = np.array([np.abs(value) / np.maximum(size, 1e-300) for value, size in pairs]).min(0) * 2.0**24
    nearly = (values >= -8 * 2.0**-24 * np.array([s for _, s in pairs])).all(0) | (
        values <= 8 * 2.0**-24 * np.array([s for _, s in pairs])
    ).all(0)
    near = relative[ahead & nearly]
    return not blocks.any(), float(near.min()) if len(near) else float("inf")


def _triple(
    d: NDArray[np.float64], a: NDArray[np.float64], e: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The determinants d·(a×e), and the sums of their absolute products."""
    value = np.cross(a, e) @ d
    x, y, z = np.abs(d), np.abs(a), np.abs(e)
    cross = np.stack(
        [
            y[:, 1] * z[:, 2] + y[:, 2] * z[:, 1],
            y[:, 2] * z[:, 0] + y[:, 0] * z[:, 2],
            y[:, 0] * z[:, 1] + y[:, 1] * z[:, 0],
        ],
        axis=1,
    )
    return value, cross @ x
