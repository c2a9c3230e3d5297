"""What runs where on this machine: a tiny call of every technique on every backend, tried and not assumed."""

from __future__ import annotations

import importlib.util
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .camera import Camera, look_at
from .errors import GpuError, SoftShadowError
from .lights import RectLight
from .scene import Mesh, Scene
from .techniques import TECHNIQUES, DepthComplexity, RayTraced, Technique
from .visibility import visibility

_BLENDED = {"evaluation": "blended"}
_SIZE = (24, 24)
# A mean visibility that is farther off than this was not computed by who says so: a hard shadow is off by 0.01, and a
# penumbra map, which knows the outer half of every penumbra alone, by 0.05.
_FARTHEST_MEAN = 0.07

Call = Callable[[Technique], NDArray[np.float32]]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What one technique did on one backend.

    Attributes
    ----------
    technique : str
        Its name, with the settings that were changed, as the command line has them.
    backend : str
        ``native``, the interface of an adapter and its index, or ``wgpu-py`` and an interface.
    ms : float or None
        Time of a warm call; None where it failed.
    error, says : str or None
        The class of what was raised, and its words; ``WrongValues`` where something else was computed than rays see.
    """

    technique: str
    backend: str
    ms: float | None = None
    error: str | None = None
    says: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return asdict(self)


def variants() -> dict[str, Technique]:
    """Every technique, with few samples, and the evaluations that ask devices for something else."""
    made = [_small(kind) for kind in TECHNIQUES.values()]
    made += [_small(DepthComplexity, **_BLENDED), _small(DepthComplexity, **_BLENDED, counters="float")]
    return {_named(technique): technique for technique in made}


def matrix() -> list[Trial]:
    """Tries every technique on every backend; takes some seconds, as all kernels are compiled."""
    return _tried(_backends()) + _by_wgpu()


def tried_on_wgpu() -> list[Trial]:
    """Tries every technique on wgpu-py, in this process."""
    return _tried(_wgpu_backends())


def _tried(opening: dict[str, Callable[[], Call]]) -> list[Trial]:
    wanted = _lit(_on("native")(RayTraced(samples=64)))
    tried = []
    for backend, open_call in opening.items():
        try:
            call = open_call()
        except Exception as error:
            tried += [_failed(name, backend, error) for name in variants()]
            continue
        tried += [_try(name, backend, call, technique, wanted) for name, technique in variants().items()]
    return tried


def _by_wgpu() -> list[Trial]:
    """As :func:`tried_on_wgpu`, in a process of its own: two libraries that open GL in one may end it."""
    if importlib.util.find_spec("wgpu") is None:
        return []
    done = subprocess.run([sys.executable, "-c", _CHILD], capture_output=True, text=True)
    if done.returncode != 0:
        ended = GpuError(f"wgpu-py ended its process with {done.returncode}")
        return [_failed(name, "wgpu-py", ended) for name in variants()]
    return [Trial(**row) for row in json.loads(done.stdout.splitlines()[-1])]


_CHILD = """
import json
from softshadow import backends
trials = json.dumps([trial.to_dict() for trial in backends.tried_on_wgpu()])
print()
print(trials)
"""


def table(trials: list[Trial]) -> list[str]:
    """The trials as lines of text, and the words of what failed below."""
    backends = list(dict.fromkeys(trial.backend for trial in trials))
    names = list(dict.fromkeys(trial.technique for trial in trials))
    cells = {(trial.technique, trial.backend): trial for trial in trials}
    shown = [[_cell(cells[name, backend]) for backend in backends] for name in names]
    width = max(len(name) for name in names)
    widths = [max(len(backend), *(len(row[i]) for row in shown)) for i, backend in enumerate(backends)]
    lines = [(name, row) for name, row in zip(["technique", *names], [backends, *shown], strict=True)]
    text = [
        f"{name:{width}}  " + "  ".join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True)) for name, row in lines
    ]
    words = dict.fromkeys(f"    {trial.says}" for trial in trials if trial.says)
    return [*(line.rstrip() for line in text), *words]


def _small(kind: type[Technique], **changed: Any) -> Technique:
    known = {field.name for field in fields(kind)}
    small = {"samples": 16, "resolution": 64}
    return kind(**{name: value for name, value in small.items() if name in known}, **changed)


def _named(technique: Technique) -> str:
    least = asdict(_small(type(technique)))
    changed = ",".join(f"{name}={value}" for name, value in asdict(technique).items() if value != least[name])
    return technique.name + (f":{changed}" if changed else "")


def _backends() -> dict[str, Callable[[], Call]]:
    found: dict[str, Callable[[], Call]] = {"native": partial(_on, "native")}
    for index, adapter in enumerate(json.loads(_core.adapters())):
        found[f"{adapter['backend']} {index}"] = partial(_on, index)
    return found


def _wgpu_backends() -> dict[str, Callable[[], Call]]:
    import wgpu

    from .wgpu import Host

    def opened(adapter: Any) -> Call:
        features = [name for name in ("float32-blendable",) if name in adapter.features]
        host = Host(adapter.request_device_sync(required_features=features))
        return lambda technique: host.visibility(_SCENE, _LIGHT, camera=_CAMERA, technique=technique).read()

    # Through GL, wgpu-py is not supported by its makers.
    found = [a for a in wgpu.gpu.enumerate_adapters_sync() if a.info["backend_type"] != "OpenGL"]
    return {f"wgpu-py {a.info['backend_type'].lower()}": partial(opened, a) for a in reversed(found)}


def _on(device: Any) -> Call:
    def call(technique: Technique) -> NDArray[np.float32]:
        seen = visibility(_SCENE, _LIGHT, camera=_CAMERA, technique=technique, device=device, standard_error=False)
        return np.asarray(seen.values)

    return call


def _try(name: str, backend: str, call: Call, technique: Technique, wanted: float) -> Trial:
    try:
        call(technique)
        started = time.perf_counter()
        values = call(technique)
        ms = (time.perf_counter() - started) * 1e3
    except Exception as error:
        return _failed(name, backend, error)
    lit = _lit(values)
    if not abs(lit - wanted) <= _FARTHEST_MEAN:
        says = f"{name} on {backend}: a mean visibility of {lit:.3f}, where rays see {wanted:.3f}"
        return Trial(technique=name, backend=backend, error="WrongValues", says=says)
    return Trial(technique=name, backend=backend, ms=ms)


def _failed(name: str, backend: str, error: Exception) -> Trial:
    words = str(error) if isinstance(error, SoftShadowError) else f"{type(error).__name__}: {error}"
    return Trial(technique=name, backend=backend, error=type(error).__name__, says=words)


def _lit(values: NDArray[np.float32]) -> float:
    # Every pixel sees the floor or the box.
    return float(values.mean(dtype=np.float64)) if values.shape == _SIZE[::-1] else math.nan


def _cell(trial: Trial) -> str:
    return f"{trial.ms:.0f} ms" if trial.ms is not None else str(trial.error)


def _box() -> Scene:
    floor = np.array([[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]], dtype=np.float64)
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0.4, 0.8) for z in (-0.3, 0.4)], dtype=np.float64)
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([[a, b, c] for a, b, c, _ in sides] + [[a, c, d] for a, _, c, d in sides], dtype=np.uint32)
    flat = np.array([[0, 2, 1], [0, 3, 2]], dtype=np.uint32)
    return Scene([Mesh(name="floor", vertices=floor, faces=flat), Mesh(name="box", vertices=corners, faces=faces)])


_SCENE = _box()
_LIGHT = RectLight(width=0.8, height=0.6, world_from_light=look_at((0.5, 3.0, 0.3), (0, 0, 0)))
_CAMERA = Camera.look_at(eye=(1.2, 3.0, 2.0), target=(0, 0.2, 0), fov_y_deg=40, size=_SIZE)
