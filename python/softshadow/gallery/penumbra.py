"""Exhibits of maps from the light's centre, after Wyman and Hansen 2003: what they show, and what they cannot."""

from __future__ import annotations

import numpy as np

from softshadow.camera import Camera, look_at
from softshadow.lights import DiscLight
from softshadow.scene import Mesh, Scene
from softshadow.techniques import HardShadowMap, PenumbraMap

from . import props
from .exhibit import Exhibit
from .studio import Studio, View, difference


def penumbrae(studio: Studio) -> Exhibit:
    """The paper's seventh figure: a hard shadow, two lights, and the truth of the larger one."""
    small, large = _knot(studio.size, 0.15), _knot(studio.size, 0.5)
    truths = [studio.reference(view) for view in (small, large)]
    shots = [
        studio.panel(name, caption, view, PenumbraMap(), truth)
        for name, caption, view, truth in zip(
            ("small", "large"), ("a small light", "a light three times as wide"), (small, large), truths, strict=True
        )
    ]
    published = studio.panel("paper", "the same with the paper's ramp", large, PenumbraMap(ramp="paper"), truths[1])
    return Exhibit(
        name="penumbrae",
        title="Penumbra maps",
        look="The hard shadow stays as the light grows, and penumbrae grow around it: the inner half of each is "
        "missing, so the larger light has the larger, darker shadow (blue). The paper's ramp is darker still.",
        panels=(
            studio.panel("hard", "shadow map", small, HardShadowMap(resolution=1024), truths[0]),
            *shots,
            published,
            difference(shots[1], truths[1].panel, 0.5),
            truths[1].panel,
        ),
        notes=(truths[1].note,),
    )


def concavities(studio: Studio) -> Exhibit:
    """Overlapping penumbrae: the darkest stands for all."""
    view = _star(studio.size)
    truth = studio.reference(view)
    shot = studio.panel("darkest", "the darkest wins", view, PenumbraMap(), truth)
    return Exhibit(
        name="concavities",
        title="Overlapping penumbrae",
        look="In a notch of the star two penumbrae overlap. In truth their shares multiply; the darkest of both leaves "
        "a crease where they are equal, and the shadow is too dark everywhere (blue), most at the tips.",
        panels=(
            studio.panel("hard", "shadow map", view, HardShadowMap(resolution=1024), truth),
            shot,
            truth.panel,
            difference(shot, truth.panel, 0.5),
        ),
        notes=(truth.note,),
    )


def _light(diameter: float) -> DiscLight:
    return DiscLight(
        radius=diameter / 2,
        world_from_light=look_at((-1.0, 3.0, 0.6), (0.0, 0.2, 0.0)),
        radiance=props.radiance(3.0, np.pi * diameter**2 / 4),
    )


def _knot(size: tuple[int, int], diameter: float) -> View:
    """A ball, and a ring of balls over it: bodies that shadow themselves, each other and a floor."""
    angles = np.arange(5) * (2 * np.pi / 5)
    ring = [props.ball((0.55 * np.cos(a), 0.75, 0.55 * np.sin(a)), 0.17, (0.45, 0.55, 0.7)) for a in angles]
    scene = Scene([props.floor(8), props.ball((0.0, 0.35, 0.0), 0.35, (0.7, 0.5, 0.35)), *ring])
    camera = Camera.look_at(eye=(0.9, 2.0, 3.0), target=(0.15, 0.35, 0.0), fov_y_deg=36, size=size)
    return View(scene=scene, light=_light(diameter), camera=camera, shading="modulated")


def _star(size: tuple[int, int]) -> View:
    """A flat star: five notches."""
    turns = np.arange(11) * (np.pi / 5)
    radii = np.where(np.arange(11) % 2 == 0, 0.55, 0.22)
    rim = np.stack([radii * np.cos(turns) - 0.65, np.full(11, 0.7), radii * np.sin(turns)], axis=1)
    vertices = np.concatenate([[[-0.65, 0.7, 0.0]], rim[:-1]])
    faces = np.array([[0, 1 + (i + 1) % 10, 1 + i] for i in range(10)], np.uint32)
    star = Mesh(name="star", vertices=vertices, faces=faces, base_color=(0.7, 0.5, 0.35), specular=0.0)
    camera = Camera.look_at(eye=(-0.5, 2.0, 2.0), target=(-0.55, 0.2, -0.1), fov_y_deg=34, size=size)
    return View(scene=Scene([props.floor(8), star]), light=_light(0.8), camera=camera, shading="modulated")
