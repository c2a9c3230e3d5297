"""How far a call is: told to a callable, or shown as a bar."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from .errors import SettingsError
from .extras import needed
from .techniques import Technique

Progress = Callable[[int, int, dict[str, Any]], object]
"""Called with ``(done, total, info)`` between blocks of receivers; returning ``False`` stops the work with
``Interrupted``. `info` says which `call` and which `technique` are at work, and the `elapsed_ms` since it began."""

Report = Callable[[int, int], object]


@contextmanager
def reported(progress: Progress | bool | None, call: str, running: Callable[[int], object]) -> Iterator[Report | None]:
    """What the core calls with ``(done, total)``; `running` is the technique that runs when so much is done."""
    if progress is True:
        with _bar(call) as bar:
            yield bar
    elif progress is None or progress is False:
        yield None
    elif callable(progress):
        yield _told(progress, call, running)
    else:
        raise SettingsError(f"progress: True or a callable (done, total, info) expected, got {progress!r:.80}")


def _told(progress: Progress, call: str, running: Callable[[int], object]) -> Report:
    started = time.perf_counter()

    def report(done: int, total: int) -> object:
        technique = running(done)
        name = technique.name if isinstance(technique, Technique) else ""
        elapsed = 1e3 * (time.perf_counter() - started)
        return progress(done, total, {"call": call, "technique": name, "elapsed_ms": elapsed})

    return report


@contextmanager
def _bar(call: str) -> Iterator[Report]:
    """A bar of tqdm's on stderr, plain text in notebooks too."""
    with needed("progress", "progress=True").tqdm(desc=call, unit="block") as bar:

        def report(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield report
