"""The page of conventions, sentence by sentence."""

from __future__ import annotations

import numpy as np
import pytest

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, camera_above, light_above, visibility

FRONT_WALL = np.array([[-9.0, -9, -5], [9, -9, -5], [9, 9, -5], [-9, 9, -5]])


def seen(camera: ss.Camera, vertices: np.ndarray = FRONT_WALL) -> ss.Visibility:
    scene = ss.Scene.from_arrays(vertices, SQUARE)
    return visibility(scene, ss.SunLight(0, 45), camera=camera, technique=ss.RayTraced(samples=1), receivers=True)


def test_a_camera_looks_along_minus_z_with_y_up_and_pixel_centres_at_half_integers():
    camera = ss.Camera(world_from_camera=np.eye(4), K=[[10.0, 0, 4], [0, 10, 3], [0, 0, 1]], size=(8, 6))
    result = seen(camera)
    assert result.valid.all()
    x, y = np.meshgrid(np.arange(8) + 0.5, np.arange(6) + 0.5)
    expected = np.stack([(x - 4) / 10 * 5, -(y - 3) / 10 * 5, np.full_like(x, -5.0)], axis=-1)
    np.testing.assert_allclose(result.positions, expected, atol=2e-5)


def test_sizes_are_width_height_and_arrays_are_height_width():
    camera = camera_above((16, 12))
    result = seen(camera, FLOOR)
    assert camera.shape == (12, 16)
    assert result.values.shape == result.valid.shape == (12, 16)


def test_translation_is_in_the_last_column():
    pose = ss.look_at((1, 2, 3), (0, 0, 0))
    assert pose[:3, 3].tolist() == [1, 2, 3]
    assert pose[3].tolist() == [0, 0, 0, 1]
    np.testing.assert_allclose(-pose[:3, 2], -np.array([1, 2, 3]) / np.sqrt(14))


def test_look_at_turns_y_towards_up():
    pose = ss.look_at((0, 0, 5), (0, 0, 0), up=(1, 0, 0))
    np.testing.assert_allclose(pose[:3, 1], [1, 0, 0], atol=1e-15)


def test_fov_is_vertical_and_agrees_with_k():
    focal = 6 / np.tan(np.radians(25))
    K = [[focal, 0, 8], [0, focal, 6], [0, 0, 1]]
    pose = ss.look_at((3, 4, 3), (0, 0, 0))
    by_fov = seen(ss.Camera(world_from_camera=pose, fov_y_deg=50, size=(16, 12)), FLOOR)
    by_k = seen(ss.Camera(world_from_camera=pose, K=K, size=(16, 12)), FLOOR)
    np.testing.assert_allclose(by_fov.positions, by_k.positions, atol=1e-5)


def test_the_opencv_frame_looks_along_plus_z_with_y_down():
    opengl = ss.look_at((3, 4, 3), (0, 0, 0))
    opencv = opengl @ np.diag([1.0, -1, -1, 1])
    settings = {"fov_y_deg": 50, "size": (16, 12)}
    a = seen(ss.Camera(world_from_camera=opengl, **settings), FLOOR)
    b = seen(ss.Camera(world_from_camera=opencv, frame="opencv", **settings), FLOOR)
    np.testing.assert_array_equal(a.positions, b.positions)
    assert (opencv[:3, 2] @ (0 - opencv[:3, 3])) > 0


def test_row_zero_is_the_upper_row():
    camera = ss.Camera.look_at(eye=(0, 5, 1), target=(0, 0, 0), fov_y_deg=40, size=(4, 4))
    result = seen(camera, FLOOR)
    assert (result.positions[0, :, 2] < result.positions[-1, :, 2]).all()
    assert (result.positions[:, 0, 0] < result.positions[:, -1, 0]).all()


