"""The page of conventions, row by row; and that every row has a test, every test a row."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, camera_above, light_above, read_png, render, visibility

FRONT_WALL = np.array([[-9.0, -9, -5], [9, -9, -5], [9, 9, -5], [-9, 9, -5]])


PAGE = Path(__file__).parents[2] / "CONVENTIONS.md"


def problems(page: str, tests: set[str]) -> list[str]:
    """Rows without a test, names that are none, and tests that no row names."""
    rows = re.findall(r"^\| (?!topic)(.+?) \|.*\| ([^|]*) \|$", page, flags=re.MULTILINE)
    named = {topic: re.findall(r"`(\w+)`", cell) for topic, cell in rows}
    untested = [f"{topic}: no test" for topic, names in named.items() if not names]
    unknown = [f"{topic}: {name}" for topic, names in named.items() for name in names if name not in tests]
    homeless = [f"no row: {name}" for name in sorted(tests.difference(*named.values()))]
    return untested + unknown + homeless + ([] if len(named) == page.count("\n| ") - 1 else ["a row is broken"])


def test_every_row_has_a_test_and_every_test_a_row():
    tests = {name.removeprefix("test_") for name, value in globals().items() if name.startswith("test_")}
    tests.remove("every_row_has_a_test_and_every_test_a_row")
    page = PAGE.read_text(encoding="utf-8")
    assert problems(page, tests) == []
    # Spoilt pages are red.
    assert problems(page.replace("`triangle_ids_count_through_the_meshes`", ""), tests) == [
        "triangle ids: no test",
        "no row: triangle_ids_count_through_the_meshes",
    ]
    assert problems(page.replace("`no_axis_is_up`", "`no_axis_is_down`"), tests) == [
        "up axis: no_axis_is_down",
        "no row: no_axis_is_up",
    ]
    assert problems(page + "| moon | is made of cheese |\n", tests) == ["a row is broken"]


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


def test_look_at_without_up_takes_world_y_or_minus_z():
    slanting, vertical = ss.look_at((0, 3, 4), (0, 0, 0)), ss.look_at((0, 3, 0), (0, 0, 0))
    np.testing.assert_allclose(slanting[:3, 1], [0, 0.8, -0.6], atol=1e-15)
    np.testing.assert_allclose(vertical[:3, 1], [0, 0, -1], atol=1e-15)


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


def test_lights_hide_nothing(scene):
    """One stands before the other, as large as it."""
    lights = [ss.RectLight(width=1, height=1, world_from_light=ss.look_at((0, y, 0), (0, 0, 0))) for y in (2.0, 3.0)]
    values = visibility(scene, lights, points=[[0, 1.5, 0], [3, 0.5, 0]]).values
    assert values.tolist() == [[1, 1], [1, 1]]


def test_normals_of_points_are_as_given(scene):
    result = visibility(scene, light_above(), points=[[3, 0.5, 0]], normals=[[0, 0, -2]], receivers=True)
    assert result.normals.tolist() == [[0, 0, -1]]


def in_world(world: np.ndarray) -> np.ndarray:
    """Visibility when scene, light and points are moved together by a rotation, a translation and a scale."""
    turn, scale = world[:3, :3] / np.cbrt(np.linalg.det(world[:3, :3])), np.cbrt(np.linalg.det(world[:3, :3]))
    pose = np.eye(4)
    pose[:3, :3] = turn @ light_above().world_from_light[:3, :3]
    pose[:3, 3] = world[:3, :3] @ light_above().world_from_light[:3, 3]
    light = ss.RectLight(width=scale, height=scale, world_from_light=pose)
    scene = ss.Scene.from_arrays(CARD @ world[:3, :3].T, SQUARE)
    points = np.stack([np.linspace(0, 2, 50), np.zeros(50), np.linspace(0, 1, 50)], axis=1)
    return visibility(scene, light, points=points @ world[:3, :3].T).values


def test_no_axis_is_up():
    quarter = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    here = in_world(np.eye(4))
    assert len(np.unique(here)) > 4
    np.testing.assert_array_equal(in_world(quarter), here)


def test_no_unit_is_assumed():
    here = in_world(np.eye(4))
    for scale in (2.0**-20, 2.0**30):
        np.testing.assert_array_equal(in_world(np.diag([scale, scale, scale, 1])), here)


def test_arrays_are_linear_and_only_pictures_are_encoded(scene):
    light, camera = light_above(radiance=(8, 8, 8)), camera_above((24, 18))
    picture = render(scene, light, camera=camera)
    brighter = render(scene, light, camera=camera, exposure=1)
    np.testing.assert_allclose(brighter.linear, 2 * picture.linear, rtol=1e-6)
    encoded = read_png(io.BytesIO(picture._repr_png_())) / 255
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(linear, np.clip(picture.linear, 0, 1), atol=0.005)
    values = picture.visibility.values
    grey = read_png(io.BytesIO(picture.visibility._repr_png_())) / 65535
    np.testing.assert_allclose(grey, np.nan_to_num(values), atol=1e-5)
    assert ((values > 0.1) & (values < 0.9)).any()


def test_opacity_is_lost_at_every_crossing():
    upper = CARD + [0, 0.5, 0]
    box = ss.Scene.from_arrays(
        np.concatenate([CARD, upper]) * [9, 1, 9], [*SQUARE, *(SQUARE + 4)[:, ::-1]], opacity=0.5
    )
    values = visibility(box, light_above(), points=[[0, 0, 0], [0, 1.25, 0], [0, 2, 0]]).values
    np.testing.assert_allclose(values, [0.25, 0.5, 1])


def test_inputs_and_results_are_apart(scene):
    points = np.array([[0.0, 0.5, 0], [3, 0.5, 0]])
    before = points.copy()
    result = visibility(scene, light_above(), points=points)
    np.testing.assert_array_equal(points, before)
    points += 7
    result.values[:] = 5
    np.testing.assert_array_equal(result.points, before)
    assert visibility(scene, light_above(), points=before).values.tolist() == [0, 1]
