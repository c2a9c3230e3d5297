"""Sections of the report that the benchmark's own binary measures: ratios, passes, and a scene that moves."""

from __future__ import annotations

import json
import statistics
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from edges import ROOT

Line = dict[str, Any]
REFERENCE = "ray_traced:samples=256,passes=4,pattern=low_discrepancy,seed=99"
SMALL = 0.01
"""Passes below this share of the wall time are added up."""


def measured(*arguments: str) -> list[Line]:
    """What the benchmark records, a line each."""
    with tempfile.TemporaryDirectory() as folder:
        json_lines = Path(folder, "lines.json")
        command = ["cargo", "run", "--release", "--quiet", "--package", "softshadow_bench", "--"]
        command += ["--json", str(json_lines), *arguments]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        return [json.loads(line) for line in json_lines.read_text().splitlines()]


def repeated(flag: str, values: list[str]) -> list[str]:
    """A flag before each of its values."""
    return [word for value in values for word in (flag, value)]


def complete(lines: list[Line]) -> bool:
    """Whether nothing was skipped and nothing failed."""
    return not any(line["kind"] in ("skip", "failure") for line in lines)


def ratios(scenes: list[str], rounds: int) -> tuple[list[str], bool]:
    """Published ratios beside ours."""
    arguments = ["--ratios", "published", "--repeats", str(rounds), "--reference", REFERENCE]
    lines = measured("--device", "native", *repeated("--scene", scenes), *arguments)
    table = [
        "Times of two settings of `depth_complexity` over each other, turn by turn in one run, 512 × 512. Published "
        "are those of Forest, Barthe and Paulin (2008): whole pictures of 1024 × 1024 on a Geforce 8800 GTX. The two "
        "differ where the two programs do. There samples are channels to blend; here 64 of them are bits of two words, "
        "and finding edges costs the same for any number. There exact coverage is a naive search; here it is one "
        "more look-up, and only samples next to an edge are tested. Interleaving adds a filter over the image, "
        "and blurs penumbrae narrower than its square. "
        "Semi-opaque (all triangles of opacity 0.5): the paper adds opacities in the counters it has; here sums of "
        "logarithms are bit planes beside them. RMSE is that in the penumbra, of the semi-opaque scene against its own "
        "reference.",
        "",
        "| scene | ratio | published | ours, median | from | to | RMSE of | over |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for line in lines:
        if line["kind"] == "ratio":
            numbers = [f"{x:.2f}" for x in (line["median"], *line["range"])]
            errors = [f"{x:.4f}" for x in line["penumbra_rmse"]]
            table.append(f"| {' | '.join([line['scene'], line['name'], line['published'], *numbers, *errors])} |")
    return [*table, ""], complete(lines)


def passes(scene: str, cases: list[str], rounds: int, devices: tuple[str, ...]) -> tuple[list[str], bool]:
    """Milliseconds of every pass by device, and what they explain of the wall time."""
    arguments = ["--scene", scene, *repeated("--technique", cases), "--repeats", str(rounds), "--reference", REFERENCE]
    lines = [{**line, "device": device} for device in devices for line in measured("--device", device, *arguments)]
    rows = [line for line in lines if line["kind"] == "measurement"]
    times = [{one["label"]: one["ms"] for one in row["pass_ms"]} for row in rows]
    labels = list(dict.fromkeys(label for column in times for label in column))
    table = [
        f"**{scene}**, 512 × 512, milliseconds and per cent of the wall time, from runs in which every pass is a "
        "submission of its own; the wall time of runs with one submission stands last. The same kernels natively and "
        "by a software driver on the same processors: what the driver costs. Passes that stay below "
        f"{SMALL:.0%} are added up.",
        "",
        f"| pass | {' | '.join(', '.join([row['case'], row['device']]) for row in rows)} |",
        "|---" * (len(rows) + 1) + "|",
    ]

    def cells(ms: list[float]) -> str:
        return " | ".join(f"{x:.1f} ({x / row['pass_run_wall_ms']:.1%})" for x, row in zip(ms, rows, strict=True))

    def of(label: str) -> list[float]:
        return [column.get(label, 0.0) for column in times]

    small = [
        name for name in labels if all(x < SMALL * r["pass_run_wall_ms"] for x, r in zip(of(name), rows, strict=True))
    ]
    table += [f"| {label} | {cells(of(label))} |" for label in labels if label not in small]
    rest = [sum(column.get(label, 0.0) for label in small) for column in times]
    table += [
        f"| {len(small)} small passes | {cells(rest)} |",
        f"| **all passes** | {cells([sum(column.values()) for column in times])} |",
        f"| wall time of that run | {cells([row['pass_run_wall_ms'] for row in rows])} |",
        f"| wall time, one submission | {' | '.join(str(round(row['median_wall_ms'], 1)) for row in rows)} |",
        "",
    ]
    return table, complete(lines)


def waving(scenes: list[str], cases: list[str], frames: int) -> tuple[list[str], bool]:
    """Refits against scenes made anew, and shadows of the frames."""
    arguments = ["--waving", str(frames), "--repeats", "1", "--reference", REFERENCE]
    lines = measured("--device", "native", *repeated("--scene", scenes), *repeated("--technique", cases), *arguments)
    columns = "scene|triangles|case|refit ms|build ms|refit : build|shadows ms|refit : shadows|made anew|differing"
    table = [
        f"Scenes that sway (`procedural::waving`), {frames} frames of one period, 512 × 512. *Refit*: what the library "
        "makes of the last frame to come to this one. *Build*: the same vertices as a scene that nobody has seen, in "
        "turns. *Shadows*: plan to values of the frame that was refitted, its upload included. Medians, with the "
        "fastest and slowest frame. *Differing*: receivers whose value is not that of the scene made anew, bit by bit.",
        "",
        f"| {columns.replace('|', ' | ')} |",
        "|---" * (columns.count("|") + 1) + "|",
    ]
    agreed = True
    for line in lines:
        if line["kind"] != "waving":
            continue
        refit, build, shadows = (line[key] for key in ("refit_ms", "build_ms", "wall_ms"))
        cells = [line["scene"], f"{line['triangles']:,}", line["case"]]
        cells += [f"{statistics.median(ms):.1f} ({min(ms):.1f}–{max(ms):.1f})" for ms in (refit, build)]
        cells.append(f"{statistics.median(a / b for a, b in zip(refit, build, strict=True)):.2f}")
        cells.append(f"{statistics.median(shadows):.0f} ({min(shadows):.0f}–{max(shadows):.0f})")
        cells.append(f"{statistics.median(a / b for a, b in zip(refit, shadows, strict=True)):.2f}")
        cells += [str(len(line["rebuild_reasons"])), str(line["differing_receivers"])]
        table.append(f"| {' | '.join(cells)} |")
        agreed &= line["differing_receivers"] == 0
    return [*table, ""], agreed and complete(lines)
