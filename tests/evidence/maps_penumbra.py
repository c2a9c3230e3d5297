"""Penumbra maps: what softness costs, how that grows, and how wrong it is. A driver draws; references are native."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace

import benchmark
import numpy as np
from numpy.typing import NDArray

import softshadow as ss
from softshadow.bench.scenes import Measured, find
from softshadow.gallery import props

DEVICE = "software"
HARD = ss.HardShadowMap(resolution=1024)
SOFT = ss.PenumbraMap()
PUBLISHED = {"bunny": "2.3 (bunny)", "teapots": "–", "cow_ball": "–", "fork": "–", "hall": "–"}
"""Ratios of Wyman and Hansen's table 1, frame rates of whole pictures on a Radeon 9700."""
REFERENCE = ss.RayTraced(samples=256, passes=4, pattern="low_discrepancy", seed=99)


@dataclass(frozen=True)
class Error:
    """Against a reference, over its penumbra."""

    rmse: float
    bias: float
    umbra: float
    """Share of the receivers that see nothing."""

    @property
    def cells(self) -> str:
        """Two columns of a table."""
        return f"{self.rmse:.3f} | {self.bias:+.3f}"


def model(name: str, size: int) -> Measured:
    """A scene of the benchmark, or the cow beside a ball."""
    if name != "cow_ball":
        return find(name, size)
    cow = find("cow.obj", size)
    ball = props.ball((0.75, 0.0, 0.55), 0.35, (0.7, 0.5, 0.35))
    return Measured(name, ss.Scene([*cow.scene.meshes, ball]), cow.light, cow.camera)


def values(view: Measured, technique: ss.Technique, device: str = DEVICE) -> NDArray[np.float32]:
    """Visibility of the view's camera."""
    return ss.visibility(view.scene, view.light, camera=view.camera, technique=technique, device=device).values


def error(found: NDArray[np.float32], truth: NDArray[np.float32]) -> Error:
    """How far apart two results are; a pixel that only one of them sees counts in neither."""
    with np.errstate(invalid="ignore"):
        penumbra = (truth > 0.002) & (truth < 0.998) & ~np.isnan(found)
    off = found[penumbra].astype(np.float64) - truth[penumbra]
    umbra = float((found[~np.isnan(found)] < 0.002).mean())
    return Error(float(np.sqrt(np.mean(off**2))), float(off.mean()), umbra)


def taking_turns(view: Measured, techniques: list[ss.Technique], rounds: int) -> list[list[float]]:
    """Milliseconds of each, the first round left out: it compiles and uploads."""
    times: list[list[float]] = [[] for _ in techniques]
    for turn in range(rounds + 1):
        for own, technique in zip(times, techniques, strict=True):
            info = ss.visibility(view.scene, view.light, camera=view.camera, technique=technique, device=DEVICE).info
            if turn:
                own.append(info["wall_ms"])
    return times


def ratio(a: list[float], b: list[float]) -> str:
    """Turn by turn, with the smallest and the largest."""
    each = [x / y for x, y in zip(a, b, strict=True)]
    return f"{statistics.median(each):.2f} ({min(each):.2f}–{max(each):.2f})"


def against_hard(rounds: int, size: int) -> list[str]:
    """The paper's first table, and what the technique is worth beside `depth_complexity`."""
    edges = ss.DepthComplexity(samples=16)
    lines = [
        f"{size} × {size} pixels, maps of 1024², Mesa's software driver, the same for all three. Medians of {rounds} "
        "turns. *Published*: Wyman and Hansen, table 1, whole pictures on a Radeon 9700.",
        "",
        "| scene | hard ms | penumbra ms | penumbra : hard | published | RMSE | bias | 16 samples ms | RMSE | bias "
        "| penumbra : 16 samples |",
        "|---" * 11 + "|",
    ]
    dominated = []
    for name, published in PUBLISHED.items():
        view = model(name, size)
        hard, soft, sampled = taking_turns(view, [HARD, SOFT, edges], rounds)
        truth = values(view, REFERENCE, "native")
        own, theirs = (error(values(view, technique), truth) for technique in (SOFT, edges))
        medians = [f"{statistics.median(ms):.0f}" for ms in (hard, soft, sampled)]
        cells = [name, *medians[:2], ratio(soft, hard), published, own.cells, medians[2], theirs.cells]
        lines.append(f"| {' | '.join([*cells, ratio(soft, sampled)])} |")
        if statistics.median(soft) > statistics.median(sampled) and own.rmse > theirs.rmse:
            dominated.append(name)
    verdict = f"slower and farther off on {', '.join(dominated)}" if dominated else "slower and farther off nowhere"
    return [*lines, "", f"**Beside `depth_complexity` at 16 samples, in this run: {verdict}.**", ""]


