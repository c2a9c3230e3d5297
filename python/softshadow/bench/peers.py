"""``python -m softshadow.bench.peers``: time against error beside independent ray tracers.

Open3D, trimesh with embreex, and a kernel of Mitsuba get our stored receivers and our light samples, in one process
and taking turns; a warm-up, then medians. Of ours the time from the camera to visibility counts, receivers included, of
the others the query alone. What takes too long for turns is measured in its first, and says so.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import statistics
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from softshadow.cli_values import parse_technique
from softshadow.device import Device, quiet_driver
from softshadow.errors import SceneError, SoftShadowError
from softshadow.light_samples import light_points
from softshadow.lights import SphereLight, SunLight
from softshadow.techniques import DepthComplexity, RayTraced, Technique
from softshadow.visibility import visibility

from .rays import Points, Query
from .scenes import Measured, find

LEVELS = (0.05, 0.02, 0.01, 0.005)
"""Root mean square errors in the penumbra at which the fastest of each are compared."""
PEERS = {
    "Open3D": ("embree_open3d", "Open3D", (16, 64, 144, 256, 400)),
    "trimesh": ("embree_trimesh", "Trimesh", (16, 64, 144, 256)),
    "Mitsuba kernel": ("mitsuba_kernel", "Mitsuba", (16, 64, 144, 256, 400)),
    "Mitsuba kernel, 16 probes": ("mitsuba_kernel", "Probing", (64, 144, 256, 400)),
}
"""Module, class and sample counts. Another tracer is another row."""
OURS: tuple[Technique, ...] = (
    *(RayTraced(samples=samples) for samples in (16, 64, 144, 256, 400)),
    *(DepthComplexity(samples=samples) for samples in (16, 64, 144, 256)),
    DepthComplexity(samples=200, passes=2),
)
REFERENCE = RayTraced(samples=256, passes=16, pattern="low_discrepancy", seed=99)
PROBES = 16
PATIENCE_S = 5.0
"""What takes longer than this in its warm-up has no other turn: that one counts."""

Run = Callable[[], tuple[Points, float]]


@dataclass
class Row:
    """One tracer with one number of samples."""

    tracer: str
    samples: int
    ours: bool
    times_ms: list[float] = field(default_factory=list)
    rmse: float = float("nan")
    is_slow: bool = False
    """Measured in its first turn alone, which makes its pipelines, too."""

    @property
    def ms(self) -> float:
        """The median."""
        return statistics.median(self.times_ms)


@dataclass
class Beside:
    """What was measured on one model."""

    model: str
    size: tuple[int, int]
    receivers: int
    in_penumbra: int
    standard_error: float
    reference: RayTraced
    rows: list[Row]
    refused: list[str]
    """Techniques of ours that do not serve this model, each with its reason."""


def main(arguments: list[str] | None = None) -> int:
    """Prints the tables; the exit code is 1 where nothing could be compared."""
    quiet_driver()
    parser = argparse.ArgumentParser(prog="softshadow.bench.peers", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--scene", action="append", help="canopy, bunny, teapots, ..., or a mesh such as cow.obj")
    parser.add_argument("--technique", action="append", type=parse_technique, help="instead of our usual list")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels")
    parser.add_argument("--rounds", type=int, default=7, help="turns after the warm-up")
    parser.add_argument("--device", default="auto")
    parser.add_argument("--json", type=Path, help="also writes a line of JSON for each row, which reports take")
    chosen = parser.parse_args(arguments)
    tracers, skipped = installed()
    done, recorded = 0, list[str]()
    for name in chosen.scene or ["bunny"]:
        try:
            model = find(name, chosen.size)
            found = beside(model, tracers, chosen.technique or OURS, chosen.rounds, chosen.device)
        except SoftShadowError as error:
            skipped.append(f"{name}: {error}")
            continue
        skipped += found.refused
        print("\n".join([*lines(found), *ratio_lines(found)]))
        recorded += json_lines(found)
        if chosen.json:
            chosen.json.write_text("".join(f"{line}\n" for line in recorded), encoding="utf-8")
        done += 1
    print(f"{len(skipped)} skipped" + "".join(f"\n- {reason}" for reason in skipped))
    return 0 if done and tracers else 1


def installed() -> tuple[dict[str, tuple[type[Any], tuple[int, ...]]], list[str]]:
    """Tracers that can be imported, and why the others cannot."""
    found, skipped = {}, []
    for name, (module, kind, counts) in PEERS.items():
        try:
            found[name] = (getattr(importlib.import_module(f"softshadow.bench.{module}"), kind), counts)
        except ImportError as error:
            skipped.append(f"{name}: {error}; pip install 'softshadow[bench]'")
    return found, skipped


def beside(
    model: Measured,
    tracers: Mapping[str, tuple[type[Any], Sequence[int]]],
    techniques: Sequence[Technique],
    rounds: int,
    device: Device = "auto",
    reference: RayTraced = REFERENCE,
) -> Beside:
    """Everything on the same receivers, taking turns."""
    if isinstance(model.light, SphereLight | SunLight):
        raise SceneError(f"{model.name}: others get one set of positions, which neither a sphere nor a sun has")
    placed = visibility(model.scene, model.light, camera=model.camera, receivers=True, device=device)
    if placed.positions is None or placed.normals is None:
        raise AssertionError("receivers were asked for")
    seen = placed.valid
    origins, normals = model.stored(placed.positions[seen]), placed.normals[seen]

    def ours(technique: Technique, standard_error: bool = False) -> Any:
        return visibility(
            model.scene,
            model.light,
            camera=model.camera,
            technique=technique,
            standard_error=standard_error,
            device=device,
        )

    def timed(technique: Technique) -> tuple[Points, float]:
        result = ours(technique)
        return result.values[seen], result.info["wall_ms"]

    def on_light(samples: int, seed: int) -> Points:
        return model.stored(light_points(model.light, samples, scene=model.scene, seed=seed).positions.reshape(-1, 3))

    true = ours(reference, standard_error=True)
    truth, standard_error = true.values[seen], true.standard_error[seen]
    penumbra = (truth > 0.002) & (truth < 0.998)
    entered: list[tuple[Row, Run]] = []
    for technique in techniques:
        samples = getattr(technique, "samples", 1) * getattr(technique, "passes", 1)
        entered.append((Row(named(technique), samples, ours=True), partial(timed, technique)))
    for name, (kind, counts) in tracers.items():
        tracer = kind(model.vertices, model.faces)
        for samples in counts:
            targets = on_light(samples, RayTraced.seed)
            query = Query(origins, normals, targets, probes=on_light(PROBES, RayTraced.seed + 1), seen=seen)
            entered.append((Row(name, samples, ours=False), partial(tracer.visibility, query)))
    refused = []
    for turn in range(rounds + 1):
        for row, run in list(entered):
            if turn and row.is_slow:
                continue
            try:
                values, ms = run()
            except SoftShadowError as error:
                refused.append(f"{model.name}, {row.tracer} with {row.samples} samples: {error}")
                entered.remove((row, run))
                continue
            row.rmse = float(np.sqrt(np.mean((values[penumbra] - truth[penumbra]) ** 2)))
            row.is_slow |= turn == 0 and ms > 1e3 * PATIENCE_S
            if turn or row.is_slow:
                row.times_ms.append(ms)
    return Beside(
        model=model.name,
        size=model.camera.size,
        receivers=len(origins),
        in_penumbra=int(penumbra.sum()),
        standard_error=float(np.sqrt(np.mean(standard_error[penumbra] ** 2))),
        reference=reference,
        rows=[row for row, _ in entered],
        refused=refused,
    )


def named(technique: Technique) -> str:
    """Its name, and the settings that are not its defaults; how many samples there are is said elsewhere."""
    usual = type(technique)()
    settings = [item.name for item in fields(technique) if item.name not in ("samples", "passes")]
    changed = [name for name in settings if getattr(technique, name) != getattr(usual, name)]
    return ", ".join([technique.name, *(f"{name}={getattr(technique, name)}" for name in changed)])


def lines(found: Beside) -> list[str]:
    """Every row, as a table in Markdown."""
    width, height = found.size
    samples = found.reference.samples * found.reference.passes
    table = []
    for row in found.rows:
        beaten = fastest([other for other in found.rows if not other.ours and other.samples == row.samples], np.inf)
        ratio = f"{row.ms / beaten.ms:.2f}" if row.ours and beaten else ""
        once = " (first turn)" if row.is_slow else ""
        table.append(f"| {row.tracer} | {row.samples} | {row.ms:.0f}{once} | {row.rmse:.4f} | {ratio} |")
    return [
        f"**{found.model}**, {width} × {height}, {found.receivers:,} receivers, {found.in_penumbra:,} of them in the "
        f"penumbra; the reference has {samples:,} samples and a standard error of {found.standard_error:.4f}.",
        "",
        "| tracer | samples | ms | RMSE in penumbra | ms : fastest other with as many samples |",
        "|---|---|---|---|---|",
        *table,
        "",
    ]


def json_lines(found: Beside) -> list[str]:
    """Every row as an object; a root mean square error of nothing is null."""
    return [
        json.dumps(
            {
                "kind": "peer",
                "scene": found.model,
                "size": found.size,
                "tracer": row.tracer,
                "samples": row.samples,
                "ours": row.ours,
                "times_ms": row.times_ms,
                "rmse": _known(row.rmse),
                "is_slow": row.is_slow,
                "receivers": found.receivers,
                "in_penumbra": found.in_penumbra,
                "reference_standard_error": _known(found.standard_error),
            },
            allow_nan=False,
        )
        for row in found.rows
    ]


def _known(number: float) -> float | None:
    return None if math.isnan(number) else number


def fastest(rows: list[Row], level: float) -> Row | None:
    """The fastest whose error is at most this."""
    return min((row for row in rows if row.rmse <= level), key=lambda row: row.ms, default=None)


def ratio_lines(found: Beside) -> list[str]:
    """Our time over theirs, each as fast as it gets at an error, as a table in Markdown; last that over the fastest."""
    ours = list(dict.fromkeys(row.tracer for row in found.rows if row.ours))
    theirs = list(dict.fromkeys(row.tracer for row in found.rows if not row.ours))
    theirs += ["fastest other"] * (len(theirs) > 1)
    table = [
        f"| ms ours : theirs at RMSE | {' | '.join(f'≤ {level}' for level in LEVELS)} |",
        "|---" * (len(LEVELS) + 1) + "|",
    ]
    for a in ours:
        for b in theirs:
            cells = []
            for level in LEVELS:
                their_rows = [row for row in found.rows if row.tracer == b or (b == "fastest other" and not row.ours)]
                our_best = fastest([row for row in found.rows if row.tracer == a], level)
                their_best = fastest(their_rows, level)
                words = "–"
                if our_best and their_best:
                    words = f"{our_best.ms / their_best.ms:.2f} ({our_best.samples} : {their_best.samples} samples)"
                cells.append(words)
            table.append(f"| {a} : {b} | {' | '.join(cells)} |")
    return [*table, ""]


if __name__ == "__main__":
    sys.exit(main())
