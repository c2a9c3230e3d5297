"""The command line: ``softshadow render``, ``visibility``, ``compare``, ``gallery`` and ``doctor``."""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import __version__, scenes
from .camera import Camera
from .cli_compare import add_compare, run_compare
from .cli_values import parse_camera, parse_light, parse_size, parse_technique
from .device import quiet_driver
from .diagnosis import doctor
from .errors import BoundNotMet, SceneError, SettingsError, SoftShadowError, TooLargeError
from .files import FORMATS, output_format
from .framing import framed, lit_from_above
from .gallery import EXHIBITS, Exhibit, Studio, make
from .picture import Picture, render
from .scene_file import load
from .visibility import Visibility, visibility

_DEFAULT_SIZE = (640, 480)
_WRITABLE = ", ".join(f".{name}" for name in FORMATS)

_EPILOG = """\
SCENE is a .glb, .gltf, .obj, .ply or .stl file, a scene.json with lights and a camera, or the name of a shipped scene:
{names}. Options go before what a scene brings along.

FILE is a .png, .npy, .npz, .csv or .exr. FOLDER is made where there is none.

lights       rect:width=1,height=1,position=1.5/3.5/1,target=0/0.3/0   disc:radius=…   sphere:radius=…
             sun:azimuth=120,elevation=40,diameter=0.53,up=y           each with radiance=1/1/1
cameras      eye=2/2/3,target=0/0.4/0,fov=40,up=0/1/0
techniques   ray-traced:samples=64,seed=1      hard-shadow-map:resolution=2048
             penumbra-map:resolution=1024,ramp=light       occlusion-camera:steps=3,bias=0.25,ramp=outline
             depth-complexity:samples=64,exact_area=true,spread=interleaved,tile=4
             depth-complexity:evaluation=blended,counters=words   depth-complexity:unit=auto

Progress and remarks go to stderr; stdout has nothing, or with --json what made the result.
exit codes   0 done   1 the machine failed: no device, driver, memory   2 a mistake in the input: scene, options, files
             3 the error or time that was asked for is not kept; the best result is written   130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; 0 is success, 1 a failure of the machine, 2 a mistake in the input, 3 a bound that is not met."""
    options = _parser().parse_args(arguments)
    quiet_driver()
    try:
        with warnings.catch_warnings():
            setattr(warnings, "showwarning", _say_warning)  # noqa: B010 - its type leaves no room for *_
            result: int = options.run(options)
            return result
    except (SceneError, SettingsError, TooLargeError, OSError) as error:
        _say(f"error: {error}")
        return 2
    except (SoftShadowError, MemoryError) as error:
        _say(f"error: {error}")
        return 1
    except KeyboardInterrupt:
        _say("interrupted")
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="softshadow", description="Soft shadows from area lights.")
    parser.add_argument("--version", action="version", version=f"softshadow {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, run, words in (
        ("render", _render, f"make a picture ({_WRITABLE})"),
        ("visibility", _visibility, f"make a visibility map ({_WRITABLE})"),
    ):
        command = commands.add_parser(
            name,
            help=words,
            description=words,
            epilog=_EPILOG.format(names=", ".join(scenes.names())),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.set_defaults(run=run, max_error=None, max_ms=None)
        _add_common(command)
        if run is _visibility:
            _add_goal(command)
    gallery_command = commands.add_parser("gallery", help="make pictures side by side of what the techniques do")
    gallery_command.add_argument(
        "exhibits", nargs="*", metavar="EXHIBIT", help=f"default: all of {', '.join(EXHIBITS)}"
    )
    gallery_command.add_argument("-o", "--output", default="gallery", metavar="FOLDER", help="default: %(default)s")
    gallery_command.add_argument("--size", type=parse_size, default=Studio.size, metavar="WxH", help="of a picture")
    _add_device_and_json(gallery_command)
    gallery_command.set_defaults(run=_gallery)
    compare_command = commands.add_parser(
        "compare",
        help="measure techniques against a reference: a page, numbers and fronts",
        description="measure techniques against a reference, and write a page that stands alone, numbers and fronts",
        epilog=_EPILOG.format(names=", ".join(scenes.names())),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_compare(compare_command)
    compare_command.set_defaults(run=_compare)
    doctor_command = commands.add_parser("doctor", help="show adapters, what is missing, and what runs where")
    doctor_command.add_argument("--quick", action="store_true", help="try no technique, which takes some seconds")
    doctor_command.add_argument("--json", action="store_true", help="print JSON")
    doctor_command.set_defaults(run=_doctor)
    return parser


def _add_common(command: argparse.ArgumentParser) -> None:
    command.add_argument("scene", metavar="SCENE", help="a file or the name of a shipped scene")
    command.add_argument("-o", "--output", required=True, metavar="FILE", help="what to write")
    command.add_argument("--light", action="append", type=parse_light, help="may be repeated; default: the scene's own")
    command.add_argument("--camera", type=parse_camera, help="default: the scene's own, or all of it in view")
    command.add_argument("--size", type=parse_size, metavar="WxH", help="pixels; default: the camera's own")
    command.add_argument("--technique", type=parse_technique, help="name and settings; default: ray-traced")
    command.add_argument("--info", metavar="FILE", help="write what made the result, as JSON")
    _add_device_and_json(command)


def _add_device_and_json(command: argparse.ArgumentParser) -> None:
    command.add_argument("--device", default="auto", help="auto, gpu, native, software, or an index of doctor's")
    command.add_argument("--json", action="store_true", help="print what made the result, as JSON")


def _add_goal(command: argparse.ArgumentParser) -> None:
    goal = command.add_argument_group("instead of a technique, which is then chosen")
    goal.add_argument("--max-error", type=float, metavar="E", help="the fastest that keeps this error")
    goal.add_argument("--max-ms", type=float, metavar="MS", help="the smallest error within so many milliseconds")
    goal.add_argument("--error-norm", default="rmse", metavar="NORM", help="rmse (default), p99 or max")


def _render(options: argparse.Namespace) -> int:
    return _make(options, render)


def _visibility(options: argparse.Namespace) -> int:
    return _make(options, visibility)


def _gallery(options: argparse.Namespace) -> int:
    if unknown := [name for name in options.exhibits if name not in EXHIBITS]:
        raise SettingsError(f"unknown exhibit {unknown[0]!r}; there are {', '.join(EXHIBITS)}")
    studio = Studio(size=options.size, device=options.device)
    made = make(Path(options.output), options.exhibits, studio, _say_exhibit)
    if options.json:
        print(json.dumps(made, indent=2))
    _say(f"page {made['page']}, on {made['device']}")
    return 0


def _compare(options: argparse.Namespace) -> int:
    scene, lights, camera = _scene_lights_camera(options)
    return run_compare(options, scene, lights, camera, _say, _say_progress)


def _doctor(options: argparse.Namespace) -> int:
    found = doctor(measure=not options.quick)
    print(json.dumps(found.to_dict(), indent=2) if options.json else found)
    return 0


def _make(options: argparse.Namespace, make: Any) -> int:
    _check_output(options.output)
    scene, lights, camera = _scene_lights_camera(options)
    if make is visibility and isinstance(lights, list) and output_format(options.output) == "png":
        several = f"one for each of {len(lights)} lights"
        raise SettingsError(
            f"{options.output}: a PNG holds one grey image, not {several}; use another format or --light"
        )
    settings = {"device": options.device, "progress": _say_progress}
    settings |= {} if options.technique is None else {"technique": options.technique}
    if options.max_error is not None or options.max_ms is not None:
        settings |= {name: getattr(options, name) for name in ("max_error", "max_ms", "error_norm")}
    unmet: BoundNotMet | None = None
    result: Picture | Visibility
    try:
        result = make(scene, lights, camera=camera, **settings)
    except BoundNotMet as error:
        if error.best is None:
            raise
        unmet, result = error, error.best
    result.save(options.output)
    info = {"output": str(options.output), "size": list(camera.size), **result.info}
    text = json.dumps(info, indent=2)
    if options.info:
        Path(options.info).write_text(text + "\n", encoding="utf-8")
    if options.json:
        print(text)
    width, height = camera.size
    technique, adapter = info["technique"]["name"], info["adapter"]["name"]
    _say(f"{options.output}: {width} × {height}, {technique}, {info['wall_ms']:.1f} ms on {adapter}")
    if choice := info.get("choice"):
        _say(told(choice))
    for note in scene.notes:
        _say(f"note: {note}")
    if unmet is not None:
        _say(f"not met: {unmet}")
        return 3
    return 0


def told(choice: dict[str, Any]) -> str:
    """How a result was chosen and what it reaches, in a line."""
    known = choice["error"]
    if known is None:
        return f"error certified; pilot: {choice['pilot']}"
    norm, upper = choice["norm"], known["upper"]
    sure = f"{known['confidence']:.0%} sure"
    bound = f"at most {upper:.4g}, {sure}" if upper is not None else f"{known['exceeding_share']:.2%} beyond, {sure}"
    spent = f"pilot {choice['pilot_ms']:.1f} ms, check {choice['check_ms']:.1f} ms"
    return f"{norm} {known['estimate']:.4g} ({bound}; {choice['kind']}, {known['receivers']} receivers); {spent}"


def _scene_lights_camera(options: argparse.Namespace) -> Any:
    camera: Camera | None
    if options.scene in scenes.names() and not Path(options.scene).exists():
        shipped = scenes.load(options.scene)
        scene, own_lights, camera = shipped.scene, [shipped.light], shipped.camera
    else:
        if not Path(options.scene).suffix:
            names = ", ".join(scenes.names())
            raise SceneError(f"{options.scene}: neither a file nor a shipped scene ({names})")
        file = load(options.scene)
        scene, own_lights, camera = file.scene, list(file.lights), file.camera
    if options.camera is not None:
        camera = options.camera(options.size or (camera.size if camera else _DEFAULT_SIZE))
    elif camera is None:
        camera = framed(scene, options.size or _DEFAULT_SIZE)
    elif options.size is not None:
        camera = type(camera)(world_from_camera=camera.world_from_camera, fov_y_deg=camera.fov_y_deg, size=options.size)
    lights = options.light or own_lights or [lit_from_above(scene)]
    return scene, lights[0] if len(lights) == 1 else lights, camera


def _check_output(path: str) -> None:
    """Raises before any work is done where its result could not be written."""
    output_format(path)
    if not Path(path).resolve().parent.is_dir():
        raise SettingsError(f"{path}: there is no such folder")


def _say(text: str) -> None:
    print(text, file=sys.stderr)


def _say_exhibit(exhibit: Exhibit, seconds: float) -> None:
    measured = "; ".join(f"{panel.name}: {panel.numbers}" for panel in exhibit.panels if panel.numbers)
    _say(f"{exhibit.name}, {seconds:.1f} s: {measured}")


def _say_progress(done: int, total: int, _: object) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)


def _say_warning(message: Warning | str, *_: object) -> None:
    _say(f"note: {message}")
