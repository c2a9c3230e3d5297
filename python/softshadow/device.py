"""Devices, made when first needed and kept for the life of the process."""

from __future__ import annotations

import json
import os
import threading
import warnings
from typing import Literal

from . import _core
from .errors import SettingsError, SoftwareAdapterWarning

Device = Literal["auto", "gpu", "software"] | int

# Keyed by process: in a forked child the parent's device and lock are of no use.
_contexts: dict[tuple[int, str], _core.Context] = {}
_locks: dict[int, threading.Lock] = {}


def context(device: Device | str) -> _core.Context:
    """The device of this process for a choice; software adapters that nobody asked for are announced once."""
    name = _name(device)
    key = (os.getpid(), name)
    with _locks.setdefault(os.getpid(), threading.Lock()):
        if key in _contexts:
            return _contexts[key]
        made = _contexts[key] = _core.Context(name)
    adapter = json.loads(made.adapter)
    if name == "auto" and adapter["device_type"] == "software":
        text = f"no graphics card was found; computing on the processor with {adapter['name']}"
        hint = '(device="software" says that this is meant)'
        warnings.warn(f"{text} {hint}", SoftwareAdapterWarning, stacklevel=3)
    return made


def quiet_driver() -> None:
    """For the library's own programs: Mesa's device-selection layer complains where there is no desktop session."""
    os.environ.setdefault("VK_LOADER_LAYERS_DISABLE", "VK_LAYER_MESA_device_select")


def _name(device: object) -> str:
    if isinstance(device, str):
        return device
    if isinstance(device, int) and not isinstance(device, bool) and device >= 0:
        return str(device)
    raise SettingsError(f"device: 'auto', 'gpu', 'software' or an adapter's index expected, got {device!r}")
