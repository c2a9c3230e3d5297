"""Memory over thousands of calls: each with a scene, a light and receivers of its own, so that nothing can be kept.

``python tests/evidence/memory.py --calls 10000 --device native`` prints what the process holds after every tenth of the
calls. The first tenth fills caches; what comes after it has to stay flat.
"""

from __future__ import annotations

import argparse
import gc
from pathlib import Path

import numpy as np

import softshadow as ss

FLOOR = np.array([[-4.0, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]])
SQUARE = np.array([[0, 1, 2], [0, 2, 3]])


def resident_bytes() -> int:
    """Physical memory of this process; Linux only."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


def call(index: int, device: str) -> None:
    """One call; every sixth fails."""
    cards = [FLOOR * 0.1 + [0.1 * k, 1.0 + 0.001 * (index % 97), 0] for k in range(index % 7)]
    scene = ss.Scene([ss.Mesh(vertices=corners, faces=SQUARE) for corners in [FLOOR, *cards]])
    pose = ss.look_at((0.01 * (index % 89), 3, 0), (0, 0, 0))
    light = ss.RectLight(width=1, height=0.5 + 0.01 * (index % 11), world_from_light=pose)
    technique = (ss.RayTraced(samples=4), ss.DepthComplexity(samples=4))[index % 2]
    if index % 6 == 0:
        try:
            ss.visibility(scene, light, points=FLOOR, technique=technique, device=device, memory_limit=1)
        except ss.TooLargeError:
            return
        raise AssertionError("a memory limit of one byte was enough")
    points = FLOOR[: 1 + index % 4] * 0.3
    ss.visibility(scene, light, points=points, technique=technique, device=device, receivers=True)


def growth(calls: int, device: str, *, tell: bool = False) -> list[int]:
    """Resident bytes after each tenth of the calls."""
    held = []
    for tenth in range(10):
        for index in range(calls // 10):
            call(tenth * (calls // 10) + index, device)
        gc.collect()
        held.append(resident_bytes())
        if tell:
            print(f"{(tenth + 1) * (calls // 10)} calls: {held[-1] / 2**20:.1f} MiB", flush=True)
    return held


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=10_000)
    parser.add_argument("--device", default="native")
    arguments = parser.parse_args()
    growth(arguments.calls, arguments.device, tell=True)
