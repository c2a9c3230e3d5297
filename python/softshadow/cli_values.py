"""Lights, cameras, sizes and techniques as words of the command line."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from .camera import Camera, look_at
from .errors import SoftShadowError
from .lights import DiscLight, Light, RectLight, SphereLight, SunLight
from .techniques import TECHNIQUES, Technique

Readers = dict[str, Callable[[str], Any]]


def parse_size(text: str) -> tuple[int, int]:
    """``1024x768`` is (width, height)."""
    try:
        width, height = (int(number) for number in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': WIDTHxHEIGHT expected, such as 1024x768") from None
    return width, height


def _truth(text: str) -> bool:
    words = {"true": True, "false": False}
    if text not in words:
        raise ValueError(f"true or false expected, got '{text}'")
    return words[text]


def parse_technique(text: str) -> Technique:
    """``ray-traced:samples=64,seed=1``."""
    name, _, rest = text.partition(":")
    kind = TECHNIQUES.get(name.replace("-", "_"))
    if kind is None:
        known = ", ".join(known.replace("_", "-") for known in TECHNIQUES)
        raise argparse.ArgumentTypeError(f"unknown technique '{name}'; there are {known}")
    by_type = {"int": _whole, "float": _number, "bool": _truth}
    readers: Readers = {field.name: by_type.get(str(field.type), str) for field in fields(kind)}
    technique: Technique = _made(kind, **_settings(rest, readers))
    return technique


def parse_light(text: str) -> Light:
    """``rect:width=1,height=1,position=1.5/3.5/1,target=0/0.3/0``."""
    kind, _, rest = text.partition(":")
    if kind == "sun":
        settings = _settings(rest, _SUN, required=("azimuth", "elevation"))
        if "diameter" in settings:
            settings["diameter_deg"] = settings.pop("diameter")
        sun: Light = _made(SunLight, **settings)
        return sun
    sizes: dict[str, tuple[type[Light], tuple[str, ...]]] = {
        "rect": (RectLight, ("width", "height")),
        "disc": (DiscLight, ("radius",)),
        "sphere": (SphereLight, ("radius",)),
    }
    if kind not in sizes:
        raise argparse.ArgumentTypeError(f"unknown light '{kind}'; there are {', '.join(sizes)}, sun")
    light, lengths = sizes[kind]
    settings = _settings(rest, _PLACE | dict.fromkeys(lengths, _number), required=(*lengths, "position"))
    position, target = settings.pop("position"), settings.pop("target", (0.0, 0.0, 0.0))
    pose = _made(look_at, position, target, settings.pop("up", None))
    placed: Light = _made(light, world_from_light=pose, **settings)
    return placed


def parse_camera(text: str) -> Callable[[tuple[int, int]], Camera]:
    """``eye=2/2/3,target=0/0.4/0,fov=40``: a camera for any size of image."""
    settings = _settings(text, _CAMERA, required=("eye", "target"))
    fov_y_deg = settings.pop("fov", 40.0)
    return lambda size: Camera.look_at(**settings, fov_y_deg=fov_y_deg, size=size)


def _settings(text: str, readers: Readers, required: tuple[str, ...] = ()) -> dict[str, Any]:
    settings = {}
    for pair in filter(None, text.split(",")):
        name, _, value = pair.partition("=")
        if name not in readers:
            raise argparse.ArgumentTypeError(f"unknown '{name}'; there are {', '.join(readers)}")
        try:
            settings[name] = readers[name](value)
        except ValueError as error:
            raise argparse.ArgumentTypeError(f"{name}: {error}") from None
    if missing := [name for name in required if name not in settings]:
        raise argparse.ArgumentTypeError(f"'{text}' lacks {', '.join(missing)}")
    return settings


def _made(make: Any, *arguments: Any, **settings: Any) -> Any:
    try:
        return make(*arguments, **settings)
    except SoftShadowError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"a number expected, got '{text}'") from None


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"a whole number expected, got '{text}'") from None


def _vector(text: str) -> tuple[float, ...]:
    numbers = tuple(_number(part) for part in text.split("/"))
    if len(numbers) != 3:
        raise ValueError(f"three numbers such as 0/1/0 expected, got '{text}'")
    return numbers


_PLACE: Readers = {"position": _vector, "target": _vector, "up": _vector, "radiance": _vector}
_SUN: Readers = {
    "azimuth": _number,
    "elevation": _number,
    "diameter": _number,
    "up": str,
    "radiance": _vector,
}
_CAMERA: Readers = {"eye": _vector, "target": _vector, "up": _vector, "fov": _number}
