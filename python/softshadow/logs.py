"""What the library says of its work, through Python's ``logging``: the logger ``softshadow``.

INFO: the device that was chosen and why, and a line for each call with its time and notes. DEBUG: what a call built or
refitted of its scene, and why something could not be kept. Nothing is shown unless the caller sets up logging.
"""

from __future__ import annotations

import logging
import os
from typing import Any

LOGGER = logging.getLogger("softshadow")
# Without a handler Python would print warnings to stderr.
LOGGER.addHandler(logging.NullHandler())


def device_chosen(asked: str, adapter: dict[str, Any]) -> None:
    """One line when a device is opened."""
    variable = os.environ.get("SOFTSHADOW_DEVICE") if asked == "auto" else None
    why = f", as SOFTSHADOW_DEVICE={variable} says" if variable else ""
    if asked == "auto" and not variable and adapter["device_type"] == "native":
        why = ", because no graphics card answered"
    LOGGER.info("device %r: %s%s", asked, adapter_words(adapter), why)


def call_done(call: str, info: dict[str, Any]) -> None:
    """What made a result."""
    made = [f"{info[key]} {key.replace('_', ' ')}" for key in _PREPARED if info[key]]
    LOGGER.debug("%s: %s, %.1f ms", call, ", ".join(made) or "everything kept", info["preparation_ms"])
    for reason in info["rebuild_reasons"]:
        LOGGER.debug("%s: made anew, %s", call, reason)
    technique, adapter = info["technique"]["name"], info["adapter"]["name"]
    receivers, blocks = info["receivers"], info["blocks"]
    words = "%s: %s, %d receivers in %d blocks, %.1f ms on %s"
    LOGGER.info(words, call, technique, receivers, blocks, info["wall_ms"], adapter)
    for note in info["notes"]:
        LOGGER.info("%s: %s", call, note)


def adapter_words(adapter: dict[str, Any]) -> str:
    """An adapter in one line."""
    return f"{adapter['name']} ({adapter['backend']}, {adapter['driver']})"


_PREPARED = ("scene_builds", "scene_refits", "occluder_builds", "occluder_refits")
