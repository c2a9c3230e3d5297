"""Sections of the report about the occlusion camera: its parts, its growth, and its errors beside other techniques."""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path
from typing import Any

import benchmark
import numpy as np
from numpy.typing import NDArray

import softshadow as ss
from softshadow.bench.scenes import find, meshes_folder

DEVICE = "software"
REFERENCE = ss.RayTraced(samples=256, passes=4, pattern="low_discrepancy", seed=7)
CAMERA = ss.OcclusionCamera()
HARD = ss.HardShadowMap(resolution=1024)
BESIDE: list[ss.Technique] = [
    CAMERA,
    ss.OcclusionCamera(steps=1),
    ss.OcclusionCamera(ramp="bernstein"),
    HARD,
    ss.DepthComplexity(samples=16),
]
PARTS = ("list silhouettes", "draw depth", "draw distortion", "look up")
"""Beginnings of labels, as the paper's table 1 splits a frame."""


class Case:
    """A scene with its light and camera."""

    def __init__(self, name: str, scene: ss.Scene, light: ss.Light, camera: ss.Camera) -> None:
        self.name, self.scene, self.light, self.camera = name, scene, light, camera
        self.triangles = sum(len(mesh.faces) for mesh in scene.meshes)

    def seen(self, technique: ss.Technique, **settings: Any) -> ss.Visibility:
        """Visibility on the device that draws."""
        settings = {"camera": self.camera, "device": DEVICE, "standard_error": False, **settings}
        return ss.visibility(self.scene, self.light, technique=technique, **settings)


def cases(size: int) -> list[Case]:
    """The paper's kinds of scenes: a bunny, two teapots, a cow and a sphere, a fork."""
    placed = [find(name, size) for name in ("bunny", "teapots")]
    fork = ss.scenes.load("fork")
    camera = ss.Camera(
        world_from_camera=fork.camera.world_from_camera, fov_y_deg=fork.camera.fov_y_deg, size=(size, size)
    )
    return [
        *(Case(one.name, one.scene, one.light, one.camera) for one in placed),
        cow_and_sphere(size),
        Case("fork", fork.scene, fork.light, camera),
    ]


def ground() -> ss.Mesh:
    """Six by six."""
    vertices = np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]])
    return ss.Mesh(name="ground", vertices=vertices, faces=np.array([[0, 2, 1], [0, 3, 2]]))


def standing(file: str, height: float, x: float, z: float) -> ss.Mesh:
    """A model on the ground."""
    mesh = ss.Scene.load(meshes_folder() / file).meshes[0]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    vertices = (mesh.vertices - foot) * height / (high[1] - low[1]) + [x, 0, z]
    return ss.Mesh(name=Path(file).stem, vertices=vertices, faces=mesh.faces)


