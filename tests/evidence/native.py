"""Sections of the report about the native engine: threads, a city's sky, and random receivers of real models."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time

import numpy as np

import softshadow as ss
from softshadow.bench.embree_open3d import Open3D
from softshadow.bench.scenes import find

GROSS = 0.25
MODELS = ("stanford-bunny.obj", "teapot.obj", "cow.obj", "beetle.obj")
TIMED = [ss.RayTraced(samples=64), ss.DepthComplexity(samples=64), ss.DepthComplexity(samples=256)]
ONE = """
import json, sys
import softshadow as ss
from softshadow.bench.scenes import find
model = find("bunny", 512)
kinds = {"ray_traced": ss.RayTraced, "depth_complexity": ss.DepthComplexity}
technique = kinds[sys.argv[1]](samples=int(sys.argv[2]))
look = lambda: ss.visibility(model.scene, model.light, camera=model.camera, technique=technique, device="native")
look()
print(json.dumps([look().info["wall_ms"] for _ in range(15)]))
"""


def threads(rounds: int) -> tuple[list[str], bool]:
    """One thread against two, in processes that take turns."""
    table = ["| technique | 1 thread, ms | 2 threads, ms | ratio |", "|---|---|---|---|"]
    for technique in TIMED:
        found: dict[str, list[float]] = {"1": [], "2": []}
        for _ in range(rounds):
            for count, times in found.items():
                command = [sys.executable, "-c", ONE, technique.name, str(technique.samples)]
                environment = {**os.environ, "RAYON_NUM_THREADS": count}
                done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
                times += json.loads(done.stdout)
        one, two = (statistics.median(times) for times in found.values())
        table.append(f"| {technique.name}, {technique.samples} samples | {one:.1f} | {two:.1f} | {one / two:.2f} |")
    return ["Bunny, 512 × 512, from the camera to visibility; medians.", "", *table, ""], True


def sky(points: int, patches: int = 145) -> tuple[list[str], bool]:
    """Points on a ground around models, each asked for one ray to each patch of the sky; beside Embree."""
    model = find("teapots", 64)
    random = np.random.default_rng(7)
    places = np.stack([random.uniform(-3, 3, points), np.zeros(points), random.uniform(-3, 3, points)], axis=1)
    normals = np.tile([0.0, 1.0, 0.0], (points, 1))
    # Spread evenly over the sky: a golden spiral.
    up = (np.arange(patches) + 0.5) / patches
    around = np.degrees(np.arange(patches) * np.pi * (3 - np.sqrt(5))) % 360
    suns = [ss.SunLight(float(a), float(np.degrees(np.arcsin(u)))) for a, u in zip(around, up, strict=True)]
    technique = ss.RayTraced(samples=1)
    call = {"points": places, "normals": normals, "technique": technique, "device": "native", "standard_error": False}
    ss.visibility(model.scene, suns[:2], **call)
    started = time.perf_counter()
    result = ss.visibility(model.scene, suns, receivers=True, **call)
    seconds = time.perf_counter() - started
    origins = model.stored(result.positions)
    embree = Open3D(model.vertices, model.faces)
    ours = theirs = differing = 0
    spent = 0.0
    for light, seen in zip(suns, result.values, strict=True):
        way = ss.light_points(light, 1, scene=model.scene).positions.reshape(-1, 3)[0]
        far = (origins + 20 * way / np.linalg.norm(way)).astype(np.float32)
        free, ms = embree.along(origins, far)
        spent += ms / 1e3
        differing += int((free != (seen > 0.5)).sum())
        ours, theirs = ours + int((seen > 0.5).sum()), theirs + int(free.sum())
    pairs = points * patches
    lines = [
        f"**{model.name}**, {len(model.faces):,} triangles: {points:,} points × {patches} patches of the sky, one ray "
        f"each. Ours, everything counted: {seconds:.1f} s, {pairs / seconds / 1e6:.1f} million light-points a second. "
        f"Embree through Open3D, the queries alone: {spent:.1f} s, {pairs / spent / 1e6:.1f} million. Lit: {ours:,} by "
        f"ours, {theirs:,} by Embree; {differing:,} differ, a share of {differing / pairs:.1e} (its rays end 20 units "
        "away, at float32 points).",
        "",
    ]
    return lines, differing <= 1e-4 * pairs


def random_receivers(each: int) -> tuple[list[str], bool]:
    """Receivers anywhere about real models: edges against rays to the same samples."""
    random = np.random.default_rng(11)
    table = ["| model | receivers | samples that differ | gross errors |", "|---|---|---|---|"]
    passed = True
    for name in MODELS:
        model = find(name, 64)
        low, high = (np.array(corner) for corner in model.scene.bounds)
        differing = gross = 0
        for _ in range(each // 250_000):
            places = random.uniform(np.maximum(low, -1.2), np.minimum(high + 0.3, 1.2), (250_000, 3))
            both = [
                ss.visibility(model.scene, model.light, points=places, technique=t, device="native", sample_masks=True)
                for t in (ss.RayTraced(samples=64), ss.DepthComplexity(samples=64, exact_area=False))
            ]
            rays, edges = (seen.visible_samples for seen in both)
            differing += int((rays != edges).sum())
            gross += int((np.abs(both[0].values - both[1].values) > GROSS).sum())
        passed &= gross == 0
        table.append(f"| {model.name} | {each:,} | {differing:,} of {64 * each:,} | {gross} |")
    text = f"Points without normals, 64 samples, natively. Gross: visibility differs by more than {GROSS}."
    return [text, "", *table, ""], passed
