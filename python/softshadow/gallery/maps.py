"""Exhibits of the occlusion camera, after the figures of Mo, Popescu and Wyman 2007."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from softshadow import scenes
from softshadow.camera import Camera, look_at
from softshadow.lights import RectLight, SphereLight
from softshadow.scene import Mesh, Scene
from softshadow.techniques import DepthComplexity, HardShadowMap, OcclusionCamera

from . import props
from .exhibit import Exhibit
from .studio import Studio, View, difference

_HARD = HardShadowMap(resolution=1024)
_LIMIT = 0.3


def growing(studio: Studio) -> Exhibit:
    """The umbra shrinks as the light grows (figure 10)."""
    panels = []
    notes = []
    for radius in (0.1, 0.3, 0.6):
        view = _props(studio, radius)
        truth = studio.reference(view)
        bent = studio.panel(
            f"camera_{radius:g}", f"occlusion camera, radius {radius:g}", view, OcclusionCamera(), truth
        )
        rays = replace(truth.panel, name=f"reference_{radius:g}")
        panels += [bent, rays, difference(bent, rays, _LIMIT)]
        notes.append(f"Radius {radius:g}: {truth.note}")
    return Exhibit(
        name="growing",
        title="A growing light",
        look="Penumbrae lie to both sides of the hard shadow's border, are sharp in contact, and eat up the umbra.",
        panels=tuple(panels),
        notes=tuple(notes),
    )


def forks(studio: Studio) -> Exhibit:
    """A fork: many silhouettes within one penumbra (figures 7 and 13)."""
    shipped = scenes.load("fork")
    view = View(scene=shipped.scene, light=shipped.light, camera=shipped.camera, exposure=1.0)
    truth = studio.reference(view)
    three = studio.panel("three", "three steps", view, OcclusionCamera(), truth)
    one = studio.panel("one", "one step: dark spots, and borders of map quads", view, OcclusionCamera(steps=1), truth)
    hard = studio.panel("hard", "one depth map", view, _HARD, truth)
    return Exhibit(
        name="forks",
        title="Small concavities",
        look="Between tines several silhouettes meet in one texel of the map; what it cannot hold is dark or bright in "
        "spots, with steps between right and wrong.",
        panels=(
            three,
            one,
            truth.panel,
            difference(three, truth.panel, _LIMIT),
            difference(one, truth.panel, _LIMIT),
            hard,
        ),
        notes=(truth.note,),
    )


def stairs(studio: Studio) -> Exhibit:
    """What rises towards the light looks like an occluder (figure 9)."""
    at = np.arange(9)
    lower = np.stack([-0.9 + 0.2 * at, np.zeros(9), np.full(9, -0.7)], axis=1)
    upper = lower + np.stack([np.full(9, 0.2), 0.05 * (at + 1), np.full(9, 1.4)], axis=1)
    roof = props.boxes("roof", [[-1.6, 1.2, -1.2]], [[-0.1, 1.25, 1.2]], (0.6, 0.35, 0.25))
    steps = props.boxes("steps", lower, upper, (0.7, 0.7, 0.72))
    light = RectLight(
        width=0.8, height=0.8, world_from_light=look_at((0.0, 3.5, 0.0), (0, 0, 0)), radiance=props.radiance(3.5, 0.64)
    )
    camera = Camera.look_at(eye=(2.6, 2.0, 2.4), target=(0, 0.2, 0), fov_y_deg=36, size=studio.size)
    view = View(scene=Scene([props.floor(6), steps, roof]), light=light, camera=camera)
    truth = studio.reference(view)
    without = studio.panel("without", "without bias: false umbra", view, OcclusionCamera(bias=0.0), truth)
    with_bias = studio.panel("bias", "a quarter of the way to the occluder", view, OcclusionCamera(), truth)
    return Exhibit(
        name="stairs",
        title="Stairs under a roof",
        look="Moved past the roof's edge, a receiver arrives under the next step; a bias tells steps from occluders.",
        panels=(
            without,
            with_bias,
            truth.panel,
            difference(without, truth.panel, _LIMIT),
            difference(with_bias, truth.panel, _LIMIT),
            studio.panel("edges", "depth complexity, 16 samples", view, DepthComplexity(samples=16), truth),
        ),
        notes=(truth.note,),
    )


def _props(studio: Studio, radius: float) -> View:
    leg = ((-0.5, -0.3), (-0.5, 0.3), (0.1, -0.3), (0.1, 0.3))
    lower = [[x, 0, z] for x, z in leg] + [[-0.55, 0.5, -0.35]]
    upper = [[x + 0.06, 0.5, z + 0.06] for x, z in leg] + [[0.2, 0.56, 0.4]]
    meshes: list[Mesh] = [
        props.floor(6),
        props.boxes("table", lower, upper, (0.6, 0.45, 0.3)),
        props.ball((0.6, 0.25, 0.25), 0.25, (0.3, 0.45, 0.7)),
        props.ball((-0.15, 0.74, 0.0), 0.18, (0.75, 0.35, 0.3)),
    ]
    distance = 3.2
    light = SphereLight(
        radius=radius,
        world_from_light=look_at((-1.0, distance, 0.8), (0, 0.3, 0)),
        radiance=props.radiance(distance, math.pi * radius**2),
    )
    camera = Camera.look_at(eye=(1.6, 1.8, 2.4), target=(0.1, 0.25, 0), fov_y_deg=36, size=studio.size)
    return View(scene=Scene(meshes), light=light, camera=camera)
