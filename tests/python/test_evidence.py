"""Sections of the evidence, from lines as the benchmark records them: the benchmark itself takes minutes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "evidence"
RATIO = {
    "kind": "ratio",
    "scene": "bunny",
    "name": "64 : 16 samples",
    "published": "about 5",
    "median": 1.25,
    "range": [1.0, 1.5],
    "penumbra_rmse": [0.0171, 0.0464],
}
FRAMES = {
    "kind": "waving",
    "scene": "bunny",
    "triangles": 69453,
    "case": "ray_traced",
    "refit_ms": [2.0, 3.0, 40.0],
    "build_ms": [10.0, 10.0, 50.0],
    "wall_ms": [100.0, 100.0, 200.0],
    "rebuild_reasons": [],
    "differing_receivers": 0,
}
PASSES = {
    "kind": "measurement",
    "case": "depth_complexity:samples=64",
    "pass_ms": [{"label": "fold", "ms": 90.0}, {"label": "clear", "ms": 0.2}, {"label": "report", "ms": 0.3}],
    "pass_run_wall_ms": 100.0,
    "median_wall_ms": 95.0,
}
FAILURE = {"kind": "failure", "reason": "too dense"}


@pytest.fixture
def recorded(monkeypatch):
    """Answers in place of the benchmark's."""
    monkeypatch.syspath_prepend(str(FOLDER))
    import benchmark

    yield benchmark, lambda *lines: monkeypatch.setattr(benchmark, "measured", lambda *arguments: list(lines))
    for name in ("benchmark", "edges"):
        sys.modules.pop(name, None)


def test_published_ratios_stand_beside_ours(recorded):
    benchmark, answer = recorded
    answer(RATIO, {"kind": "measurement"})
    lines, complete = benchmark.ratios(["bunny"], 1)
    assert complete
    assert lines[-2] == "| bunny | 64 : 16 samples | about 5 | 1.25 | 1.00 | 1.50 | 0.0171 | 0.0464 |"


def test_passes_add_up_to_a_share_of_the_wall_time(recorded):
    benchmark, answer = recorded
    answer(PASSES)
    lines, complete = benchmark.passes("bunny", ["depth_complexity:samples=64"], 1, ("native",))
    assert complete
    assert lines[-6:-1] == [
        "| fold | 90.0 (90.0%) |",
        "| 2 small passes | 0.5 (0.5%) |",
        "| **all passes** | 90.5 (90.5%) |",
        "| wall time of that run | 100.0 (100.0%) |",
        "| wall time, one submission | 95.0 |",
    ]


def test_frames_are_told_by_their_middle_and_must_agree(recorded):
    benchmark, answer = recorded
    answer(FRAMES)
    lines, complete = benchmark.waving(["bunny"], ["ray_traced"], 3)
    assert complete
    row = "| bunny | 69,453 | ray_traced | 3.0 (2.0–40.0) | 10.0 (10.0–50.0) | 0.30 | 100 (100–200) | 0.03 | 0 | 0 |"
    assert lines[-2] == row
    answer(FRAMES | {"differing_receivers": 1})
    assert benchmark.waving(["bunny"], ["ray_traced"], 3)[1] is False


def test_what_failed_fails_the_section(recorded):
    benchmark, answer = recorded
    answer(RATIO, FAILURE)
    assert benchmark.ratios(["bunny"], 1)[1] is False


def test_kept_lines_become_the_tables_of_documents(recorded, monkeypatch, tmp_path):
    _, answer = recorded
    sys.modules.pop("results", None)
    environment = {"adapter": {"name": "Some CPU (8 lanes)", "device_type": "native"}, "threads": 2}
    line = PASSES | {
        "scene": "fork",
        "technique": {"name": "ray_traced", "samples": 64, "probes": 16},
        "errors": {"penumbra": {"rmse": 0.0171, "p99": 0.048, "bias": -0.0002}},
        "reference_standard_error": 0.0012,
        "environment": environment,
    }
    answer(line)
    import results

    monkeypatch.setattr(results, "measured", lambda *arguments: [line])
    monkeypatch.setattr(results, "CASES", {"native": ["ray_traced"]})
    written = results.keep(1, folder=tmp_path)
    assert [path.name for path in written] == ["native-some-cpu-8-lanes-2-threads.jsonl"]
    row = "| fork | ray_traced, 64 samples, 16 probes | Some CPU (8 lanes) | 95 | 0.0171 | 0.048 | -0.0002 | 0.0012 |"
    assert results.table(written)[2:] == [row]
    sys.modules.pop("results", None)
