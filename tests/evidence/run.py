"""Heavy checks against other renderers, and the tables that the documents show. Run by ``make evidence``.

1. Ray by ray against Embree (Open3D) on the same receivers and samples; each ray that differs is listed with the
   verdict of float64.
2. Silhouette edges against float64 rays on ten million receivers; areas against exact unions; mutants.
3. Time against error beside the tracers of ``softshadow.bench.peers``, ratios from one run.
4. The native engine: threads, a city's sky, and ten million random receivers.
5. Where the time goes, published ratios beside ours, and a scene that moves, by ``softshadow-bench``.
6. ``max_error`` on a hundred random scenes: whether it holds, and whether its choice is the fastest.
7. Shipped scenes on this machine, kept in ``crates/softshadow_bench/results``; all that is kept makes the README's
   table.
8. Hosts: the same bits on wgpu-py, Vulkan beside GL, memory of many calls, and what a host costs.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import benchmark
import bound
import hosts
import maps_penumbra
import native
import numpy as np
import results
from edges import against_rays, mutants
from rays64 import judge

import softshadow as ss
from softshadow.bench import peers
from softshadow.bench.embree_open3d import Open3D
from softshadow.bench.scenes import Measured, find

LARGEST_SHARE = 1e-5
PASSES = [f"depth_complexity:samples={samples}" for samples in (64, 256)]
MOVING = ["ray_traced:samples=64", "depth_complexity:samples=64"]
SAMPLES = (16, 64, 256)
RAYS = [ss.RayTraced(samples=samples) for samples in SAMPLES]
EDGES = [ss.DepthComplexity(samples=samples) for samples in SAMPLES]
BLENDED = ss.DepthComplexity(samples=64, evaluation="blended")
NATIVE: list[ss.Technique] = [
    *RAYS,
    ss.RayTraced(samples=256, probes=16),
    *(ss.DepthComplexity(samples=samples) for samples in (16, 32, 64, 144, 256)),
    ss.DepthComplexity(samples=200, passes=2),
]
MEASURED: list[tuple[str, int, str, list[ss.Technique]]] = [
    ("bunny", 512, "native", NATIVE),
    ("teapots", 512, "native", NATIVE),
    ("canopy", 512, "native", [*RAYS, *EDGES]),
    ("bunny", 1024, "native", NATIVE),
    ("teapots", 1024, "native", NATIVE),
    ("bunny", 512, "software", [RAYS[1], *EDGES, BLENDED]),
]
"""One model on a ground; two teapots and a cow; foliage."""
BESIDE = (
    "Everything gets the same receivers and light samples. Of ours the time from the camera to visibility counts, "
    "receivers included, of the others the query alone. Probes: 16 samples first, all samples only where those of a "
    "receiver and of its neighbours disagree (ours within a pixel, the kernel's within four)."
)
MARK = "<!-- speed against error -->"


def main() -> int:
    """Writes the report; the exit code is 1 when a check fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("EVIDENCE.md"))
    parser.add_argument("--readme", type=Path, default=Path("README.md"))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", nargs="*", help="titles (or their beginnings) of the sections to make anew")
    chosen = parser.parse_args()
    machine = ss.doctor()
    adapter = machine.adapters[0]
    introduction = [
        "# Evidence",
        "",
        "Made by `make evidence`. Absolute times hold only for the machine that made them, and not where it had other "
        "work (each section says so); ratios come from one run in which both sides took turns.",
        "",
        f"Native: {machine.native['name']}, {machine.native['driver']}. Software, on the same processors: "
        f"{adapter['name']}, {adapter['backend']}, {adapter['driver']}.",
        "",
    ]
    sections: dict[str, Callable[[], tuple[list[str], bool]]] = {
        "Ray by ray against Embree": partial(ray_by_ray, "software"),
        "Ray by ray against Embree, natively": partial(ray_by_ray, "native"),
        "Silhouette edges against rays": against_rays,
        "Mutants of the silhouette edges": mutants,
        **{
            f"Time against error: {name}, {size} × {size}, {device}": partial(
                time_against_error, name, size, device, ours, chosen.rounds
            )
            for name, size, device, ours in MEASURED
        },
        "Where the time goes": lambda: benchmark.passes("bunny", PASSES, chosen.rounds, ("native", "software")),
        "Ratios of the paper": lambda: benchmark.ratios(["bunny", "toruses"], chosen.rounds),
        "Penumbra maps": lambda: maps_penumbra.penumbra_maps(chosen.rounds),
        "A scene that moves": lambda: benchmark.waving(["bunny", "toruses"], MOVING, frames=10),
        "Natively: threads": lambda: native.threads(chosen.rounds),
        "Natively: a city's sky": lambda: native.sky(1_000_000),
        "Natively: random receivers": lambda: native.random_receivers(2_500_000),
        "An error is asked for": lambda: bound.section(100, 512),
        **hosts.SECTIONS,
        "Shipped scenes": lambda: shipped_scenes(chosen.rounds, chosen.readme),
    }
    earlier, passed = sections_of(chosen.output), True
    told = {title: earlier.get(title, ["not made yet", ""]) for title in sections}
    for title, make in sections.items():
        if chosen.only is None or any(title.startswith(only) for only in chosen.only):
            load = os.getloadavg()[0]
            lines, ok = make()
            told[title] = [*lines, f"Load of the machine before: {load:.1f}, on {os.cpu_count()} processors.", ""]
            passed &= ok
        # At once: the sections that follow take long.
        report = [*introduction, *(line for name, lines in told.items() for line in (f"## {name}", "", *lines))]
        chosen.output.write_text("\n".join(report))
    print("\n".join(report))
    return 0 if passed else 1


