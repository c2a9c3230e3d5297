"""Exhibits of `depth_complexity` itself: which edges count, how samples are spread, and areas."""

from __future__ import annotations

from softshadow import scenes
from softshadow.camera import Camera, look_at
from softshadow.lights import RectLight
from softshadow.scene import Scene
from softshadow.techniques import DepthComplexity

from . import props
from .exhibit import Exhibit
from .studio import Studio, View, difference


def silhouettes(studio: Studio) -> Exhibit:
    """After the paper's figure 4; but `standard` selects edges alone, and the receiver says how they count."""
    light = RectLight(
        width=2.4,
        height=2.4,
        world_from_light=look_at((-0.6, 2.6, 0.4), (0, 0, 0)),
        radiance=props.radiance(2.6, 2.4**2),
    )
    view = View(
        scene=Scene([props.floor(12), props.ball((0, 0.75, 0), 0.6, (0.75, 0.45, 0.3), segments=64)]),
        light=light,
        camera=Camera.look_at(eye=(0.6, 2.2, 4.2), target=(0.1, 0.4, 0), fov_y_deg=34, size=studio.size),
        shading="modulated",
    )
    truth = studio.reference(view)
    shots = [
        studio.panel("standard", "standard: edges of one point", view, DepthComplexity(silhouettes="standard"), truth),
        studio.panel("accurate", "accurate: edges of the whole light", view, DepthComplexity(), truth),
    ]
    errors = [difference(shot, truth.panel, 0.25) for shot in shots]
    return Exhibit(
        name="silhouettes",
        title="Standard and accurate silhouettes",
        look="The edges that one point of the light sees around a body are one loop, and cast the shadow of a flat "
        "body within it. Edges of the whole light draw what rays draw.",
        panels=(*shots, truth.panel, *errors),
        notes=(
            truth.note,
            "Both fold the same counters; only edges and the side from which they are weighed differ.",
        ),
    )


def spreads(studio: Studio) -> Exhibit:
    """The paper's figure 5."""
    shipped = scenes.load("toruses")
    view = View(
        scene=shipped.scene,
        light=shipped.light,
        camera=Camera.look_at(eye=(-2.8, 3.4, 1.4), target=(-0.1, 0, 0.2), fov_y_deg=32, size=studio.size),
    )
    truth = studio.reference(view)
    shots = [
        studio.panel(
            f"{spread}_{count}",
            f"{count} samples, {spread}",
            view,
            DepthComplexity(samples=count, spread=spread, exact_area=False),
            truth,
        )
        for count, spread in ((16, "correlated"), (16, "decorrelated"), (16, "interleaved"), (64, "correlated"))
    ]
    errors = [difference(shot, truth.panel, 0.15) for shot in shots]
    return Exhibit(
        name="spreads",
        title="Who shares samples",
        look="Sixteen samples that all pixels share draw steps; a set of each pixel's own turns them into noise; "
        "interleaved sets are averaged over 4 × 4 pixels.",
        panels=(*shots[:3], *errors[:3], shots[3], errors[3], truth.panel),
        notes=(truth.note, "Areas are switched off here, so that samples alone answer."),
    )


def areas(studio: Studio) -> Exhibit:
    """Where a single layer hides the light, its visible area answers."""
    shipped = scenes.load("cards")
    view = View(
        scene=shipped.scene,
        light=shipped.light,
        camera=Camera.look_at(eye=(2.8, 1.8, 1.2), target=(0.5, 0.1, 0.3), fov_y_deg=34, size=studio.size),
        exposure=0.7,
        shading="modulated",
    )
    truth = studio.reference(view)
    shots = [
        studio.panel("samples", "16 samples alone", view, DepthComplexity(samples=16, exact_area=False), truth),
        studio.panel("areas", "16 samples and areas", view, DepthComplexity(samples=16), truth),
    ]
    errors = [difference(shot, truth.panel, 0.1) for shot in shots]
    return Exhibit(
        name="areas",
        title="Exact areas",
        look="The steps of sixteen samples vanish where a single layer hides the light; they stay where layers "
        "overlap, and on the grey card, whose horizon cuts the light.",
        panels=(*shots, truth.panel, *errors),
        notes=(truth.note,),
    )