def ball(center: tuple[float, float, float], radius: float, rings: int) -> ss.Mesh:
    """A sphere of two triangles a cell."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij")
    unit = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)
    unit[:, -1] = unit[:, 0]
    at = np.arange(unit[..., 0].size).reshape(unit.shape[:2])
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return ss.Mesh(name="ball", vertices=unit.reshape(-1, 3) * radius + np.array(center), faces=faces)


def overhead(side: float) -> ss.Light:
    """A square light over the ground."""
    return ss.RectLight(width=side, height=side, world_from_light=ss.look_at((1.5, 3.5, 1.0), (0, 0.3, 0)))


def view(size: int) -> ss.Camera:
    """From aslant."""
    return ss.Camera.look_at(eye=(2.2, 1.9, 3.0), target=(0, 0.4, 0), fov_y_deg=40, size=(size, size))


def cow_and_sphere(size: int, side: float = 0.5) -> Case:
    """A sphere over a cow."""
    meshes = [standing("cow.obj", 0.7, 0.0, 0.0), ball((0.45, 1.15, 0.2), 0.18, 40), ground()]
    return Case("cow and sphere", ss.Scene(meshes), overhead(side), view(size))


def median_ms(case: Case, technique: ss.Technique, rounds: int) -> float:
    """Wall time after a warm-up."""
    case.seen(technique)
    return statistics.median(case.seen(technique).info["wall_ms"] for _ in range(rounds))


def errors(values: NDArray[np.float32], truth: NDArray[np.float32]) -> dict[str, float]:
    """In the penumbra and everywhere."""
    seen = ~np.isnan(truth)
    away = (values - truth)[seen].astype(np.float64)
    penumbra = (truth[seen] > 0.002) & (truth[seen] < 0.998)
    inner = away[penumbra] if penumbra.any() else np.zeros(1)
    return {
        "rmse": float(np.sqrt(np.square(inner).mean())),
        "bias": float(inner.mean()),
        "p99": float(np.quantile(np.abs(inner), 0.99)),
        "all": float(np.sqrt(np.square(away).mean())),
        "gross": float((np.abs(away) > 0.25).mean()),
    }


def error_table(size: int, rounds: int) -> list[str]:
    """Errors and times beside a hard shadow map and depth complexity at 16 samples, turn by turn."""
    table = [
        f"{size} × {size}, maps of {CAMERA.resolution}². Reference: 4 × 256 rays. Gross: off by more than 0.25, a "
        "share of all pixels that see a surface. Collisions: receivers with more silhouettes than were found.",
        "",
        "| scene | triangles | technique | ms | RMSE in penumbra | bias | p99 | RMSE of all | gross | collisions |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for case in cases(size):
        truth = case.seen(REFERENCE).values
        times: dict[int, list[float]] = {at: [] for at in range(len(BESIDE))}
        for turn in range(rounds + 1):
            for at, technique in enumerate(BESIDE):
                result = case.seen(technique)
                times[at].extend([result.info["wall_ms"]] if turn else [])
        for at, technique in enumerate(BESIDE):
            result = case.seen(technique)
            off = errors(result.values, truth)
            table.append(
                f"| {case.name} | {case.triangles:,} | {words(technique)} | {statistics.median(times[at]):.0f} | "
                f"{off['rmse']:.4f} | {off['bias']:+.4f} | {off['p99']:.3f} | {off['all']:.4f} | {off['gross']:.4f} | "
                f"{result.info['colliding_receivers']:,} |"
            )
    return [*table, ""]


def words(technique: ss.Technique) -> str:
    """A technique in a table."""
    if isinstance(technique, ss.OcclusionCamera):
        ramp = "" if technique.ramp == "outline" else f", {technique.ramp}"
        return f"occlusion_camera, {technique.steps} steps{ramp}"
    return technique.name + (f", {technique.samples} samples" if isinstance(technique, ss.DepthComplexity) else "")


def triangles_table(size: int, rounds: int) -> list[str]:
    """Growth with triangles: the paper's bunny, cow and dragon have 70,000, 26,000 and 270,000."""
    table = [
        f"A ball on a ground, {size} × {size}: milliseconds from the camera to visibility, medians of turns.",
        "",
        "| triangles | occlusion_camera | hard_shadow_map | ratio |",
        "|---|---|---|---|",
    ]
    for rings in (35, 50, 132, 260):
        scene = ss.Scene([ball((0, 0.6, 0), 0.5, rings), ground()])
        case = Case("ball", scene, overhead(0.5), view(size))
        both = [CAMERA, HARD]
        times: list[list[float]] = [[], []]
        for turn in range(rounds + 1):
            for column, technique in zip(times, both, strict=True):
                ms = case.seen(technique).info["wall_ms"]
                column.extend([ms] if turn else [])
        soft, one = (statistics.median(column) for column in times)
        ratio = statistics.median(a / b for a, b in zip(*times, strict=True))
        table.append(f"| {case.triangles:,} | {soft:.0f} | {one:.0f} | {ratio:.2f} |")
    return [*table, ""]


