"""From receivers and light samples to rays, for tracers that take rays one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float32]
Visible = Callable[[Points, Points], tuple[NDArray[np.bool_], float]]
"""From origins and targets to (receivers, samples) and the milliseconds of the query alone."""

_RAYS_AT_ONCE = 1 << 22


@dataclass(frozen=True, eq=False)
class Query:
    """What each tracer is asked: the share of the targets above its horizon that each receiver sees."""

    origins: Points
    normals: Points
    targets: Points
    probes: Points
    """A few other places on the light, for tracers that look for penumbrae first."""
    seen: NDArray[np.bool_]
    """(H, W): pixels with a receiver; receivers stand in the order of their pixels."""


def visibility(visible: Visible, query: Query) -> tuple[Points, float]:
    """The visible share of the samples, those above the horizon, and milliseconds; in blocks that fit the memory."""
    origins, normals, targets = query.origins, query.normals, query.targets
    step = max(_RAYS_AT_ONCE // len(targets), 1)
    parts, total = [], 0.0
    for start in range(0, len(origins), step):
        p, n = origins[start : start + step], normals[start : start + step]
        seen, ms = visible(p, targets)
        facing = np.einsum("rc,rsc->rs", n, targets[None] - p[:, None]) > 0
        parts.append((seen & facing).mean(axis=1, dtype=np.float32))
        total += ms
    return np.concatenate(parts), total