def sections_of(report: Path) -> dict[str, list[str]]:
    """The lines of each section of an earlier report."""
    parts = report.read_text().split("\n## ")[1:] if report.is_file() else []
    return {title: text.strip("\n").split("\n") + [""] for title, _, text in (part.partition("\n") for part in parts)}


def ray_by_ray(device: str) -> tuple[list[str], bool]:
    """Rays, and silhouette edges in the same place."""
    rays, edges = ss.RayTraced(samples=64), ss.DepthComplexity(samples=64, exact_area=False)
    triangles = ss.DepthComplexity(samples=64, unit="triangles")
    scenes: list[tuple[str, ss.Technique]] = [(name, rays) for name in ("stanford-bunny.obj", "teapot.obj", "canopy")]
    scenes += [(name, edges) for name in ("stanford-bunny.obj", "teapot.obj", "cow.obj", "beetle.obj")]
    parts = [against_embree(find(name), technique, device) for name, technique in [*scenes, ("canopy", triangles)]]
    return [line for lines, _ in parts for line in lines], all(ok for _, ok in parts)


def time_against_error(
    name: str, size: int, device: str, techniques: list[ss.Technique], rounds: int
) -> tuple[list[str], bool]:
    """A scene against the clock and beside the others, all of which must be there."""
    tracers, skipped = peers.installed()
    # Its rays do not end at the light, and nobody is slower.
    tracers.pop("trimesh", None)
    if device == "software":
        tracers = {name: (kind, [n for n in counts if n in SAMPLES]) for name, (kind, counts) in tracers.items()}
    found = peers.beside(find(name, size), tracers, techniques, rounds, device, peers.REFERENCE)
    missing = [*(f"Skipped: {reason}" for reason in skipped), *(f"Refused: {reason}" for reason in found.refused)]
    lines = [f"{BESIDE} Medians of {rounds} turns.", "", *missing, *peers.lines(found), *peers.ratio_lines(found)]
    return lines, not missing


def shipped_scenes(rounds: int, readme: Path) -> tuple[list[str], bool]:
    """The table of the README, and its picture."""
    results.keep(rounds)
    table = results.table(list(results.KEPT.glob("*.jsonl")))
    hall = ss.scenes.load("hall")
    fine = ss.RayTraced(samples=256, pattern="low_discrepancy")
    ss.render(hall.scene, hall.light, camera=hall.camera, technique=fine, exposure=0.5).save(
        Path(__file__).with_name("hall.png")
    )
    if readme.is_file():
        before, _, rest = readme.read_text().partition(MARK)
        _, _, after = rest.partition(MARK)
        readme.write_text(f"{before}{MARK}\n{chr(10).join(table)}\n{MARK}{after}")
    return [*table, ""], True


def against_embree(model: Measured, technique: ss.Technique, device: str) -> tuple[list[str], bool]:
    """Both on all pixels that see a surface, 64 samples each."""
    result = ss.visibility(
        model.scene,
        model.light,
        camera=model.camera,
        technique=technique,
        receivers=True,
        sample_masks=True,
        device=device,
    )
    seen = result.valid
    origins, normals = model.stored(result.positions[seen]), result.normals[seen]
    targets = model.stored(ss.light_points(model.light, 64, scene=model.scene).positions.reshape(-1, 3))
    ours = result.visible_samples[seen]
    theirs, _ = Open3D(model.vertices, model.faces).visible(origins, targets)
    height = np.einsum("rc,rsc->rs", normals.astype(np.float64), targets[None] - origins[:, None].astype(np.float64))
    compared = height > 1e-6
    differing = np.argwhere((ours != theirs) & compared)
    share = len(differing) / max(int(compared.sum()), 1)
    lines = [
        f"**{model.name}, {peers.named(technique)}**: {int(compared.sum()):,} rays above the horizon "
        f"({int((~compared).sum()):,} below or within 1e-6 of it left out), {len(differing)} differ, "
        f"a share of {share:.1e} (at most {LARGEST_SHARE:.0e}).",
        "",
    ]
    triangles = result.triangles[seen]
    if len(differing):
        lines += [
            "| receiver | sample | ours | Embree | float64 | nearest determinant, roundings |",
            "|---|---|---|---|---|---|",
        ]
    wrong = 0
    for receiver, sample in differing[:200]:
        free, near = judge(model.vertices, model.faces, origins[receiver], targets[sample], int(triangles[receiver]))
        word = {True: "visible", False: "blocked"}
        row = [bool(ours[receiver, sample]), bool(theirs[receiver, sample]), free]
        wrong += row[0] != free and near > 8
        lines.append(f"| {receiver} | {sample} | {' | '.join(word[v] for v in row)} | {near:.2g} |")
    lines += ["", f"Where they differ, {wrong} of ours contradict float64 beyond rounding.", ""]
    return lines, share <= LARGEST_SHARE and wrong == 0


if __name__ == "__main__":
    sys.exit(main())
