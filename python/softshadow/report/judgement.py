"""What rows of time and error allow to be said: families, domination, and who is fastest for an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from softshadow.techniques import TECHNIQUES

Row = dict[str, Any]

LEVELS = (0.05, 0.02, 0.01, 0.005)
"""Root mean square errors in the penumbra at which the fastest are compared."""

# Whole numbers that say which method it is; all others are knobs, which trade time for error.
_IDENTITY = ("seed", "tile", "probes", "base", "batches")


@dataclass(frozen=True)
class Dominated:
    """Another row takes no more time and errs no more."""

    by: int
    """Its index."""
    is_certain: bool
    """Whether times lie apart in all runs, and errors by more than the reference's own can explain."""


def family(settings: dict[str, Any]) -> str:
    """A technique's name, and what is not its default but for its knobs: rows of a family are one curve."""
    kind = TECHNIQUES.get(settings["name"])
    usual = vars(kind()) if kind else {}
    fixed = {name: value for name, value in settings.items() if name != "name" and not _is_knob(name, value)}
    changed = [f"{name}={_word(value)}" for name, value in fixed.items() if usual.get(name) != value]
    return ", ".join([settings["name"], *changed])


def knob(settings: dict[str, Any]) -> str:
    """What a technique's knobs stand at, in words; empty without knobs."""
    knobs = {name: value for name, value in settings.items() if _is_knob(name, value)}
    passes, samples = knobs.pop("passes", 1), knobs.pop("samples", None)
    words = [f"{name} {value}" for name, value in knobs.items()]
    if samples is not None:
        words.insert(0, f"{samples} samples" if passes == 1 else f"{passes} × {samples} samples")
    return ", ".join(words)


def knob_order(settings: dict[str, Any]) -> tuple[int, ...]:
    """Sorts the rows of a family along its curve."""
    knobs = {name: value for name, value in settings.items() if _is_knob(name, value)}
    samples = knobs.pop("samples", 0) * knobs.pop("passes", 1)
    return (samples, *knobs.values())


def short_knob(settings: dict[str, Any]) -> str:
    """The same as few digits, for a mark in a figure."""
    return knob(settings).replace(" samples", "").replace("resolution ", "")


def full_name(settings: dict[str, Any]) -> str:
    """Family and knobs."""
    return ", ".join(filter(None, (family(settings), knob(settings))))


def families(rows: Sequence[Row]) -> dict[str, list[int]]:
    """Indices of rows by family, along each curve."""
    found: dict[str, list[int]] = {}
    for index, row in enumerate(rows):
        found.setdefault(family(row["technique"]), []).append(index)
    return {name: sorted(list_, key=lambda i: knob_order(rows[i]["technique"])) for name, list_ in found.items()}


def rmse(row: Row) -> float | None:
    """Root mean square error in the penumbra; None where there is no penumbra."""
    penumbra = row["penumbra"]
    return None if penumbra is None else float(penumbra["rmse"])


def domination(rows: Sequence[Row], standard_error: float | None) -> list[Dominated | None]:
    """For each row what dominates it, if anything; of several the one that errs least for its time."""
    return [_dominated(rows, index, standard_error) for index in range(len(rows))]


def _dominated(rows: Sequence[Row], index: int, standard_error: float | None) -> Dominated | None:
    own, error = rows[index], rmse(rows[index])
    if error is None:
        return None
    better: list[tuple[float, int]] = []
    for other, row in enumerate(rows):
        its = rmse(row)
        if its is None or row["median_ms"] > own["median_ms"] or its > error:
            continue
        if row["median_ms"] < own["median_ms"] or its < error:
            better.append((its * row["median_ms"], other))
    if not better:
        return None
    by = min(better)[1]
    less, room = rmse(rows[by]) or 0.0, 2 * (standard_error or 0.0)
    is_apart = rows[by]["range_ms"][1] < own["range_ms"][0]
    return Dominated(by, is_apart and (less == error or error - less > room))


def fastest(rows: Sequence[Row], level: float, among: Sequence[int]) -> int | None:
    """The index of the fastest row whose error is at most this."""
    able = [index for index in among if (error := rmse(rows[index])) is not None and error <= level]
    return min(able, key=lambda index: rows[index]["median_ms"], default=None)


def _is_knob(name: str, value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and name not in _IDENTITY


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
