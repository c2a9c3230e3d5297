"""``python -m softshadow.bench.report``: the page of ``make bench``.

Every technique over its knob on each scene, against a reference of many rays, with images; on the scene with the
fewest triangles how time and error grow with receivers, light and triangles; and what JSON lines of
``softshadow-bench --ratios`` and of ``softshadow.bench.peers`` add.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from softshadow import scenes
from softshadow.cli_compare import usual_techniques
from softshadow.comparison import Comparison, compare
from softshadow.device import quiet_driver
from softshadow.errors import SoftShadowError
from softshadow.lights import DiscLight, Light, RectLight, SphereLight, SunLight
from softshadow.report import Report, read_lines
from softshadow.report.judgement import full_name
from softshadow.scene import Mesh, Scene
from softshadow.techniques import DepthComplexity, RayTraced, Technique
from softshadow.visibility import visibility

from .scenes import Measured, find

REFERENCE = RayTraced(samples=256, passes=8, pattern="low_discrepancy", seed=99)
GROWING: tuple[Technique, ...] = (RayTraced(samples=64), DepthComplexity(samples=64))
"""What growth is shown of."""
_SCALES = (0.5, 2.0)
_SIZES = {
    "RectLight": ("width", "height"),
    "DiscLight": ("radius",),
    "SphereLight": ("radius",),
    "SunLight": ("diameter_deg",),
}


def main(arguments: list[str] | None = None) -> int:
    """Writes the report; the exit code is 1 where a scene could not be measured."""
    quiet_driver()
    parser = argparse.ArgumentParser(prog="softshadow.bench.report", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--output", type=Path, default=Path("bench_report"), metavar="FOLDER")
    parser.add_argument("--scene", action="append", help="as those of softshadow.bench.peers; default: all shipped")
    parser.add_argument("--size", type=int, default=192, help="width and height in pixels")
    parser.add_argument("--repeats", type=int, default=5, help="turns after the warm-up")
    parser.add_argument("--lines", type=Path, action="append", default=[], help="JSON lines; may be repeated")
    parser.add_argument("--device", default="auto")
    chosen = parser.parse_args(arguments)
    lines = [line for path in chosen.lines for line in read_lines(path)]
    measured: list[Comparison] = []
    smallest: Measured | None = None
    failures = 0
    for name in chosen.scene or scenes.names():
        started = time.perf_counter()
        try:
            model = find(name, chosen.size)
            able, refused = serving(model, usual_techniques(chosen.device), chosen.device)
            lines += refused
            measured.append(_compared(model, able, chosen.repeats, chosen.device))
        except SoftShadowError as error:
            failures += 1
            lines.append(_failure(name, chosen.size, None, error))
            print(f"{name}: {error}", flush=True)
            continue
        failures += len(refused)
        for line in refused:
            print(f"{name}, {line['case']}: {line['reason']}", flush=True)
        if smallest is None or model.scene.triangle_count < smallest.scene.triangle_count:
            smallest = model
        print(f"{name}, {time.perf_counter() - started:.1f} s\n{measured[-1]}", flush=True)
    if smallest is not None:
        growth = [_compared(one, GROWING, chosen.repeats, chosen.device) for one in grown(smallest)]
        Report(measured, growth=growth, lines=lines, title="softshadow: speed against error").save(chosen.output)
        print(f"page {chosen.output / 'index.html'}")
    return 1 if failures else 0


def serving(
    model: Measured, techniques: Sequence[Technique], device: str
) -> tuple[list[Technique], list[dict[str, Any]]]:
    """Techniques that serve a scene, and lines about those that do not: one that refuses must not end a comparison."""
    able, refused = [], []
    for technique in techniques:
        try:
            visibility(model.scene, model.light, camera=model.camera, technique=technique, device=device)
            able.append(technique)
        except SoftShadowError as error:
            refused.append(
                _failure(model.name, model.camera.size[0], full_name(json.loads(technique.to_json())), error)
            )
    return able, refused


def _failure(scene: str, size: int, case: str | None, error: Exception) -> dict[str, Any]:
    return {"kind": "failure", "scene": scene, "size": [size, size], "case": case, "reason": str(error)}


def _compared(model: Measured, techniques: Any, repeats: int, device: str) -> Comparison:
    return compare(
        model.scene,
        model.light,
        camera=model.camera,
        techniques=techniques,
        reference=REFERENCE,
        repeats=repeats,
        name=model.name,
        device=device,
    )


def grown(model: Measured) -> Iterator[Measured]:
    """The same scene with more and fewer receivers, a larger and a smaller light, and triangles cut into more."""
    for scale in _SCALES:
        width, height = model.camera.size
        size = max(round(scale * width), 1), max(round(scale * height), 1)
        yield replace(model, camera=replace(model.camera, size=size))
    for scale in _SCALES:
        yield replace(model, light=scaled(model.light, scale))
    once = divided(model.scene)
    yield replace(model, scene=once)
    yield replace(model, scene=divided(once))


def scaled(light: Light, scale: float) -> Light:
    """A light of the same shape and place, so many times as wide."""
    if not isinstance(light, RectLight | DiscLight | SphereLight | SunLight):
        return light
    return replace(light, **{name: scale * getattr(light, name) for name in _SIZES[type(light).__name__]})


def divided(scene: Scene) -> Scene:
    """Every triangle as four: the same surfaces."""
    return Scene([_divided(mesh) for mesh in scene.meshes])


def _divided(mesh: Mesh) -> Mesh:
    corners = mesh.vertices[mesh.faces]
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    (a, b, c), (ab, bc, ca) = np.moveaxis(corners, 1, 0), np.moveaxis(middles, 1, 0)
    triangles = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
    # Corners in one place are one corner: edges that two triangles share stay shared.
    vertices, places = np.unique(triangles, axis=0, return_inverse=True)
    opacity = np.repeat(mesh.opacity, 4) if isinstance(mesh.opacity, np.ndarray) else mesh.opacity
    faces = places.reshape(-1, 3).astype(np.uint32)
    return replace(mesh, vertices=vertices, faces=faces, opacity=opacity)


if __name__ == "__main__":
    sys.exit(main())
