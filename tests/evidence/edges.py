"""Silhouette edges against rays on real meshes, and the tests' own tests."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def against_rays() -> tuple[list[str], bool]:
    """Ten million receivers, every sample against float64 rays; and areas against exact unions of polygons."""
    with tempfile.TemporaryDirectory() as folder:
        samples, areas = Path(folder, "samples.md"), Path(folder, "areas.md")
        command = "cargo test --release -p softshadow_native --test truth --quiet -- --ignored"
        environment = os.environ | {"SOFTSHADOW_EDGE_TABLE": str(samples), "SOFTSHADOW_AREA_TABLE": str(areas)}
        passed = subprocess.run(command.split(), cwd=ROOT, env=environment).returncode == 0
        tables = [path.read_text() if path.is_file() else "no table was made\n" for path in (samples, areas)]
    return [
        "Scalar float32 (`softshadow_native`), 64 samples a receiver: receivers on casters, on their edges "
        "and corners, on the ground, 1e-6 to 1e-1 off the casters, and all around, on unit-high models under "
        "a light as large as they are. Where edges and rays differ, the sample is *grazing* if an exact "
        "determinant of its triangle lies below the bound of rounding (28 roundings; the most that one needed "
        "stands beside), else a *fault*. *Gross*: receivers with more than 8 grazing samples. Tables (2,048 "
        "directions, 512 × 512 lines) are compared with exact coverage on every eighth receiver: the share of "
        "samples that moved, all within a table's cell of an edge, else a *table fault*.",
        "",
        *tables[0].splitlines(),
        "",
        "Exact area where the counters of 64 samples show a single depth, against the exact union of "
        "polygons. *Fooled*: layers overlap between the samples, and the area is off by more than 1e-5 of the "
        "light. A stricter test would be worse: samples in their place are off by several times as much.",
        "",
        *tables[1].splitlines(),
        "",
    ], passed


def mutants() -> tuple[list[str], bool]:
    """One thing done wrong at a time: the tests have to fail."""
    result = subprocess.run([sys.executable, Path(__file__).with_name("mutants.py")], stdout=subprocess.PIPE, text=True)
    introduction = (
        "Each line is one change that the tests of `softshadow_scene` and `softshadow_native` must notice, "
        "and for WGSL those of the device."
    )
    return [introduction, "", *result.stdout.splitlines(), ""], result.returncode == 0