def growth(rounds: int, size: int) -> list[str]:
    """With triangles, with the size of the penumbra, and with texels."""
    lines = [
        "With triangles: the bunny simplified (Open3D) and subdivided, one view.",
        "",
        "| triangles | hard ms | penumbra ms | penumbra : hard |",
        "|---" * 4 + "|",
    ]
    bunny = model("bunny", size)
    for scene in (simplified(bunny, 5_000), simplified(bunny, 10_000), bunny, subdivided(bunny)):
        hard, soft = taking_turns(scene, [HARD, SOFT], rounds)
        count = sum(len(mesh.faces) for mesh in scene.scene.meshes)
        medians = f"{statistics.median(hard):.0f} | {statistics.median(soft):.0f}"
        lines.append(f"| {count:,} | {medians} | {ratio(soft, hard)} |")
    lines += [
        "",
        "With the light's side, on the bunny and at two resolutions; errors against rays to the same light. *Umbra*: "
        "share of the receivers that see nothing, behind it that of the reference.",
        "",
        "| side | 512² ms | 1024² ms | 512² RMSE | bias | 1024² RMSE | bias | umbra | of the reference |",
        "|---" * 9 + "|",
    ]
    for side in (0.125, 0.25, 0.5, 1.0, 2.0):
        view = lit_by(bunny, side)
        maps: list[ss.Technique] = [ss.PenumbraMap(resolution=n) for n in (512, 1024)]
        ms = taking_turns(view, maps, rounds)
        truth = values(view, REFERENCE, "native")
        errors = [error(values(view, technique), truth) for technique in maps]
        lines.append(
            f"| {side} | {' | '.join(f'{statistics.median(each):.0f}' for each in ms)} | "
            f"{' | '.join(one.cells for one in errors)} | {errors[1].umbra:.4f} | {error(truth, truth).umbra:.4f} |"
        )
    return [*lines, ""]


def lit_by(view: Measured, side: float) -> Measured:
    """Under a square of this side."""
    assert isinstance(view.light, ss.RectLight)
    return Measured(view.name, view.scene, replace(view.light, width=side, height=side), view.camera)


def _changed(view: Measured, change: Callable[[ss.Mesh], ss.Mesh]) -> Measured:
    largest = max(view.scene.meshes, key=lambda mesh: len(mesh.faces))
    meshes = [change(mesh) if mesh is largest else mesh for mesh in view.scene.meshes]
    return Measured(view.name, ss.Scene(meshes), view.light, view.camera)


def simplified(view: Measured, triangles: int) -> Measured:
    """With so many triangles in its largest mesh."""
    import open3d

    def change(mesh: ss.Mesh) -> ss.Mesh:
        of = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(np.array(mesh.vertices)),
            open3d.utility.Vector3iVector(mesh.faces.astype(np.int32)),
        )
        coarse = of.simplify_quadric_decimation(triangles)
        return replace(mesh, vertices=np.asarray(coarse.vertices), faces=np.asarray(coarse.triangles, np.uint32))

    return _changed(view, change)


def subdivided(view: Measured) -> Measured:
    """With four triangles for each of its largest mesh."""
    import trimesh

    def change(mesh: ss.Mesh) -> ss.Mesh:
        vertices, faces = trimesh.remesh.subdivide(mesh.vertices, mesh.faces)
        return replace(mesh, vertices=vertices, faces=faces.astype(np.uint32))

    return _changed(view, change)


def penumbra_maps(rounds: int, size: int = 512) -> tuple[list[str], bool]:
    """The section of the report."""
    split, complete = benchmark.passes("bunny", ["hard_shadow_map:resolution=1024", "penumbra_map"], rounds, (DEVICE,))
    return [*against_hard(rounds, size), *growth(rounds, size), *split], complete


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]]
    print("\n".join([*against_hard(*numbers), *growth(*numbers)]))
