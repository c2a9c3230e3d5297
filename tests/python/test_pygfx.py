"""Scenes of pygfx: its conventions, and its own pictures of our visibility."""

from __future__ import annotations

import numpy as np
import pytest

import softshadow as ss

gfx = pytest.importorskip("pygfx", reason="pygfx is not installed: its scenes, cameras and materials are not tested")
from rendercanvas.offscreen import RenderCanvas  # noqa: E402

from softshadow import pygfx as bridge  # noqa: E402
from softshadow.wgpu import Host  # noqa: E402

SIZE = (96, 72)
EDGES = ss.DepthComplexity(samples=64)


@pytest.fixture(scope="module")
def host() -> Host:
    return Host(bridge.device())


class World:
    """An L above one corner of a floor, a camera that is rolled, and a lamp from the side: nothing is symmetric."""

    def __init__(self) -> None:
        self.floor = gfx.Mesh(gfx.plane_geometry(6, 4, 127, 95), gfx.MeshBasicMaterial(color="#ffffff"))
        # The plane of pygfx stands upright; laid down, and turned a little.
        self.floor.local.rotation = multiplied(turned((0, 1, 0), 20), turned((1, 0, 0), -90))
        self.floor.local.position = (0.3, -0.1, 0.2)
        black = gfx.MeshBasicMaterial(color="#000000")
        self.group = gfx.Group()
        long, short = (gfx.Mesh(gfx.box_geometry(*size), black) for size in ((2.0, 0.1, 0.3), (0.3, 0.1, 1.0)))
        long.local.position, short.local.position = (0.5, 0.9, -0.4), (1.35, 0.9, 0.2)
        self.group.add(long, short)
        self.group.local.scale = (1.0, 1.0, 0.8)
        self.scene = gfx.Scene()
        self.lamp = gfx.SpotLight(intensity=3)
        self.lamp.local.position = (1.0, 3.0, 0.8)
        self.lamp.target.local.position = (0.2, 0.0, 0.0)
        self.scene.add(self.floor, self.group, self.lamp)
        self.camera = gfx.PerspectiveCamera(45, SIZE[0] / SIZE[1])
        self.camera.local.position = (1.0, 2.9, 2.6)
        self.camera.look_at((0.5, 0, -0.3))
        self.camera.local.rotation = multiplied(self.camera.local.rotation, turned((0, 0, 1), 12))
        self.light = ss.RectLight(width=0.7, height=0.3, world_from_light=bridge.light_pose(self.lamp))

    def picture(self) -> np.ndarray:
        """As pygfx draws it: sRGB bytes, (H, W, 3)."""
        canvas = RenderCanvas(size=SIZE, pixel_ratio=1)
        renderer = gfx.WgpuRenderer(canvas, pixel_ratio=1, pixel_filter="nearest", ppaa="none")
        canvas.request_draw(lambda: renderer.render(self.scene, self.camera))
        return np.asarray(canvas.draw())[..., :3]


def turned(axis, degrees) -> np.ndarray:
    """A rotation as pygfx has it: a quaternion x, y, z, w."""
    half = np.radians(degrees) / 2
    return np.array([*(np.sin(half) * np.array(axis, float)), np.cos(half)])


def multiplied(a, b) -> np.ndarray:
    (x, y, z, w), (p, q, r, s) = a, b
    return np.array(
        [
            w * p + x * s + y * r - z * q,
            w * q - x * r + y * s + z * p,
            w * r + x * q - y * p + z * s,
            w * s - x * p - y * q - z * r,
        ]
    )


def srgb(linear: np.ndarray) -> np.ndarray:
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)


def expected(world: World) -> tuple[np.ndarray, np.ndarray]:
    """What our own camera sees on the floor, as sRGB, and where it sees the floor."""
    camera = bridge.camera(world.camera, SIZE)
    seen = ss.visibility(
        bridge.scene(world.scene), world.light, camera=camera, technique=EDGES, device="software", receivers=True
    )
    floor = seen.valid & (seen.triangles < len(world.floor.geometry.indices.data))
    return srgb(np.nan_to_num(seen.values)), floor


def differences(picture: np.ndarray, wanted: np.ndarray, where: np.ndarray) -> np.ndarray:
    return np.abs(picture[..., 0].astype(float) - wanted)[where]


def agrees(picture: np.ndarray, wanted: np.ndarray, where: np.ndarray) -> bool:
    """Interpolation between vertices or texels moves penumbrae a little, and edges of the picture by a pixel."""
    off = differences(picture, wanted, where)
    return bool(np.median(off) <= 1.0 and np.mean(off > 12) < 0.03 and off.mean() < 2.5)


