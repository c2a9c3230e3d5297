"""Exhibits that another program draws, on its own device."""

from __future__ import annotations

import numpy as np
import pygfx
from numpy.typing import NDArray
from rendercanvas.offscreen import RenderCanvas

from softshadow import pygfx as bridge
from softshadow.lights import RectLight
from softshadow.techniques import DepthComplexity
from softshadow.wgpu import Host

from .exhibit import Exhibit, Panel
from .studio import Studio


def guests(studio: Studio) -> Exhibit:
    """A knot on a floor that pygfx draws: without shadows, with its own, and with the visibility of an area light."""
    plain = _Stage(studio.size).picture()
    mapped = _Stage(studio.size, cast_shadow=True).picture()
    stage = _Stage(studio.size)
    host, scene, ms = Host(bridge.device()), bridge.scene(stage.scene), 0.0
    lamp = RectLight(width=1.6, height=1.6, world_from_light=bridge.light_pose(stage.lamp))
    for mesh in (stage.floor, stage.knot):
        points, normals = bridge.vertices(mesh)
        for _ in range(2):  # Kernels are compiled by a first call, which is not timed.
            seen = host.visibility(scene, lamp, points=points, normals=normals, technique=DepthComplexity(samples=64))
        mesh.geometry.colors = bridge.vertex_colors(seen)
        ms += seen.info["wall_ms"]
    shown = [
        Panel(name="plain", caption="pygfx: a spot light without shadows", image=plain),
        Panel(name="map", caption="pygfx: its shadow map", image=mapped),
        Panel(name="soft", caption="pygfx, visibility as vertex colours", image=stage.picture(), ms=ms),
    ]
    return Exhibit(
        name="guests",
        title="Drawn by pygfx",
        look="The same meshes, camera and spot light of a pygfx scene; on the right the light is a square of 1.6 in "
        "its place, and its visibility went from softshadow to pygfx without leaving the device.",
        panels=tuple(shown),
        notes=(f"Visibility of {len(points):,} vertices of the knot and of the floor's, at 64 samples.",),
    )


class _Stage:
    """A scene of pygfx that knows nothing of softshadow."""

    def __init__(self, size: tuple[int, int], cast_shadow: bool = False) -> None:
        self._size = size
        floor = pygfx.plane_geometry(9, 9, 180, 180)
        self.floor = pygfx.Mesh(floor, _matt("#c8c4bc"))
        # pygfx's plane stands upright.
        self.floor.local.euler_x = -np.pi / 2
        self.knot = pygfx.Mesh(pygfx.torus_knot_geometry(0.6, 0.18, 192, 24), _matt("#e0603c"))
        self.knot.local.position = (0.2, 1.05, 0)
        self.lamp = pygfx.SpotLight(intensity=8, angle=1.2, penumbra=0.2, cast_shadow=cast_shadow)
        self.lamp.local.position = (-1.6, 4.2, 1.2)
        self.floor.receive_shadow = self.knot.receive_shadow = self.knot.cast_shadow = cast_shadow
        self.scene = pygfx.Scene()
        self.scene.add(self.floor, self.knot, self.lamp, pygfx.AmbientLight(intensity=0.15))
        self.scene.add(pygfx.Background.from_color("#b8bcc4"))
        self._camera = pygfx.PerspectiveCamera(38, size[0] / size[1])
        self._camera.local.position = (1.8, 3.1, 5.0)
        self._camera.look_at((0.45, 0.8, 0))

    def picture(self) -> NDArray[np.uint8]:
        """sRGB, (H, W, 3)."""
        canvas = RenderCanvas(size=self._size, pixel_ratio=1)
        renderer = pygfx.WgpuRenderer(canvas, pixel_ratio=1)
        canvas.request_draw(lambda: renderer.render(self.scene, self._camera))
        return np.ascontiguousarray(np.asarray(canvas.draw())[..., :3])


def _matt(color: str) -> pygfx.MeshPhongMaterial:
    # Colours of vertices do not dim highlights.
    return pygfx.MeshPhongMaterial(color=color, specular="#000000")
