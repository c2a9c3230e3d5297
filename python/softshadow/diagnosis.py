"""What this machine offers: adapters, their limits, the processor, and what is missing."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from . import _core, backends
from .errors import NoAdapterError, SettingsError


@dataclass(frozen=True, kw_only=True, repr=False)
class Diagnosis:
    """The result of :func:`doctor`; printing it shows a page.

    Attributes
    ----------
    version : str
        Of this library.
    adapters : list of dict
        Every adapter that has a driver with its name, backend, type, driver and limits; its place here is its index.
    native : dict
        The processor as ``device="native"`` uses it: threads, and in ``driver`` its vector instructions.
    chosen : str or None
        What ``device="auto"`` takes.
    advice : list of str
        What is missing or slow, and the command that helps.
    trials : list of dict
        What each technique did on each backend, where that was tried; see :class:`softshadow.backends.Trial`.
    """

    version: str
    adapters: list[dict[str, Any]]
    native: dict[str, Any]
    chosen: str | None
    advice: list[str]
    trials: list[dict[str, Any]]

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return dict(vars(self))

    def __str__(self) -> str:
        lines = [f"softshadow {self.version}"]
        for index, adapter in enumerate(self.adapters):
            lines.append(f"adapter {index}: {adapter['name']}")
            lines += [f"    {name}: {_short(value)}" for name, value in adapter.items() if name != "name"]
        lines.append(f"native: {_chosen(self.native)}")
        lines.append(f"device='auto' takes: {self.chosen or 'nothing'}")
        shown = ["", *backends.table([backends.Trial(**trial) for trial in self.trials])] if self.trials else []
        return "\n".join(lines + self.advice + shown)

    def __repr__(self) -> str:
        return f"<Diagnosis: {len(self.adapters)} adapters>"


def doctor(*, measure: bool = False) -> Diagnosis:
    """Looks at every adapter of the machine; nothing is raised.

    Parameters
    ----------
    measure : bool
        Whether to try every technique on every backend, which compiles all kernels and takes some seconds. Otherwise
        nothing is computed.
    """
    adapters = json.loads(_core.adapters())
    native = json.loads(_core.Context("native").adapter)
    try:
        chosen, advice = _chosen(json.loads(_core.Context("auto").adapter)), []
    except (NoAdapterError, SettingsError) as error:
        chosen, advice = None, [str(error)]
    if not adapters:
        advice.append(_NO_DRIVER)
    trials = [trial.to_dict() for trial in backends.matrix()] if measure else []
    return Diagnosis(
        version=_core.__version__, adapters=adapters, native=native, chosen=chosen, advice=advice, trials=trials
    )


_NO_DRIVER = (
    "no graphics driver: everything runs natively on the processor, but what draws triangles (hard_shadow_map, "
    "depth_complexity with evaluation='blended'). On Debian or Ubuntu a software driver for those is installed by "
    "`apt-get install -y mesa-vulkan-drivers libvulkan1`"
)


def _chosen(adapter: dict[str, Any]) -> str:
    return f"{adapter['name']} ({adapter['backend']}, {adapter['driver']})"


def _short(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_short(inner)}" for name, inner in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