def texel_points(world: World, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """World positions and normals of the middles of texels of the floor's texture, row by row."""
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    # pygfx's plane has its first row of texture at the top, y = +height/2.
    texcoords, positions = world.floor.geometry.texcoords.data, world.floor.geometry.positions.data
    corners = [np.argmin(np.abs(texcoords - corner).sum(axis=1)) for corner in ([0, 0], [1, 0], [0, 1])]
    origin, right, down = (positions[corner].astype(float) for corner in corners)
    local = origin + u[..., None] * (right - origin) + v[..., None] * (down - origin)
    matrix = np.array(world.floor.world.matrix, dtype=float)
    points = local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    return points, np.tile(matrix[:3, 2], (len(points), 1))


@pytest.mark.parametrize("kind", ["vertex colours", "texture", "texture of odd width"])
def test_pygfx_draws_the_visibility_that_our_camera_sees(host, kind):
    world = World()
    scene = bridge.scene(world.scene)
    if kind == "vertex colours":
        points, normals = bridge.vertices(world.floor)
    else:
        size = (192, 128) if kind == "texture" else (150, 110)
        points, normals = texel_points(world, *size)
    seen = host.visibility(scene, world.light, points=points, normals=normals, technique=EDGES)
    if kind == "vertex colours":
        world.floor.geometry.colors = bridge.vertex_colors(seen)
        world.floor.material.color_mode = "vertex"
    else:
        texture = bridge.texture(seen, size)
        assert texture.data is None
        assert texture.size == (*size, 1)
        world.floor.material.map = gfx.TextureMap(texture)
    picture, (wanted, floor) = world.picture(), expected(world)
    assert floor.mean() > 0.3
    assert np.mean(wanted[floor] < 128) > 0.05, "there is a shadow"
    assert agrees(picture, wanted, floor), differences(picture, wanted, floor).mean()
    # A picture that is mirrored, turned, or taken for linear is seen.
    for spoilt in (picture[::-1], picture[:, ::-1], picture[::-1, ::-1], srgb(picture / 255.0)):
        assert not agrees(spoilt, wanted, floor)


def test_meshes_are_read_in_world_coordinates():
    world = World()
    ghost, glass = (gfx.Mesh(gfx.box_geometry(1, 1, 1), gfx.MeshBasicMaterial(opacity=0.5)) for _ in range(2))
    ghost.visible = False
    many = gfx.InstancedMesh(gfx.box_geometry(1, 1, 1), gfx.MeshBasicMaterial(), 3)
    many.name = "forest"
    world.scene.add(ghost, glass, many)
    scene = bridge.scene(world.scene)
    assert len(scene.meshes) == 4
    assert [mesh.opacity for mesh in scene.meshes] == [1, 1, 1, 0.5]
    assert scene.notes == ("'forest' left out: InstancedMesh is no plain mesh",)
    low, high = scene.meshes[2].vertices.min(axis=0), scene.meshes[2].vertices.max(axis=0)
    np.testing.assert_allclose(low, [1.2, 0.85, -0.24], atol=1e-6)
    np.testing.assert_allclose(high, [1.5, 0.95, 0.56], atol=1e-6)
    with pytest.raises(ss.SceneError, match=r"scene: a pygfx\.WorldObject expected, got int"):
        bridge.scene(3)


def test_cameras_and_lights():
    world = World()
    world.camera.zoom = 1.5
    camera = bridge.camera(world.camera, (200, 50))
    # pygfx projects a point; ours does it by hand.
    world.camera.set_view_size(200, 50)
    clip = world.camera.camera_matrix @ np.array([0.4, 0.2, 0.1, 1.0])
    pixel = (clip[:2] / clip[3] * [1, -1] + 1) / 2 * [200, 50]
    local = np.linalg.inv(camera.world_from_camera) @ np.array([0.4, 0.2, 0.1, 1.0])
    ours = (camera.K @ (local[:3] * [1, -1, -1]))[:2] / -local[2]
    np.testing.assert_allclose(ours, pixel, atol=1e-3)
    pose = bridge.light_pose(world.lamp)
    np.testing.assert_allclose(pose[:3, 3], world.lamp.world.position, atol=1e-6)
    np.testing.assert_allclose(-pose[:3, 2] * np.linalg.norm([0.8, 3.0, 0.8]), [-0.8, -3.0, -0.8], atol=1e-5)
    lamp = gfx.PointLight()
    lamp.look_at((0, -1, 0))
    np.testing.assert_allclose(-bridge.light_pose(lamp)[:3, 2], [0, -1, 0], atol=1e-6)
    with pytest.raises(ss.SceneError, match="AmbientLight"):
        bridge.light_pose(gfx.AmbientLight())
    with pytest.raises(ss.SceneError, match="PerspectiveCamera"):
        bridge.camera(gfx.OrthographicCamera(), SIZE)


def test_results_of_other_shapes_and_devices_are_refused(host):
    import wgpu

    world = World()
    points, normals = bridge.vertices(world.floor)
    scene = bridge.scene(world.scene)
    seen = host.visibility(scene, [world.light], points=points, normals=normals, technique=EDGES)
    with pytest.raises(ss.SettingsError, match="vertex colours"):
        bridge.vertex_colors(seen)
    with pytest.raises(ss.SettingsError, match="size: points"):
        bridge.texture(seen)
    with pytest.raises(ss.SettingsError, match="texels expected"):
        bridge.texture(seen, (7, 5))
    other = Host(wgpu.gpu.enumerate_adapters_sync()[0].request_device_sync())
    away = other.visibility(scene, world.light, points=points, normals=normals, technique=EDGES)
    with pytest.raises(ss.SettingsError, match="another device"):
        bridge.vertex_colors(away)