@pytest.mark.parametrize("kind", ["rect", "disc", "polygon"])
def test_flat_lights_emit_along_minus_z_only(kind):
    pose = np.eye(4)
    light = {
        "rect": lambda: ss.RectLight(width=1, height=1, world_from_light=pose),
        "disc": lambda: ss.DiscLight(radius=0.5, world_from_light=pose),
        "polygon": lambda: ss.PolygonLight(outline=[[0, 0], [1, 0], [0, 1]], world_from_light=pose),
    }[kind]()
    scene = ss.Scene.from_arrays(CARD + [9, 0, 0], SQUARE)
    values = visibility(scene, light, points=[[0, 0, -2], [0, 0, 2]]).values
    assert values.tolist() == [1, 0]


def test_a_sphere_emits_everywhere_and_its_pose_only_places_it(scene):
    light = ss.SphereLight(radius=0.2, world_from_light=ss.look_at((0, 5, 0), (9, 9, 9)))
    values = visibility(scene, light, points=[[0, 6, 0], [3, 5, 3], [0, 0.5, 0]]).values
    assert values.tolist() == [1, 1, 0]


def test_sizes_of_lights_are_full_widths(scene):
    parameters = ss.light_points(light_above(side=2.0), 1024, scene=scene).positions
    assert np.abs(parameters[:, [0, 2]]).max() == pytest.approx(1.0, abs=0.05)
    np.testing.assert_allclose(parameters[:, 1], 3.0, atol=1e-6)


def test_one_is_lit_and_zero_is_shadow(scene, floor_points):
    values = visibility(scene, light_above(), points=floor_points).values
    assert values[0] == 0
    assert values[-1] == 1
    assert np.all(np.diff(values) >= -0.1)


def test_light_below_a_receivers_horizon_is_not_visible():
    scene = ss.Scene.from_arrays(CARD + [9, 0, 0], SQUARE)
    normals = [[0, 1, 0], [0, -1, 0], [1, 0, 0]]
    values = visibility(scene, light_above(), points=np.zeros((3, 3)), normals=normals).values
    assert values[0] == 1
    assert values[1] == 0
    assert values[2] == pytest.approx(0.5, abs=0.1)
    assert visibility(scene, light_above(), points=np.zeros((1, 3))).values.tolist() == [1]


def test_normals_lie_on_the_cameras_side():
    from_above = seen(camera_above(), FLOOR)
    below = ss.Camera.look_at(eye=(3, -4, 3), target=(0, 0, 0), fov_y_deg=50, size=(8, 8))
    from_below = seen(below, FLOOR)
    np.testing.assert_allclose(from_above.normals[from_above.valid], [[0, 1, 0]] * from_above.valid.sum(), atol=1e-6)
    assert (from_below.normals[from_below.valid][:, 1] < -0.99).all()


def test_only_pixels_that_see_nothing_are_nan():
    result = seen(camera_above((32, 24)), FLOOR / 8)
    assert 0 < result.valid.sum() < result.valid.size
    np.testing.assert_array_equal(np.isnan(result.values), ~result.valid)
    assert (result.triangles[result.valid] >= 0).all()
    assert (result.triangles[~result.valid] == -1).all()


def test_triangle_ids_count_through_the_meshes(scene):
    camera = ss.Camera.look_at(eye=(0, 5, 0), target=(0, 0, 0), fov_y_deg=20, size=(9, 9))
    result = visibility(scene, light_above(), camera=camera, receivers=True)
    assert set(np.unique(result.triangles)) <= {0, 1, 2, 3}
    assert result.triangles[4, 4] in (2, 3)


@pytest.mark.parametrize(
    ("up", "azimuth", "elevation", "towards"),
    [("y", 90, 0, (1, 0, 0)), ("y", 0, 0, (0, 0, -1)), ("z", 0, 0, (0, 1, 0)), ("z", 17, 90, (0, 0, 1))],
)
def test_the_sun_stands_where_the_compass_says(scene, up, azimuth, elevation, towards):
    points = ss.light_points(ss.SunLight(azimuth, elevation, up=up), 64, scene=scene)
    assert points.at_infinity
    mean = points.positions.mean(axis=0)
    np.testing.assert_allclose(mean / np.linalg.norm(mean), towards, atol=2e-3)
    angles = np.degrees(
        np.arccos(np.clip(points.positions @ towards / np.linalg.norm(points.positions, axis=1), -1, 1))
    )
    assert angles.max() <= 0.53 / 2 + 1e-4
