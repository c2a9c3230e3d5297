"""What this machine offers: adapters, their limits, the processor, and what is missing, slow or known bad."""

from __future__ import annotations

import json
import os
import platform
import re
from dataclasses import dataclass
from typing import Any

from . import _core, backends, extras
from .checks import flag
from .errors import NoAdapterError, SettingsError
from .logs import adapter_words


@dataclass(frozen=True, kw_only=True, repr=False)
class Diagnosis:
    """The result of :func:`doctor`; printing it shows a page.

    Attributes
    ----------
    version : str
        Of this library.
    adapters : list of dict
        Every adapter that has a driver with its name, backend, type, driver, limits in bytes and texels, and features;
        `mesa` has Mesa's version where that is the driver, `remarks` what is slow or known bad. An adapter's place here
        is its index.
    native : dict
        The processor as ``device="native"`` uses it: threads, and in ``driver`` its vector instructions.
    chosen : str or None
        What ``device="auto"`` takes.
    extras : dict of str to bool
        The optional packages, and whether they are installed.
    advice : list of str
        What is missing or slow, and the command that helps.
    trials : list of dict
        What each technique did on each backend, where that was tried; see :class:`softshadow.backends.Trial`.
    """

    version: str
    adapters: list[dict[str, Any]]
    native: dict[str, Any]
    chosen: str | None
    extras: dict[str, bool]
    advice: list[str]
    trials: list[dict[str, Any]]

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return dict(vars(self))

    def __str__(self) -> str:
        lines = [f"softshadow {self.version}"]
        for index, adapter in enumerate(self.adapters):
            lines.append(f"adapter {index}: {adapter['name']}")
            rest = {name: value for name, value in adapter.items() if name not in ("name", "index", "remarks")}
            lines += [f"    {name}: {_short(value)}" for name, value in rest.items() if value is not None]
            lines += [f"    remark: {remark}" for remark in adapter["remarks"]]
        lines.append(f"native: {adapter_words(self.native)}")
        lines.append(f"device='auto' takes: {self.chosen or 'nothing'}")
        lines.append(
            "extras: " + ", ".join(f"{name} {'yes' if there else 'no'}" for name, there in self.extras.items())
        )
        lines += [f"advice: {words}" for words in self.advice]
        shown = ["", *backends.table([backends.Trial(**trial) for trial in self.trials])] if self.trials else []
        return "\n".join(lines + shown)

    def __repr__(self) -> str:
        return f"<Diagnosis: {len(self.adapters)} adapters>"


def doctor(*, measure: bool = False) -> Diagnosis:
    """Looks at every adapter of the machine; nothing is raised, and what fails is part of the answer.

    Parameters
    ----------
    measure : bool
        Whether to try every technique on every backend, which compiles all kernels and takes some seconds. Otherwise
        nothing is computed.

    Returns
    -------
    Diagnosis
    """
    adapters = [described(adapter) for adapter in json.loads(_core.adapters())]
    native = json.loads(_core.Context("native").adapter)
    try:
        chosen, advice = adapter_words(json.loads(_core.Context("auto").adapter)), []
    except (NoAdapterError, SettingsError) as error:
        chosen, advice = None, [str(error)]
    if "SOFTSHADOW_DEVICE" in os.environ:
        advice.append(f"SOFTSHADOW_DEVICE={os.environ['SOFTSHADOW_DEVICE']} overrides device='auto'")
    if all(adapter["backend"] == "gl" for adapter in adapters):
        advice.append(f"{_NO_DRIVER if not adapters else _ONLY_GL}; {driver_command(_os_release())}")
    trials = [trial.to_dict() for trial in backends.matrix()] if flag("measure", measure) else []
    return Diagnosis(
        version=_core.__version__,
        adapters=adapters,
        native=native,
        chosen=chosen,
        extras=extras.installed(),
        advice=advice,
        trials=trials,
    )


def described(adapter: dict[str, Any]) -> dict[str, Any]:
    """An adapter with Mesa's version and what is slow or known bad about it."""
    version = re.search(r"\bMesa (\d+\.\d+(?:\.\d+)?)", adapter["driver"])
    mesa = version and version[1]
    is_software, is_llvmpipe = adapter["device_type"] == "software", "llvmpipe" in adapter["name"].lower()
    binding = adapter["storage_binding_bytes"]
    remarks = [
        (is_software, "slow: a driver that computes on the processor; device='native' does so without a driver"),
        (
            is_llvmpipe and mesa is not None,
            "known bad: ends the loops of a shader after 65,535 steps without a word (seen in Mesa 22.3); work is cut "
            "to stay below that, and a call that meets it raises GpuError",
        ),
        (is_software, "known bad: its clock stamps passes before their work is done; info['pass_ms'] stays empty"),
        (
            not is_software and "timestamp-query" not in adapter["features"],
            "no clock: info['pass_ms'] stays empty, and wall_ms is all there is",
        ),
        (
            "float32-blendable" not in adapter["features"],
            "does not blend float32: DepthComplexity(counters='float') is refused; 'words' gives the same samples",
        ),
        (
            binding <= _SMALL_BINDING,
            f"small storage bindings ({binding >> 20} MiB): scenes with more bytes of triangles are traced in parts, "
            "and receivers come in more blocks",
        ),
        (adapter["backend"] == "gl", "slow to open, and taken only where nothing else answers or by its index"),
    ]
    return adapter | {"mesa": mesa, "remarks": [words for applies, words in remarks if applies]}


def driver_command(os_release: dict[str, str]) -> str:
    """The command that installs a software Vulkan driver on this system, in a sentence."""
    names = [os_release.get("ID", ""), *os_release.get("ID_LIKE", "").split()]
    for name in names:
        if name in _COMMANDS:
            return f"a software driver is installed by `{_COMMANDS[name]}`"
    return "install a Vulkan driver, for example Mesa's lavapipe; no command is known for this system"


# What WebGPU promises at least; scenes of some hundred thousand triangles reach it.
_SMALL_BINDING = 128 << 20

_NO_DRIVER = (
    "no graphics driver: everything runs natively on the processor, but what draws triangles (hard_shadow_map, "
    "penumbra_map, occlusion_camera, depth_complexity with evaluation='blended')"
)
_ONLY_GL = "no Vulkan driver, only OpenGL, which is slow and cannot blend float32"

_APT = "apt-get install -y mesa-vulkan-drivers libvulkan1"
_DNF = "dnf install -y mesa-vulkan-drivers vulkan-loader"
_COMMANDS = {
    "debian": _APT,
    "ubuntu": _APT,
    "fedora": _DNF,
    "rhel": _DNF,
    "arch": "pacman -S --noconfirm vulkan-swrast vulkan-icd-loader",
    "alpine": "apk add mesa-vulkan-swrast vulkan-loader",
    "suse": "zypper install -y libvulkan_lvp libvulkan1",
}


def _os_release() -> dict[str, str]:
    try:
        return platform.freedesktop_os_release()
    except OSError:
        return {}


def _short(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
