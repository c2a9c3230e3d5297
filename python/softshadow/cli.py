"""The command line: ``softshadow render``, ``softshadow visibility`` and ``softshadow doctor``."""

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
from .cli_values import parse_camera, parse_light, parse_size, parse_technique
from .device import quiet_driver
from .diagnosis import doctor
from .errors import SceneError, SettingsError, SoftShadowError, TooLargeError
from .files import FORMATS, output_format
from .framing import framed, lit_from_above
from .picture import Picture, render
from .scene_file import load
from .visibility import Visibility, visibility

_DEFAULT_SIZE = (640, 480)
_WRITABLE = ", ".join(f".{name}" for name in FORMATS)

_EPILOG = """\
SCENE is a .glb, .gltf, .obj, .ply or .stl file, a scene.json with lights and a camera, or the name of a shipped scene:
{names}. Options go before what a scene brings along.

FILE is a .png, .npy, .npz, .csv or .exr.

lights       rect:width=1,height=1,position=1.5/3.5/1,target=0/0.3/0   disc:radius=…   sphere:radius=…
             sun:azimuth=120,elevation=40,diameter=0.53,up=y           each with radiance=1/1/1
cameras      eye=2/2/3,target=0/0.4/0,fov=40,up=0/1/0
techniques   ray-traced:samples=64,seed=1      hard-shadow-map:resolution=2048
             depth-complexity:samples=64,exact_area=true,spread=interleaved,tile=4
             depth-complexity:evaluation=blended,counters=words   depth-complexity:unit=auto

Progress and remarks go to stderr; stdout has nothing, or with --json what made the result.
exit codes   0 done   1 the machine failed: no device, driver, memory   2 a mistake in the input: scene, options, files
             130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; 0 is success, 2 a mistake in the input, 1 a failure of the machine, 130 an interruption."""
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
        command.set_defaults(run=run)
        _add_common(command)
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
    command.add_argument("--technique", type=parse_technique, default="ray-traced", help="name and settings")
    command.add_argument("--device", default="auto", help="auto, gpu, native, software, or an index of doctor's")
    command.add_argument("--info", metavar="FILE", help="write what made the result, as JSON")
    command.add_argument("--json", action="store_true", help="print what made the result, as JSON")


def _render(options: argparse.Namespace) -> int:
    return _make(options, render)


def _visibility(options: argparse.Namespace) -> int:
    return _make(options, visibility)


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
    settings = {"technique": options.technique, "device": options.device, "progress": _say_progress}
    result: Picture | Visibility = make(scene, lights, camera=camera, **settings)
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
    for note in scene.notes:
        _say(f"note: {note}")
    return 0


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


def _say_progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)


def _say_warning(message: Warning | str, *_: object) -> None:
    _say(f"note: {message}")
