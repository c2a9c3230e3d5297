"""How far a call is: told to a callable, or shown as a bar."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from .errors import SettingsError
from .extras import needed
from .techniques import Technique

Progress = Callable[[int, int, dict[str, Any]], object]
"""Called with ``(done, total, info)`` between blocks of receivers; returning ``False`` stops the work with
``Interrupted``. `info` says which `call` and which `technique` are at work, and the `elapsed_ms` since it began."""

Report = Callable[[int, int], object]


def callback(progress: Progress | bool | None, call: str, running: Callable[[int], object]) -> Report | None:
    """What the core calls with ``(done, total)``; `running` is the technique that runs when so much is done."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return _bar(call)
    if callable(progress):
        return _told(progress, call, running)
    raise SettingsError(f"progress: True or a callable (done, total, info) expected, got {progress!r:.80}")


def _told(progress: Progress, call: str, running: Callable[[int], object]) -> Report:
    started = time.perf_counter()

    def report(done: int, total: int) -> object:
        technique = running(done)
        name = technique.name if isinstance(technique, Technique) else ""
        elapsed = 1e3 * (time.perf_counter() - started)
        return progress(done, total, {"call": call, "technique": name, "elapsed_ms": elapsed})

    return report


def _bar(call: str) -> Report:
    """A bar of tqdm's on stderr, plain text in notebooks too. One that is left behind by an error closes itself."""
    bar = needed("progress", "progress=True").tqdm(desc=call, unit="block")

    def report(done: int, total: int) -> None:
        bar.total = total
        bar.update(done - bar.n)
        if done == total:
            bar.close()

    return report
