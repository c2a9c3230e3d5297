"""Sections of the report about occlusion layers: error by slices and texels, and parts of the light over foliage."""

from __future__ import annotations

import sys

import numpy as np

import softshadow as ss
from softshadow.bench.scenes import find

REFERENCE = ss.RayTraced(samples=256, passes=4, pattern="low_discrepancy", seed=99)
SCENES = ("bunny", "canopy", "cards", "hall")
LEAVES = (500, 2000, 6000, 20000)
SPLITS = (1, 2, 4, 8)
RADIUS, HEIGHT, LAMP = 0.8, 1.6, 5.0


def settings() -> list[ss.OcclusionLayers]:
    """The paper's way by slices and by texels, then what is beyond it."""
    paper = [ss.OcclusionLayers(near="fade", split=1, slices=n, resolution=r) for n in (4, 16, 64) for r in (128, 512)]
    split = [ss.OcclusionLayers(near="fade", slices=n) for n in (4, 16)]
    rays = [ss.OcclusionLayers(slices=n, split=m) for n, m in ((4, 2), (8, 4), (16, 4), (16, 8))]
    return [*paper, *split, *rays]


def errors(size: int, device: str) -> tuple[list[str], bool]:
    """Error against rays by scene and settings, bias included."""
    table = [
        f"Against {REFERENCE.samples * REFERENCE.passes} rays a receiver, {size} × {size}. *Gross*: share of all "
        "pixels off by more than a quarter. `fade` with split 1 is the paper.",
        "",
        "| scene | near | split | slices | texels | penumbra RMSE | bias | RMSE of all | gross | ms |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    agreed = True
    for name in SCENES:
        model = find(name, size)

        def seen(technique: ss.Technique, model: object = model) -> tuple[np.ndarray, float]:
            result = ss.visibility(model.scene, model.light, camera=model.camera, technique=technique, device=device)  # type: ignore[attr-defined]
            return np.asarray(result.values, dtype=np.float64).ravel(), result.info["wall_ms"]

        truth, _ = seen(REFERENCE)
        valid = np.isfinite(truth)
        penumbra = valid & (truth > 0.002) & (truth < 0.998)
        found = {}
        for technique in settings():
            values, ms = seen(technique)
            off = values - truth
            rmse = float(np.sqrt(np.mean(off[penumbra] ** 2)))
            found[technique] = rmse
            numbers = f"{rmse:.4f} | {off[penumbra].mean():+.4f} | {np.sqrt(np.mean(off[valid] ** 2)):.4f}"
            table.append(
                f"| {name} | {technique.near} | {technique.split} | {technique.slices} | "
                f"{technique.resolution} | {numbers} | {np.mean(np.abs(off[valid]) > 0.25):.2%} | {ms:.0f} |"
            )
        agreed &= min(found.values()) < found[settings()[0]]
    return [*table, ""], agreed


def leaves(count: int) -> ss.Scene:
    """Quads of s by s/2 at random in a ball over a ground."""
    random = np.random.default_rng(11)
    way = random.normal(size=(count, 3))
    at = way / np.linalg.norm(way, axis=1, keepdims=True) * RADIUS * random.random((count, 1)) ** (1 / 3)
    frames = np.linalg.qr(random.normal(size=(count, 3, 3)))[0]
    size = random.uniform(0.04, 0.1, (count, 1))
    x, y = frames[:, 0] * size / 2, frames[:, 1] * size / 4
    corners = np.stack([-x - y, x - y, x + y, -x + y], axis=1) + (at + [0, HEIGHT, 0])[:, None]
    faces = (np.array([[0, 1, 2], [0, 2, 3]])[None] + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    return ss.Scene([ss.Mesh(vertices=corners.reshape(-1, 3), faces=faces)])


def foliage(points: int, device: str) -> tuple[list[str], bool]:
    """Receivers on the ground under a ball of leaves, by parts of the light."""
    lamp = ss.RectLight(width=2 * RADIUS, height=2 * RADIUS, world_from_light=ss.look_at((0, LAMP, 0), (0, 0, 0)))
    random = np.random.default_rng(5)
    places = np.stack([random.uniform(-2, 2, points), np.zeros(points), random.uniform(-2, 2, points)], axis=1)
    names = [f"m = {split}" for split in SPLITS]
    table = [
        f"{points:,} receivers on the ground under a ball of leaves, the light as wide as the ball, 16 slices of "
        "256 × 256 texels. RMSE in the penumbra; bias in brackets.",
        "",
        f"| leaves | {' | '.join(names)} | maximum |",
        "|---" * (len(SPLITS) + 2) + "|",
    ]
    agreed = True
    for count in LEAVES:
        scene = leaves(count)

        def seen(technique: ss.Technique, scene: ss.Scene = scene) -> np.ndarray:
            result = ss.visibility(scene, lamp, points=places, technique=technique, device=device)
            return np.asarray(result.values, dtype=np.float64).ravel()

        truth = seen(REFERENCE)
        penumbra = (truth > 0.002) & (truth < 0.998)

        def cell(off: np.ndarray) -> str:
            return f"{np.sqrt(np.mean(off**2)):.4f} ({off.mean():+.4f})"

        base = {"slices": 16, "resolution": 256}
        offs = [(seen(ss.OcclusionLayers(split=split, **base)) - truth)[penumbra] for split in SPLITS]
        most = (seen(ss.OcclusionLayers(split=1, combine="maximum", **base)) - truth)[penumbra]
        table.append(f"| {count:,} | {' | '.join(cell(off) for off in [*offs, most])} |")
        rmse = [float(np.sqrt(np.mean(off**2))) for off in offs]
        agreed &= rmse[2] < rmse[0] or count < 2000
    return [*table, ""], agreed


if __name__ == "__main__":
    chosen = sys.argv[1] if len(sys.argv) > 1 else "auto"
    for lines, good in (foliage(3000, chosen), errors(128, chosen)):
        print("\n".join(lines), "agreed" if good else "DISAGREED", flush=True)
