"""What this machine offers: adapters, their limits, and what to do where there is none."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from . import _core
from .errors import NoAdapterError


@dataclass(frozen=True, kw_only=True, repr=False)
class Diagnosis:
    """The result of :func:`doctor`; printing it shows a page.

    Attributes
    ----------
    version : str
        Of this library.
    adapters : list of dict
        Every adapter with its name, backend, type, driver and limits; its place here is its index.
    chosen : str or None
        The adapter that ``device="auto"`` takes.
    advice : list of str
        What is missing or slow, and the command that helps.
    """

    version: str
    adapters: list[dict[str, Any]]
    chosen: str | None
    advice: list[str]

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return dict(vars(self))

    def __str__(self) -> str:
        lines = [f"softshadow {self.version}"]
        for index, adapter in enumerate(self.adapters):
            lines.append(f"adapter {index}: {adapter['name']}")
            lines += [f"    {name}: {_short(value)}" for name, value in adapter.items() if name != "name"]
        lines.append(f"device='auto' takes: {self.chosen or 'nothing'}")
        return "\n".join(lines + self.advice)

    def __repr__(self) -> str:
        return f"<Diagnosis: {len(self.adapters)} adapters>"


def doctor() -> Diagnosis:
    """Looks at every adapter of the machine; nothing is computed and nothing is raised for want of one."""
    adapters = json.loads(_core.adapters())
    try:
        chosen = json.loads(_core.Context("auto").adapter)
    except NoAdapterError as error:
        return Diagnosis(version=_core.__version__, adapters=adapters, chosen=None, advice=[str(error)])
    slow = "only a software adapter: correct, and much slower than a graphics card"
    advice = [slow] if chosen["device_type"] == "software" else []
    return Diagnosis(version=_core.__version__, adapters=adapters, chosen=chosen["name"], advice=advice)


def _short(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_short(inner)}" for name, inner in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
