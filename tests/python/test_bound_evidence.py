"""A small part of the evidence about ``max_error``: it holds on held-back scenes, and what does not is seen."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[1] / "evidence"


@pytest.fixture
def bound(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setenv("SOFTSHADOW_CACHE", str(tmp_path))
    import bound as module

    yield module
    for name in ("bound", "held_back"):
        sys.modules.pop(name, None)


def test_bounds_hold_on_held_back_scenes(bound, monkeypatch):
    monkeypatch.setattr(bound, "GOALS", [("rmse", 0.03)])
    # Sixteen times fewer rays than the evidence has: still ten times below the bound.
    monkeypatch.setattr(bound, "REFERENCE", replace(bound.REFERENCE, passes=4))
    rows = [row for seed in (900, 901, 902) for row in bound.rows_of(bound.held_back(seed, (48, 48)), "native", 1)]
    assert all(row.met and row.holds for row in rows), rows
    assert all(row.upper is not None and row.told <= row.upper <= 0.03 for row in rows)
    assert all(row.ratio >= 1 for row in rows), "the choice is among the candidates"
    lines, _ = bound.told(rows, 48, "native")
    assert lines[0].startswith("3 runs on random scenes")
    assert "Holds in 100.0%" in lines[2]
    spoilt, passed = bound.told([replace(row, error=0.04) for row in rows], 48, "native")
    assert not passed
    assert "Holds in 0.0%" in spoilt[2]
    assert "**no**" in spoilt[-2]
    assert bound.told([replace(row, ratio=1.6) for row in rows], 48, "native")[1] is False


def test_errors_are_those_of_the_penumbra_and_of_what_is_wrong(bound):
    truth = np.array([[0.0, 0.5, 1.0, np.nan, 0.25]])
    values = np.array([[0.0, 0.53, 0.5, np.nan, 0.25]], dtype=np.float32)
    assert bound.error_of("max", values, truth) == pytest.approx(0.5)
    assert bound.error_of("rmse", values, truth) == pytest.approx(np.sqrt((0.03**2 + 0.5**2) / 3), rel=1e-5)
    assert bound.error_of("rmse", truth, truth) == 0.0
    assert bound.error_of("p99", np.zeros((1, 2)), np.zeros((1, 2))) == 0.0


def test_scenes_of_a_seed_are_the_same_and_others_differ(bound):
    first, again, other = (bound.held_back(seed, (8, 8)) for seed in (7, 7, 8))
    assert first.words == again.words != other.words
    assert all(
        np.array_equal(a.vertices, b.vertices) for a, b in zip(first.scene.meshes, again.scene.meshes, strict=True)
    )
