"""``softshadow compare``: techniques against a reference, as a report."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .cli_values import parse_camera, parse_light, parse_size, parse_technique
from .comparison import compare
from .device import context
from .errors import SettingsError
from .techniques import DepthComplexity, HardShadowMap, RayTraced, Technique

_SWEEP: tuple[Technique, ...] = (
    *(RayTraced(samples=samples) for samples in (4, 16, 64, 256)),
    *(DepthComplexity(samples=samples) for samples in (16, 64, 256)),
)
_REFERENCE = RayTraced(samples=256, passes=16, pattern="low_discrepancy", seed=99)


def usual_techniques(device: str) -> list[Technique]:
    """Every technique over its knob; a hard shadow map where the device draws."""
    draws = json.loads(context(device).adapter)["device_type"] != "native"
    return [*_SWEEP, *[HardShadowMap()] * draws]


def add_compare(command: argparse.ArgumentParser) -> None:
    """The options of ``softshadow compare``."""
    command.add_argument("scene", metavar="SCENE", help="a file or the name of a shipped scene")
    command.add_argument("-o", "--output", required=True, metavar="FOLDER", help="where index.html and the rest go")
    command.add_argument("--light", action="append", type=parse_light, help="default: the scene's own")
    command.add_argument("--camera", type=parse_camera, help="default: the scene's own, or all of it in view")
    command.add_argument("--size", type=parse_size, metavar="WxH", help="pixels; default: the camera's own")
    command.add_argument(
        "--technique", action="append", type=parse_technique, help="may be repeated; default: each over its samples"
    )
    command.add_argument(
        "--reference", type=parse_technique, default=_REFERENCE, help="what errors are measured against"
    )
    command.add_argument("--repeats", type=int, default=5, metavar="N", help="timed runs of each; default: %(default)s")
    command.add_argument(
        "--lines",
        action="append",
        default=[],
        metavar="FILE",
        help="JSON lines of softshadow-bench --ratios, or of python -m softshadow.bench.peers; may be repeated",
    )
    command.add_argument("--device", default="auto", help="auto, gpu, native, software, or an index of doctor's")
    command.add_argument("--json", action="store_true", help="print all numbers as JSON")


def run_compare(
    options: argparse.Namespace, scene: Any, lights: Any, camera: Any, say: Callable[[str], None], progress: Any
) -> int:
    """Measures, writes the report and says where it is."""
    from .report import Report, read_lines

    if isinstance(lights, list):
        raise SettingsError(f"{options.scene}: compare takes one light, not {len(lights)}; choose it with --light")
    if Path(options.output).is_file():
        raise SettingsError(f"{options.output}: a folder expected, this is a file")
    lines = [line for path in options.lines for line in read_lines(path)]
    comparison = compare(
        scene,
        lights,
        camera=camera,
        techniques=options.technique or usual_techniques(options.device),
        reference=options.reference,
        repeats=options.repeats,
        name=Path(options.scene).stem,
        device=options.device,
        progress=progress,
    )
    report = Report([comparison], lines=lines, title=f"Speed against error: {comparison.name}")
    report.save(options.output)
    if options.json:
        print(json.dumps(report.to_dict(), indent=2))
    say(str(comparison))
    say(f"page {Path(options.output) / 'index.html'}")
    for note in scene.notes:
        say(f"note: {note}")
    return 0
