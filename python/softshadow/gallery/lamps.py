"""Exhibits of lights: their shapes and textures."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from softshadow.camera import Camera, look_at
from softshadow.lights import DiscLight, Light, PolygonLight, RectLight, SphereLight, SunLight
from softshadow.scene import Mesh, Scene
from softshadow.techniques import DepthComplexity

from . import colors, props
from .exhibit import Exhibit, Panel
from .studio import Studio, View, difference

_KNOWN = "The references' own standard errors in the penumbra are up to {:.4f}."
_LIGHT_HEIGHT, _PLATE_HEIGHT = 4.0, 1.6


def shapes(studio: Studio) -> Exhibit:
    """Under a plate with holes, each a pinhole camera, and lights of one area."""
    scene = Scene([props.floor(12), _plate_with_holes()])
    camera = Camera.look_at(eye=(0.1, 1.55, 1.3), target=(0.1, 0, 0), fov_y_deg=60, size=studio.size)
    panels, known = [], []
    for name, caption, light in _lights_above(_LIGHT_HEIGHT, area=0.5):
        view = View(scene=scene, light=light, camera=camera, exposure=1.5, shading="modulated")
        truth = studio.reference(view, share=2)
        panels.append(studio.panel(name, caption, view, DepthComplexity(samples=256), truth))
        known.append(truth.standard_error)
    return Exhibit(
        name="shapes",
        title="Shapes of lights",
        look="Three square holes in a plate over the floor: the smaller the hole, the more it draws the light, a star "
        "upside down, instead of itself.",
        panels=tuple(panels),
        notes=(_KNOWN.format(max(known)),),
    )


def textures(studio: Studio) -> Exhibit:
    """Stained glass, and two moments of a fire."""
    posts = [(-0.7, 0.2), (-0.25, -0.15), (0.2, 0.25), (0.65, -0.1)]
    lower = [(x - 0.06, 0.0, z - 0.06) for x, z in posts]
    upper = [(x + 0.06, 0.75, z + 0.06) for x, z in posts]
    light = RectLight(
        width=1.6,
        height=1.2,
        world_from_light=look_at((0, 1.3, -2.2), (0, 0, 0.6)),
        radiance=props.radiance(1.7, 1.6 * 1.2),
    )
    view = View(
        scene=Scene([props.floor(12, (0.8, 0.8, 0.8)), props.boxes("posts", lower, upper, (0.5, 0.5, 0.5))]),
        light=light,
        camera=Camera.look_at(eye=(0, 2.6, 3.2), target=(0, 0.0, 0.45), fov_y_deg=30, size=studio.size),
        exposure=1.5,
    )
    stained = np.eye(3, dtype=np.float32)[None]
    sources = {"stained": stained, "fire_0": props.flame(0.0), "fire_1": props.flame(0.5)}
    captions = {"stained": "red, green and blue glass", "fire_0": "a fire", "fire_1": "half a beat later"}
    lamps = [
        Panel(name=f"{name}_texture", caption=f"the light: {captions[name]}", image=_shown(texture, studio.size))
        for name, texture in sources.items()
    ]
    shots, known = [], []
    for name, texture in sources.items():
        # Most of a fire is dark, and two thirds of coloured glass.
        lit = replace(view, light=replace(light, texture=texture), exposure=3.0)
        truth = studio.reference(lit)
        known.append(truth.standard_error)
        shots.append(studio.panel(name, captions[name], lit, DepthComplexity(samples=256), truth))
    white = studio.panel("white", "the same light in white", view, DepthComplexity(samples=256))
    return Exhibit(
        name="textures",
        title="Lights with textures",
        look="A post that hides the red pane leaves green and blue: shadows take the colours of what is still seen, "
        "and those of a fire sway with it.",
        panels=(*lamps, *shots, white, difference(shots[2], shots[1], 0.5)),
        notes=(_KNOWN.format(max(known)),),
    )


def _lights_above(height: float, area: float) -> list[tuple[str, str, Light]]:
    pose = look_at((0, height, 0), (0, 0, 0), (0, 0, -1))
    glow = props.radiance(height, area)
    radius = math.sqrt(area / math.pi)
    # As wide as the disc is, seen from the plate.
    across = 2 * math.degrees(math.atan(radius / (height - _PLATE_HEIGHT)))
    side = math.sqrt(area / 2)
    return [
        ("rectangle", "rectangle", RectLight(width=2 * side, height=side, world_from_light=pose, radiance=glow)),
        ("disc", "disc", DiscLight(radius=radius, world_from_light=pose, radiance=glow)),
        ("sphere", "ball", SphereLight(radius=radius, world_from_light=pose, radiance=glow)),
        ("polygon", "polygon", PolygonLight(outline=_star(area), world_from_light=pose, radiance=glow)),
        (
            "sun",
            f"sun of {across:.0f} degrees",
            SunLight(0, 90, diameter_deg=across, radiance=props.radiance(height - _PLATE_HEIGHT, area)),
        ),
    ]


def _star(area: float, spikes: int = 5) -> NDArray[np.float64]:
    turns = math.pi / 2 + np.arange(2 * spikes) * (math.pi / spikes)
    radii = np.where(np.arange(2 * spikes) % 2 == 0, 1.0, 0.4)
    x, y = radii * np.cos(turns), radii * np.sin(turns)
    size = 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return np.stack([x, y], axis=-1) * math.sqrt(area / size)


def _plate_with_holes(side: float = 8.0) -> Mesh:
    """A level grid of rectangles whose corners meet, without those in three square holes."""
    middles, halves = np.array([-0.62, -0.12, 0.5]), np.array([0.045, 0.08, 0.18])
    border = [-side / 2, side / 2]
    x = np.sort(np.concatenate([middles - halves, middles + halves, border]))
    z = np.sort(np.concatenate([-halves, halves, border]))
    cells = [
        [(x0, _PLATE_HEIGHT, z0), (x0, _PLATE_HEIGHT, z1), (x1, _PLATE_HEIGHT, z1), (x1, _PLATE_HEIGHT, z0)]
        for x0, x1 in pairwise(x)
        for z0, z1 in pairwise(z)
        if not np.any((abs((x0 + x1) / 2 - middles) < halves) & (abs((z0 + z1) / 2) < halves))
    ]
    return props.quads("plate", cells, (0.2, 0.25, 0.35))


def _shown(texture: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.uint8]:
    """The texture as large as a picture, its texels as they are."""
    width, height = size
    rows, columns, _ = texture.shape
    texels: NDArray[np.uint8] = colors.srgb(texture)
    y, x = np.arange(height) * rows // height, np.arange(width) * columns // width
    return np.ascontiguousarray(texels[y[:, None], x], np.uint8)