def parts_table(rounds: int) -> list[str]:
    """The paper's table 1: silhouettes, maps, shading. On its bunny of 70,000 triangles 8.0 / 0.8 + 1.7 / 8.2 ms."""
    table = [
        "Milliseconds, 512 × 512, from runs in which every pass is a submission of its own.",
        "",
        "| scene | silhouettes | depth map | distortion maps | look up | receivers |",
        "|---|---|---|---|---|---|",
    ]
    arguments = ["--technique", "occlusion_camera", "--repeats", str(rounds), "--reference", benchmark.REFERENCE]
    scenes = benchmark.repeated("--scene", ["bunny", "teapots", "fork", "toruses"])
    for line in benchmark.measured("--device", DEVICE, *scenes, *arguments):
        if line["kind"] == "measurement":
            times = {row["label"]: row["ms"] for row in line["pass_ms"]}
            parts = [sum(ms for label, ms in times.items() if label.startswith(part)) for part in PARTS]
            cells = [*parts, sum(times.values()) - sum(parts)]
            table.append(f"| {line['scene']} | {' | '.join(f'{ms:.1f}' for ms in cells)} |")
    return [*table, ""]


def growth_table(rounds: int) -> list[str]:
    """With the size of the light and of the image: error beside the reference."""
    table = [
        "Cow and sphere under a square light: the umbra shrinks where that of a hard shadow cannot. Pixels of umbra.",
        "",
        "| image | light | ms | hard, ms | umbra | hard | reference | RMSE in penumbra | hard |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for size, sides in ((512, (0.05, 0.2, 0.5, 1.0, 2.0)), (1024, (0.5,))):
        for side in sides:
            case = cow_and_sphere(size, side)
            truth = case.seen(REFERENCE).values
            soft, one = (case.seen(technique).values for technique in (CAMERA, HARD))
            umbra = [int((values < 0.002).sum()) for values in (soft, one, truth)]
            rmse = [errors(values, truth)["rmse"] for values in (soft, one)]
            ms = [median_ms(case, technique, rounds) for technique in (CAMERA, HARD)]
            table.append(
                f"| {size}² | {side} | {ms[0]:.0f} | {ms[1]:.0f} | {umbra[0]:,} | {umbra[1]:,} | {umbra[2]:,} | "
                f"{rmse[0]:.4f} | {rmse[1]:.4f} |"
            )
    return [*table, ""]


def bias_table(size: int) -> list[str]:
    """What the bias costs where it is not needed, and saves where it is."""
    table = ["| scene | " + " | ".join(f"bias {bias}" for bias in BIASES) + " |", "|---" * (len(BIASES) + 1) + "|"]
    for case in cases(size):
        truth = case.seen(REFERENCE).values
        found = [errors(case.seen(ss.OcclusionCamera(bias=bias)).values, truth) for bias in BIASES]
        cells = [f"{off['rmse']:.4f} ({off['bias']:+.4f})" for off in found]
        table.append(f"| {case.name} | {' | '.join(cells)} |")
    return ["RMSE in the penumbra and its bias by the share of the distance to the occluder.", "", *table, ""]


BIASES = (0.0, 0.05, 0.1, 0.25, 0.5)


def main() -> None:
    """Writes the sections to a file of their own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("camera.md"))
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", nargs="*", help="last words of the sections to make")
    chosen = parser.parse_args()
    sections = {
        "Occlusion camera: errors": lambda: error_table(chosen.size, chosen.rounds),
        "Occlusion camera: parts": lambda: parts_table(chosen.rounds),
        "Occlusion camera: triangles": lambda: triangles_table(chosen.size, chosen.rounds),
        "Occlusion camera: size of the light": lambda: growth_table(chosen.rounds),
        "Occlusion camera: bias": lambda: bias_table(chosen.size),
    }
    text = ""
    for title, make in sections.items():
        if chosen.only and not any(title.endswith(word) for word in chosen.only):
            continue
        text += "\n".join([f"## {title}", "", *make()]) + "\n"
        chosen.output.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
