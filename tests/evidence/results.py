"""Results that are kept: lines of JSON made on named devices, and the tables of documents, generated from them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from benchmark import measured, repeated
from edges import ROOT

Line = dict[str, Any]
KEPT = ROOT / "crates" / "softshadow_bench" / "results"
SCENES = ["hall", "fork", "toruses"]
CASES = {
    "software": ["hard_shadow_map"],
    "native": [
        *(f"ray_traced:samples={samples}" for samples in (16, 64, 256)),
        "ray_traced:samples=64,probes=16",
        *(f"depth_complexity:samples={samples}" for samples in (16, 64, 256)),
    ],
}
REFERENCE = "ray_traced:samples=256,passes=8,pattern=low_discrepancy,seed=7"


def keep(rounds: int, size: str = "960x540", folder: Path = KEPT) -> list[Path]:
    """Measures the shipped scenes on every device that this machine has, a file each."""
    written = []
    for device, cases in CASES.items():
        arguments = [*repeated("--scene", SCENES), *repeated("--technique", cases), "--size", size]
        lines = measured("--device", device, *arguments, "--repeats", str(rounds), "--reference", REFERENCE)
        path = folder / f"{file_name(lines[0]['environment'])}.jsonl"
        path.write_text("".join(json.dumps(line) + "\n" for line in lines))
        written.append(path)
    return written


def file_name(environment: Line) -> str:
    """A device as the name of a file."""
    adapter = environment["adapter"]
    words = f"{adapter['device_type']} {adapter['name']} {environment['threads']} threads"
    return re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")


def table(paths: list[Path]) -> list[str]:
    """Kept measurements as the README shows them."""
    rows = [json.loads(line) for path in sorted(paths) for line in path.read_text().splitlines()]
    rows = [row for row in rows if row["kind"] == "measurement"]
    lines = [
        "| scene | technique | device | ms | RMSE in penumbra | p99 | bias | reference ± |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for scene in SCENES:
        lines += [row_of(row) for row in rows if row["scene"] == scene]
    return lines


def row_of(row: Line) -> str:
    """A technique on a scene."""
    settings, penumbra = row["technique"], row["errors"]["penumbra"]
    words = settings["name"]
    words += f", {settings['samples']} samples" if "samples" in settings else ""
    words += f", {settings['probes']} probes" if settings.get("probes") else ""
    reference = row["reference_standard_error"]
    cells = [row["scene"], words, row["environment"]["adapter"]["name"], f"{row['median_wall_ms']:.0f}"]
    cells += [f"{penumbra['rmse']:.4f}", f"{penumbra['p99']:.3f}", f"{penumbra['bias']:+.4f}"]
    return f"| {' | '.join([*cells, '-' if reference is None else f'{reference:.4f}'])} |"
