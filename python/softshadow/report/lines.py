"""JSON lines of ``softshadow-bench`` and of ``softshadow.bench.peers``: what a report takes of them."""

from __future__ import annotations

import json
import os
import statistics
from collections.abc import Iterable
from typing import Any

from softshadow.errors import SettingsError

Line = dict[str, Any]

_RATIO = ("scene", "size", "name", "over", "under", "asked", "published", "median", "range", "penumbra_rmse")
_ABSENT = ("scene", "size", "case", "reason")
_PEER = ("scene", "size", "tracer", "samples", "ours", "times_ms", "rmse", "is_slow", "reference_standard_error")


def read_lines(path: str | os.PathLike[str]) -> list[Line]:
    """The lines of a file.

    Raises
    ------
    SettingsError
        For a line that is no JSON object with a `kind`, by its number.
    OSError
        Where the file cannot be read.
    """
    found = []
    with open(path, encoding="utf-8") as file:
        for number, text in enumerate(file, start=1):
            try:
                line = json.loads(text)
            except ValueError as error:
                raise SettingsError(f"{os.fspath(path)}: line {number} is no JSON: {error}") from None
            if not isinstance(line, dict) or not isinstance(line.get("kind"), str):
                raise SettingsError(f"{os.fspath(path)}: line {number}: an object with a 'kind' expected")
            found.append(line)
    return found


def ratios_of(lines: Iterable[Line]) -> list[Line]:
    """Ratios, as they are."""
    return [_picked("ratio", line, _RATIO) for line in lines if line["kind"] == "ratio"]


def absent_of(lines: Iterable[Line]) -> list[Line]:
    """What could not be measured, and why."""
    return [_picked(line["kind"], line, _ABSENT) for line in lines if line["kind"] in ("skip", "failure")]


def peers_of(lines: Iterable[Line]) -> list[dict[str, Any]]:
    """Tracers by scene and size, with rows like those of a comparison."""
    runs: dict[tuple[str, int, int], dict[str, Any]] = {}
    for line in lines:
        if line["kind"] != "peer":
            continue
        row = _picked("peer", line, _PEER)
        times = row["times_ms"]
        if not times or row["rmse"] is None:
            continue
        scene, (width, height) = row["scene"], row["size"]
        run = runs.setdefault(
            (scene, width, height),
            {
                "scene": scene,
                "size": row["size"],
                "reference_standard_error": row["reference_standard_error"],
                "rows": [],
            },
        )
        run["rows"].append(
            {
                "technique": {"name": row["tracer"], "samples": row["samples"]},
                "ours": row["ours"],
                "is_slow": row["is_slow"],
                "times_ms": times,
                "median_ms": statistics.median(times),
                "range_ms": [min(times), max(times)],
                "penumbra": {"rmse": row["rmse"]},
            }
        )
    return list(runs.values())


def _picked(kind: str, line: Line, names: Iterable[str]) -> Line:
    if missing := [name for name in names if name not in line]:
        raise SettingsError(f"a line of kind '{kind}' lacks {', '.join(missing)}")
    return {name: line[name] for name in names}
