"""``max_error`` and ``max_ms``: what is chosen, what is said of it, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest

import softshadow as ss
from softshadow.cli import main

CARDS = ss.scenes.load("cards")
SIZE = (48, 36)


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory, monkeypatch):
    """Calibrations of these tests are kept for these tests."""
    monkeypatch.setenv("SOFTSHADOW_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))


@pytest.fixture
def view() -> ss.Camera:
    return ss.Camera.look_at(eye=(3, 2.5, 3), target=(0, 0.3, 0), fov_y_deg=40, size=SIZE)


def chosen(view: ss.Camera, **goal: object) -> ss.Visibility:
    return ss.visibility(CARDS.scene, CARDS.light, camera=view, device="native", **goal)


def test_an_error_is_kept_and_how_it_is_known_is_said(view):
    result = chosen(view, max_error=0.02)
    choice = result.info["choice"]
    assert choice["met"]
    assert choice["kind"] == result.info["error_kind"] == "statistical"
    assert choice["limit"] == {"max_error": 0.02}
    assert choice["norm"] == "rmse"
    error = choice["error"]
    assert error["confidence"] == 0.95
    assert error["estimate"] <= error["upper"] <= 0.02
    assert any(row["wall_ms"] and row["technique"] == result.info["technique"] for row in choice["candidates"])
    fine = ss.RayTraced(samples=256, passes=8, pattern="low_discrepancy", seed=3)
    truth = ss.visibility(CARDS.scene, CARDS.light, camera=view, device="native", technique=fine).values
    penumbra = (truth > 0.002) & (truth < 0.998)
    assert np.sqrt(np.mean((result.values - truth)[penumbra] ** 2)) <= 0.02


def test_what_nothing_keeps_comes_with_the_best_result(view):
    with pytest.raises(ss.BoundNotMet, match=r"max_error 0\.00001") as caught:
        chosen(view, max_error=1e-5)
    best = caught.value.best
    assert best.values.shape == SIZE[::-1]
    assert best.info["choice"]["met"] is False
    with pytest.raises(ss.BoundNotMet, match="max_ms"):
        chosen(view, max_ms=1e-3)


def test_points_and_times(view):
    points = np.stack([np.linspace(-1, 1, 200), np.full(200, 1e-3), np.linspace(-1, 1, 200)], axis=1)
    up = np.tile([0.0, 1.0, 0.0], (200, 1))
    goal = {"max_ms": 60_000.0, "device": "native"}
    result = ss.visibility(CARDS.scene, [CARDS.light], points=points, normals=up, **goal)
    assert result.values.shape == (1, 200)
    assert result.info["choice"]["limit"] == {"max_ms": 60_000.0}
    assert result.positions is None


def test_goals_that_make_no_sense_are_refused(view):
    for goal, words in [
        ({"max_error": 0.1, "max_ms": 5.0}, "give one of them"),
        ({"max_error": -1.0}, "max_error: must be positive"),
        ({"max_error": "small"}, "max_error: a number expected"),
        ({"max_error": 0.1, "error_norm": "mean"}, "error_norm: 'rmse', 'p99' or 'max' expected, got 'mean'"),
        ({"max_error": 0.1, "error_norm": 2}, "error_norm"),
        ({"max_error": 0.1, "confidence": 2.0}, "confidence"),
        ({"max_error": 0.1, "technique": ss.RayTraced()}, "technique: max_error and max_ms choose it"),
        ({"max_error": 0.1, "sample_masks": True}, "sample_masks"),
    ]:
        with pytest.raises(ss.SettingsError, match=words):
            chosen(view, **goal)


def test_the_command_line_chooses_and_its_exit_code_says_whether_the_bound_is_met(tmp_path, capsys):
    output = tmp_path / "out.npy"
    command = ["visibility", "cards", "--size", "48x36", "--device", "native", "-o", str(output), "--json"]
    assert main([*command, "--max-error", "0.05", "--error-norm", "p99"]) == 0
    said = capsys.readouterr()
    choice = json.loads(said.out)["choice"]
    assert choice["norm"] == "p99"
    assert "p99 " in said.err
    assert "95% sure" in said.err
    output.unlink()
    assert main([*command, "--max-error", "1e-5"]) == 3
    assert "not met: max_error 0.00001" in capsys.readouterr().err
    assert output.is_file()
    assert main([*command, "--max-error", "0.05", "--technique", "ray-traced"]) == 2
