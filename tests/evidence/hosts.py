"""Sections of the report about hosts: one plan on wgpu-py, Vulkan and GL; memory of many calls; what a host costs."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import wgpu

import softshadow as ss
from softshadow import backends
from softshadow.techniques import TECHNIQUES
from softshadow.wgpu import Host

DATA = json.loads((Path(__file__).parents[1] / "backends.json").read_text())
SCENES = ("hall", "toruses", "fork")
MOST_RATIO = 1.2
# Of resident memory, between the halves of the calls; 1 KiB that leaked in each would be 5 MiB.
MOST_GROWTH_MIB = 4.0
BLENDED = ss.DepthComplexity(samples=64, evaluation="blended")
# Mesa's lavapipe 22.3 makes another shader of a kernel whose loops end by a uniform, at every call, and keeps it: some
# 1 MiB a call, whoever calls. So there only what has no such kernel is told apart from a leak; on GL everything is.
SERVED = {
    "own engine, Vulkan": ("own", "vulkan", "hard_shadow_map"),
    "wgpu-py, Vulkan": ("wgpu-py", "vulkan", "hard_shadow_map"),
    "own engine, GL": ("own", "gl", "ray_traced,hard_shadow_map,depth_complexity"),
}
CALLS = """
import sys
from dataclasses import replace
import softshadow as ss
_, host, backend, names, count = sys.argv
hall = ss.scenes.load("toruses")
camera = replace(hall.camera, size=(8, 6))
small = [ss.RayTraced(samples=4), ss.HardShadowMap(resolution=16), ss.DepthComplexity(samples=4)]
techniques = [technique for technique in small if technique.name in names.split(",")]
device = next(i for i, adapter in enumerate(ss.doctor().adapters) if adapter["backend"] == backend)
if host == "wgpu-py":
    import hosts
    call = hosts.host().visibility
else:
    def call(*args, **options):
        return ss.visibility(*args, **options, device=device)
for i in range(int(count)):
    light = ss.RectLight(width=1.0, height=1.0, world_from_light=ss.look_at((0.1 + i * 1e-5, 3.0, 0.2), (0, 0, 0)))
    call(hall.scene, light, camera=camera, technique=techniques[i % len(techniques)])
    if 10 * (i + 1) % int(count) == 0:
        print(int(open("/proc/self/statm").read().split()[1]) * 4 / 1024, flush=True)
