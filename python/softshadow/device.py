"""Devices, made when first needed and kept for the life of the process."""

from __future__ import annotations

import json
import os
import tempfile
import threading
import warnings
from typing import Any, Literal

from . import _core, logs
from .errors import SettingsError, SoftwareAdapterWarning

Device = Literal["auto", "gpu", "native", "software"] | int

# Keyed by process: in a forked child the parent's device and lock are of no use.
_contexts: dict[tuple[int, str], _core.Context] = {}
_locks: dict[int, threading.Lock] = {}
# Names of software adapters that were announced.
_announced: set[str] = set()


def context(device: Device | str) -> _core.Context:
    """The device of this process for a choice."""
    name = _name(device)
    key = (os.getpid(), name)
    with _locks.setdefault(os.getpid(), threading.Lock()):
        if key not in _contexts:
            _quiet_layer()
            _contexts[key] = _core.Context(name)
            logs.device_chosen(name, json.loads(_contexts[key].adapter))
        return _contexts[key]


def announce(device: Device | str, adapter: dict[str, Any]) -> None:
    """Warns once where a software adapter computed that nobody asked for: the technique draws triangles."""
    asked = _name(device) != "auto" or "SOFTSHADOW_DEVICE" in os.environ
    if asked or adapter["device_type"] != "software" or adapter["name"] in _announced:
        return
    _announced.add(adapter["name"])
    text = f"no graphics card was found to draw triangles; computing with the software driver {adapter['name']}"
    warnings.warn(f'{text} (device="software" says that this is meant)', SoftwareAdapterWarning, stacklevel=3)


def quiet_driver() -> None:
    """For the library's own programs: drivers complain on stderr where there is no desktop session."""
    _quiet_layer()
    # Wayland looks here for a desktop, and finds none.
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())


def _quiet_layer() -> None:
    """Mesa's device-selection layer prefers a desktop's device, which the library chooses itself, and prints an error
    for every device that is opened where there is no desktop."""
    if "XDG_RUNTIME_DIR" not in os.environ:
        os.environ.setdefault("VK_LOADER_LAYERS_DISABLE", "VK_LAYER_MESA_device_select")


def _name(device: object) -> str:
    if isinstance(device, str) and device.isascii():
        return device
    if isinstance(device, int) and not isinstance(device, bool) and device >= 0:
        return str(device)
    raise SettingsError(f"device: 'auto', 'gpu', 'native', 'software' or an adapter's index expected, got {device!r}")
