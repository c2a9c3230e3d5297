"""Every technique on every backend: what must run and what must fail is data, in tests/backends.json."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

import softshadow as ss
from softshadow import backends
from softshadow.backends import Trial
from softshadow.techniques import TECHNIQUES

ROOT = Path(__file__).parents[2]
DATA = json.loads((ROOT / "tests" / "backends.json").read_text())


def kind(backend: str) -> str:
    """A backend without the index of its adapter."""
    return backend if backend.startswith("wgpu-py") else backend.partition(" ")[0]


def expected(trial: Trial) -> dict | None:
    """The failure that a trial is expected to end in."""
    rows = (row for row in DATA["expected_failures"] if kind(trial.backend) in row["backends"])
    return next((row for row in rows if trial.technique in row["techniques"]), None)


def faults(trials: list[Trial]) -> list[str]:
    """Trials that failed, or passed, against expectation."""
    found = []
    for trial in trials:
        row, told = expected(trial), f"{trial.technique} on {trial.backend}"
        if row is None and trial.error is not None:
            found.append(f"{told} failed: {trial.says}")
        elif row is not None and trial.error is None:
            found.append(f"{told} ran, though a failure is expected")
        elif row is not None and (trial.error != row["error"] or row["says"] not in (trial.says or "")):
            found.append(f"{told} failed otherwise: {trial.error}: {trial.says}")
    return found


@pytest.fixture(scope="module")
def trials() -> list[Trial]:
    return backends.matrix()


def test_what_runs_and_what_fails_is_what_the_data_say(trials):
    print("\n".join(backends.table(trials)))
    assert faults(trials) == []
    kinds = {kind(trial.backend) for trial in trials}
    if os.environ.get("SOFTSHADOW_EXPECT_ADAPTER") == "lavapipe":
        assert {"native", "vulkan", "gl", "wgpu-py vulkan"} <= kinds
    names = {trial.technique.partition(":")[0] for trial in trials}
    assert names == set(TECHNIQUES)
    assert len(trials) == len({trial.backend for trial in trials}) * len(backends.variants())


def test_an_expected_failure_that_passes_is_red_and_so_is_any_other(trials):
    failed = next(trial for trial in trials if trial.error is not None)
    passed = next(trial for trial in trials if trial.error is None)
    for spoilt in (
        replace(failed, error=None, says=None, ms=1.0),
        replace(failed, error="GpuError"),
        replace(failed, says="the device was lost"),
        replace(passed, ms=None, error="SettingsError", says="no"),
    ):
        assert len(faults([spoilt])) == 1


def test_names_in_the_data_exist():
    known = backends.variants()
    for row in DATA["expected_failures"]:
        assert set(row["techniques"]) <= set(known)
        assert hasattr(ss, row["error"])
    assert set(DATA["vulkan_and_gl"]["tolerance"]) <= set(TECHNIQUES)


def test_adapters_have_the_features_that_the_data_say():
    for adapter in ss.doctor().adapters:
        wanted = DATA["features"].get(adapter["backend"])
        if adapter["device_type"] == "software" and wanted is not None:
            optional = set(DATA["alternatives"]) & set(adapter["features"])
            assert optional == set(wanted), adapter["backend"]


def test_what_alternatives_say_is_so():
    sources = {path.name: path.read_text() for path in (ROOT / "shaders_wgsl").rglob("*.wgsl")}
    assert len(sources) > 30
    for word in ("textureSample", "textureGather", "textureAtomic"):
        assert not [name for name, text in sources.items() if word in text], word
    assert ss.DepthComplexity.counters == "words"


def test_values_that_nobody_computed_are_no_success(monkeypatch):
    native = backends._on("native")
    monkeypatch.setattr(backends, "_by_wgpu", list)
    monkeypatch.setattr(backends, "_backends", lambda: {"idle": lambda: lambda technique: 0 * native(technique)})
    monkeypatch.setattr(backends, "variants", lambda: {"ray_traced": ss.RayTraced(samples=4)})
    (trial,) = backends.matrix()
    assert (trial.error, trial.ms) == ("WrongValues", None)


def test_a_backend_that_cannot_be_opened_has_a_row(monkeypatch):
    def broken():
        raise ss.NoAdapterError("gone")

    monkeypatch.setattr(backends, "_by_wgpu", list)
    monkeypatch.setattr(backends, "_backends", lambda: {"broken": broken})
    found = backends.matrix()
    assert [trial.error for trial in found] == ["NoAdapterError"] * len(backends.variants())
    assert "    gone" in backends.table(found)


def test_doctor_shows_the_matrix(trials, monkeypatch):
    monkeypatch.setattr(backends, "matrix", lambda: trials)
    page = str(ss.doctor(measure=True))
    assert all(name in page for name in backends.variants())
    assert "native" in page
    assert ss.doctor().trials == []
