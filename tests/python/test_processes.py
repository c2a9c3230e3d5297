"""Threads, forks, interruption, and what is announced once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import softshadow as ss
from conftest import camera_above, compare, light_above, visibility

DEVICES = pytest.mark.parametrize("device", ["software", "native"])
BUSY = {"camera": camera_above((64, 64)), "technique": ss.RayTraced(samples=256)}


def test_other_threads_run_while_a_call_computes():
    scene = ss.scenes.load("hall").scene
    counted, stop = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.wait(0.0005):
            counted += 1

    thread = threading.Thread(target=count)
    seen = []
    thread.start()
    # A switch interval longer than the call: the other thread runs only if the interpreter is released.
    interval = sys.getswitchinterval()
    sys.setswitchinterval(100)
    try:
        before = counted
        visibility(scene, light_above(), camera=camera_above((64, 64)), technique=ss.RayTraced(samples=1024))
        seen.append(counted - before)
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
    assert seen[0] > 3


@DEVICES
def test_threads_share_a_scene_and_a_device(scene, device):
    expected = visibility(scene, light_above(), device=device, **BUSY).values
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: visibility(scene, light_above(), device=device, **BUSY).values, range(8)))
    for values in results:
        np.testing.assert_array_equal(values, expected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.parametrize("new_scene", [False, True])
@DEVICES
def test_a_forked_child_computes(scene, new_scene, device):
    expected = visibility(scene, light_above(), device=device, **BUSY).values
    child = os.fork()
    if child == 0:
        code = 1
        try:
            signal.alarm(20)
            again = ss.Scene(scene.meshes) if new_scene else scene
            values = visibility(again, light_above(), device=device, **BUSY).values
            code = 0 if np.array_equal(values, expected, equal_nan=True) else 2
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    np.testing.assert_array_equal(visibility(scene, light_above(), device=device, **BUSY).values, expected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@DEVICES
def test_a_forked_child_ends_although_the_device_was_its_parents(device):
    script = f"""
import os, signal, sys
import softshadow as ss
fork = ss.scenes.load("fork")
ss.visibility(fork.scene, fork.light, points=[[0, 0, 0]], device="{device}")
child = os.fork()
if child == 0:
    signal.alarm(30)
    sys.exit(7)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    assert subprocess.run([sys.executable, "-c", script], timeout=60, check=False).returncode == 7


def test_progress_counts_up_to_the_total(scene):
    seen = []
    visibility(
        scene,
        light_above(),
        camera=camera_above((64, 64)),
        memory_limit=50_000,
        progress=lambda *p: seen.append(p),
    )
    assert len(seen) > 2
    steps = [(done, total) for done, total, _ in seen]
    assert steps == sorted(steps)
    assert all(0 <= done <= total for done, total in steps)
    assert {(info["call"], info["technique"]) for *_, info in seen} == {("visibility", "ray_traced")}
    elapsed = [info["elapsed_ms"] for *_, info in seen]
    assert elapsed[0] > 0
    assert elapsed == sorted(elapsed)


def test_a_comparison_says_which_technique_is_at_work(scene):
    techniques, reference = [ss.RayTraced(samples=1), ss.HardShadowMap(resolution=64)], ss.DepthComplexity(samples=16)
    seen = []
    compare(
        scene,
        light_above(),
        camera=camera_above(),
        techniques=techniques,
        reference=reference,
        repeats=2,
        progress=lambda done, total, info: seen.append((done, total, info["call"], info["technique"])),
    )
    assert {total for _, total, *_ in seen} == {1 + 2 * (1 + 2)}
    assert {call for *_, call, _ in seen} == {"compare"}
    names = {done: name for done, *_, name in seen}
    rays, hard = "ray_traced", "hard_shadow_map"
    assert max(names) == 7, "the end is told, too"
    assert [names[done] for done in range(7)] == ["depth_complexity", rays, hard, rays, hard, rays, hard]


def test_a_progress_callback_stops_the_work(scene):
    settings = {"camera": camera_above((64, 64)), "memory_limit": 50_000}
    calls = []

    def stop(done: int, total: int, info: dict[str, object]) -> bool:
        calls.append(done)
        return False

    with pytest.raises(ss.Interrupted):
        visibility(scene, light_above(), progress=stop, **settings)
    assert len(calls) == 1
    with pytest.raises(ZeroDivisionError):
        visibility(scene, light_above(), progress=lambda *_: 1 / 0, **settings)
    assert visibility(scene, light_above(), **settings).values.shape == (64, 64)


def test_ctrl_c_is_heard_between_blocks(scene):
    def press(*_: object) -> None:
        signal.raise_signal(signal.SIGINT)

    # Whoever starts tests in the background may have told them to ignore the key.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            visibility(scene, light_above(), camera=camera_above((64, 64)), memory_limit=50_000, progress=press)
    finally:
        signal.signal(signal.SIGINT, handler)


def test_a_software_adapter_that_nobody_asked_for_is_announced_once():
    if ss.doctor().adapters[0]["device_type"] != "software":
        pytest.skip("this machine has a graphics card")
    script = """
import warnings
import softshadow as ss
fork = ss.scenes.load("fork")
rays, drawn = ss.RayTraced(samples=1), ss.HardShadowMap()
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    for technique, device in ((drawn, "software"), (rays, "auto"), (drawn, "auto"), (drawn, "auto")):
        result = ss.visibility(fork.scene, fork.light, points=[[0, 0, 0]], technique=technique, device=device)
        print(len(caught), result.info["adapter"]["device_type"], len(result.info["notes"]))
assert issubclass(caught[0].category, ss.SoftwareAdapterWarning)
assert "no graphics card" in str(caught[0].message)
assert caught[0].filename == "<string>"
"""
    environment = {name: value for name, value in os.environ.items() if name != "SOFTSHADOW_DEVICE"}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True, env=environment)
    assert done.stdout.split("\n")[:-1] == ["0 software 0", "0 native 0", "1 software 1", "1 software 1"]


def test_the_environment_chooses_the_device():
    script = "import softshadow as ss; print(ss.visibility(ss.Scene(), ss.SunLight(0, 45), points=[[0, 0, 0]]).info)"

    def run(device: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "SOFTSHADOW_DEVICE": device}
        return subprocess.run(
            [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, env=environment
        )

    assert "'device_type': 'native'" in run("native").stdout
    assert "'device_type': 'software'" in run("software").stdout
    assert "SOFTSHADOW_DEVICE: device 'toaster'" in run("toaster").stderr


def test_importing_needs_numpy_alone():
    script = """
import sys
import softshadow
print(sorted(sys.modules.keys() & {"trimesh", "PIL", "matplotlib", "scipy", "tqdm", "pdoc"}))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_is_warned_of_when_software_is_asked_for(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        visibility(scene, light_above(), points=[[0, 0, 0]])