"""


@functools.cache
def host() -> Host:
    """A host on software Vulkan, through wgpu-py; only one: looking for adapters when others opened GL may abort."""
    found = [a for a in wgpu.gpu.enumerate_adapters_sync() if a.info["backend_type"] == "Vulkan"]
    software = [a for a in found if a.info["adapter_type"] == "CPU"]
    return Host(software[0].request_device_sync(required_features=["float32-blendable"]))


def variants() -> dict[str, ss.Technique]:
    """Every technique by its defaults, and the evaluations that have passes of other kinds."""
    made = {kind.name: kind() for kind in TECHNIQUES.values()}
    made |= {
        "ray_traced, 16 probes": ss.RayTraced(samples=64, probes=16, passes=2),
        "ray_traced, interleaved": ss.RayTraced(samples=16, spread="interleaved"),
        "depth_complexity, triangles": ss.DepthComplexity(unit="triangles"),
        "depth_complexity, blended": BLENDED,
        "depth_complexity, blended, shadow volumes": replace(BLENDED, initial_counts="z_fail"),
        "depth_complexity, blended, float": replace(BLENDED, counters="float"),
    }
    return made


def same_bits() -> tuple[list[str], bool]:
    """The own engine and wgpu-py, both on Vulkan: bit by bit."""
    theirs, passed = host(), True
    table = ["| technique | " + " | ".join(SCENES) + " |", "|---|" + "---|" * len(SCENES)]
    for name, technique in variants().items():
        cells = []
        for scene_name in SCENES:
            shown = ss.scenes.load(scene_name)
            call = {"camera": replace(shown.camera, size=(160, 120)), "technique": technique}
            ours = ss.visibility(shown.scene, shown.light, **call, device="software")
            values = theirs.visibility(shown.scene, shown.light, **call).read()
            differing = int((ours.values.view(np.uint32) != values.view(np.uint32))[ours.valid].sum())
            # A comparison that cannot tell one receiver from its neighbour proves nothing.
            told = bool((np.roll(values, 1) != ours.values)[ours.valid].any())
            passed &= differing == 0 and told
            cells.append(f"{differing} of {int(ours.valid.sum()):,}")
        table.append(f"| {name} | " + " | ".join(cells) + " |")
    text = (
        "Receivers whose visibility differs in any bit between the own engine and wgpu-py, both on the software driver."
    )
    return [text, "", *table, ""], passed


def vulkan_and_gl() -> tuple[list[str], bool]:
    """One machine, two interfaces, within the tolerance that tests/backends.json states."""
    index = {adapter["backend"]: str(i) for i, adapter in enumerate(ss.doctor().adapters)}
    if not {"vulkan", "gl"} <= set(index):
        return ["Skipped: needs both a Vulkan and a GL adapter.", ""], False
    limits, passed = DATA["vulkan_and_gl"], True
    table = ["| technique | tolerance | receivers beyond it | at most |", "|---|---|---|---|"]
    shown = ss.scenes.load("hall")
    for name, technique in variants().items():
        call = {"camera": replace(shown.camera, size=(160, 120)), "technique": technique}
        tolerance = limits["tolerance"].get(technique.name, 1e-6)
        try:
            values = [
                np.nan_to_num(ss.visibility(shown.scene, shown.light, **call, device=int(index[b])).values, nan=-1.0)
                for b in ("vulkan", "gl")
            ]
        except ss.SettingsError as error:
            passed &= any(row["says"] in str(error) for row in DATA["expected_failures"] if "gl" in row["backends"])
            table.append(f"| {name} | {tolerance:g} | {error} | |")
            continue
        beyond = int((np.abs(values[0] - values[1]) > tolerance).sum())
        most = int(limits["differing_share"] * values[0].size)
        passed &= beyond <= most
        table.append(f"| {name} | {tolerance:g} | {beyond} of {values[0].size:,} | {most} |")
    return [*table, ""], passed


def tried() -> tuple[list[str], bool]:
    """The matrix of ``softshadow doctor``."""
    return ["```", *backends.table(backends.matrix()), "```", ""], True


def memory(calls: int) -> tuple[list[str], bool]:
    """Resident memory while one device serves many calls, each with a light in another place."""
    table, passed = ["| host | techniques | calls | MiB after each tenth of them |", "|---|---|---|---|"], True
    for name, served in SERVED.items():
        command = [sys.executable, "-c", CALLS, *served, str(calls)]
        done = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True, check=True)
        sizes = [float(line) for line in done.stdout.split()]
        # What is in flight comes and goes: the largest of each half are compared.
        passed &= len(sizes) == 10 and max(sizes[5:]) - max(sizes[:5]) <= MOST_GROWTH_MIB
        shown = served[2].replace(",", ", ")
        table.append(f"| {name} | {shown} | {calls:,} | {', '.join(f'{size:.1f}' for size in sizes)} |")
    text = (
        f"Growth from one half to the other: at most {MOST_GROWTH_MIB:g} MiB. On Vulkan only `hard_shadow_map`: Mesa's "
        "lavapipe 22.3 itself keeps about 1 MiB of every call to a kernel whose loops end by a uniform, on both hosts."
    )
    return [text, "", *table, ""], passed


def overhead(rounds: int) -> tuple[list[str], bool]:
    """The same plans at 512 × 512, taking turns: what wgpu-py costs."""
    theirs, passed = host(), True
    shown = ss.scenes.load("fork")
    table = ["| technique | own engine, ms | wgpu-py, ms | ratio | of processor time |", "|---|---|---|---|---|"]
    for name, technique in variants().items():
        call = {"camera": replace(shown.camera, size=(512, 512)), "technique": technique}

        def ours(call: dict = call) -> None:
            ss.visibility(shown.scene, shown.light, **call, device="software", standard_error=False)

        def others(call: dict = call) -> None:
            theirs.visibility(shown.scene, shown.light, **call).read()

        taken: dict = {ours: [], others: []}
        for _ in range(rounds + 1):
            for run, times in taken.items():
                wall, processor = time.perf_counter(), time.process_time()
                run()
                times.append(((time.perf_counter() - wall) * 1e3, time.process_time() - processor))
        # The first turn compiles kernels. Of the others the fastest counts: whatever else the machine does only adds.
        own, other = (np.min(times[1:], axis=0) for times in taken.values())
        passed &= bool(other[0] <= MOST_RATIO * own[0])
        ratios = " | ".join(f"{ratio:.2f}" for ratio in other / own)
        table.append(f"| {name} | {own[0]:.0f} | {other[0]:.0f} | {ratios} |")
    text = (
        f"Whole calls from Python, values copied to the processor on both; the fastest of {rounds} turns. A ratio of "
        f"at most {MOST_RATIO:g} is allowed."
    )
    return [text, "", *table, ""], passed


SECTIONS = {
    "Hosts: the same bits": same_bits,
    "Hosts: Vulkan and GL": vulkan_and_gl,
    "Hosts: what runs where": tried,
    "Hosts: memory of ten thousand calls": lambda: memory(10_000),
    "Hosts: what wgpu-py costs": lambda: overhead(7),
}

if __name__ == "__main__":
    all_passed = True
    for title, make in SECTIONS.items():
        if len(sys.argv) == 1 or any(title.endswith(word) for word in sys.argv[1:]):
            lines, ok = make()
            all_passed &= ok
            print("\n".join([f"## {title}", "", *lines, "" if ok else "FAILED", ""]), flush=True)
    sys.exit(0 if all_passed else 1)
