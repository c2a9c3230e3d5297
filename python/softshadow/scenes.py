"""Scenes that come with the library, each with the light and the camera that it is meant for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from . import _core
from .camera import Camera, look_at
from .checks import image_size, vector
from .errors import SceneError
from .lights import DiscLight, Light, RectLight, SphereLight, SunLight
from .scene import Scene


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ShippedScene:
    """A scene with the light and the camera that it is meant for. Y is up, lengths are metres.

    Attributes
    ----------
    name, description : str
        What it is called, and what it shows.
    scene : Scene
        Its meshes.
    light : light
        The light.
    camera : Camera
        The view.
    """

    name: str
    description: str
    scene: Scene
    light: Light
    camera: Camera

    def __repr__(self) -> str:
        return f"<ShippedScene {self.name!r}: {self.description}>"


def names() -> list[str]:
    """Names of the shipped scenes, sorted."""
    return _core.shipped_names()


def load(name: str) -> ShippedScene:
    """A shipped scene by its name.

    Parameters
    ----------
    name : str
        One of :func:`names`.

    Returns
    -------
    ShippedScene

    Raises
    ------
    SceneError
        For a name that is none of :func:`names`.
    """
    if not isinstance(name, str) or name not in names():
        raise SceneError(f"scene: one of {', '.join(names())} expected, got {name!r:.80}")
    source = _core.shipped_scene(name)
    view = source["camera"]
    camera = Camera.look_at(
        eye=view["eye"],
        target=view["target"],
        up=view["up"],
        fov_y_deg=view["fov_y_deg"],
        size=image_size(view["size"]),
    )
    return ShippedScene(
        name=name,
        description=source["description"],
        scene=Scene._from_core(source["scene"]),
        light=_light(source["light"]),
        camera=camera,
    )


def _light(source: _core._ShippedLight) -> Light:
    sizes, radiance = source["sizes"], vector("radiance", source["radiance"])
    if source["shape"] == "sun":
        east, height, south = (p - t for p, t in zip(source["position"], source["target"], strict=True))
        azimuth = math.degrees(math.atan2(east, -south))
        elevation = math.degrees(math.atan2(height, math.hypot(east, south)))
        return SunLight(azimuth, elevation, diameter_deg=sizes[0], radiance=radiance)
    pose = look_at(source["position"], source["target"], source["up"])
    if source["shape"] == "rectangle":
        return RectLight(width=sizes[0], height=sizes[1], world_from_light=pose, radiance=radiance)
    kind = DiscLight if source["shape"] == "disc" else SphereLight
    return kind(radius=sizes[0], world_from_light=pose, radiance=radiance)
