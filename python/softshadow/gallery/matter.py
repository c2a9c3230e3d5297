"""Exhibits of what hides light: glass, counted layers, foliage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softshadow import scenes
from softshadow.camera import Camera, look_at
from softshadow.light_samples import light_points
from softshadow.lights import RectLight
from softshadow.scene import Mesh, Scene
from softshadow.techniques import DepthComplexity, HardShadowMap, RayTraced
from softshadow.visibility import visibility

from . import colors, props
from .exhibit import Exhibit, Panel
from .studio import Studio, View, difference


def glass(studio: Studio) -> Exhibit:
    """Two ways to add up what several sheets take."""
    scene = Scene([props.floor(12), *_panes(), props.leaves(45, (0.75, 0.85, 0.0), (0.35, 0.2, 0.35), 0.26, 0.45)])
    light = RectLight(
        width=0.5,
        height=0.5,
        world_from_light=look_at((-2.0, 3.2, -1.2), (0.1, 0.3, 0.1)),
        radiance=props.radiance(3.2, 0.5**2),
    )
    camera = Camera.look_at(eye=(0.3, 2.6, 3.0), target=(0.15, 0.25, 0.2), fov_y_deg=36, size=studio.size)
    view = View(scene=scene, light=light, camera=camera)
    truth = studio.reference(view)
    shots = [
        studio.panel("logarithm", "logarithms: what passes multiplies", view, DepthComplexity(), truth),
        studio.panel("sum", "the paper's sum of opacities", view, DepthComplexity(attenuation="sum"), truth),
    ]
    errors = [difference(shot, truth.panel, 0.25) for shot in shots]
    return Exhibit(
        name="glass",
        title="Semi-opaque sheets",
        look="Behind one sheet of opacity 0.45 both are right; behind two the plain sum leaves a third of what passes, "
        "and behind three nothing.",
        panels=(*shots, truth.panel, *errors),
        notes=(truth.note,),
    )


def counters(studio: Studio) -> Exhibit:
    """The paper's idea: layers are counted once, and change at edges alone."""
    view = _layered(studio.size)
    light = view.light
    assert isinstance(light, RectLight)
    spots = light_points(light, 16, scene=view.scene).positions
    center = light.world_from_light[:3, 3]
    corner = spots[np.argmax(np.linalg.norm(spots - center, axis=1))]
    layers, up = _layers(studio, view, [center, corner, *spots])
    most = layers[2:].max(axis=0)

    def counted(name: str, caption: str, values: NDArray[np.float32]) -> Panel:
        return Panel(name=name, caption=caption, image=colors.shaded(colors.counts(values), up), values=values)

    change = layers[1] - layers[0]
    soft = DepthComplexity(samples=16, exact_area=False)
    return Exhibit(
        name="counters",
        title="Depth complexity",
        look="Layers over the light's middle, plus what edges add and take away on the way to a sample, are the layers "
        "over that sample.",
        panels=(
            counted("middle", "layers over the light's middle", layers[0]),
            Panel(
                name="change",
                caption="wedges: what edges add (red) and take away (blue)",
                image=colors.shaded(colors.signed(change / 4), up),
                values=change,
            ),
            counted("corner", "layers over the sample farthest from it", layers[1]),
            counted("most", "most layers over any of 16 samples", most),
            studio.panel("soft", "samples without layers are seen", view, soft),
            studio.panel("hard", "one depth map from the middle", view, HardShadowMap()),
        ),
        notes=("White is no layer, orange 2, red 4, violet 6: a closed body is two. Grey surfaces face away.",),
    )


def foliage(studio: Studio) -> Exhibit:
    """Twenty thousand leaves, folded triangle by triangle."""
    shipped = scenes.load("canopy")
    view = View(scene=shipped.scene, light=shipped.light, camera=shipped.camera, exposure=1.0)
    truth = studio.reference(view, share=2)
    rays = studio.panel("rays", "64 rays", view, RayTraced(), truth)
    triangles = studio.panel("triangles", "64 samples, triangle by triangle", view, DepthComplexity(), truth)
    hard = studio.panel("hard", "one depth map", view, HardShadowMap(), truth)
    apart = difference(triangles, rays, 0.1)
    assert apart.values is not None
    return Exhibit(
        name="foliage",
        title="Foliage",
        look="Every leaf's border is a silhouette, so triangles are folded instead of edges; the result is that of "
        "rays to the same samples, and far from that of one depth map.",
        panels=(
            triangles,
            rays,
            hard,
            apart,
            difference(hard, truth.panel, 1.0),
            truth.panel,
        ),
        notes=(truth.note, f"Triangles and rays differ by {np.nanmax(np.abs(apart.values)):.2g} at most."),
    )


def _panes() -> list[Mesh]:
    """Three lying panes, one a step above the other."""
    square = 0.4 * np.array([(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)])
    steps = ((-0.85, 0.3, 0.15), (-0.6, 0.45, -0.05), (-0.35, 0.6, -0.25))
    return [props.quads("pane", square + step, (0.55, 0.7, 0.75), 0.45) for step in steps]


def _layered(size: tuple[int, int]) -> View:
    """Three balls, one over the other in part."""
    balls = [((-0.5, 0.55, 0.0), 0.4), ((0.15, 1.05, -0.1), 0.35), ((0.55, 0.45, 0.25), 0.3)]
    scene = Scene(
        [props.floor(12), *(props.ball(center, radius, (0.7, 0.5, 0.35), segments=64) for center, radius in balls)]
    )
    light = RectLight(
        width=1.0,
        height=1.0,
        world_from_light=look_at((-0.8, 3.2, -0.6), (0, 0, 0)),
        radiance=props.radiance(3.2, 1.0),
    )
    camera = Camera.look_at(eye=(0.5, 3.0, 3.4), target=(0.1, 0.3, 0.25), fov_y_deg=36, size=size)
    return View(scene=scene, light=light, camera=camera)


def _layers(
    studio: Studio, view: View, places: list[NDArray[np.float64]]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Triangles between every pixel and each place, and how far up each pixel's surface looks.

    Glass that halves light counts them before a light without extent. NaN where a surface faces away: there the horizon
    takes all light.
    """
    halving = Scene([replace(mesh, opacity=0.5) for mesh in view.scene.meshes])
    lights = [RectLight(width=0, height=0, world_from_light=look_at(place, (0, 0, 0))) for place in places]
    result = visibility(
        halving,
        lights,
        camera=replace(view.camera, size=studio.size),
        technique=DepthComplexity(samples=1),
        device=studio.device,
        receivers=True,
    )
    assert result.normals is not None
    passed = result.values
    layers = np.where(passed > 0, -np.log2(np.maximum(passed, np.finfo(np.float32).tiny)), np.nan)
    return layers.astype(np.float32), result.normals[..., 1]
