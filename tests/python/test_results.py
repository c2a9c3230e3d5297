"""Shapes and values of results, and the files that are made of them."""

from __future__ import annotations

import io
import json
import re
import sys

import numpy as np
import pytest

import softshadow as ss
from conftest import CARD, SQUARE, camera_above, compare, light_above, read_png, render, visibility
from softshadow import diagnosis


def test_shapes(scene, floor_points):
    light, camera = light_above(), camera_above((16, 12))
    textured = light_above(texture=np.ones((2, 2, 3)))
    n = len(floor_points)
    for lights, leading, trailing in (
        (light, (), ()),
        ([light], (1,), ()),
        ((light, light_above(2.0)), (2,), ()),
        (textured, (), (3,)),
        ([light, textured], (2,), (3,)),
    ):
        by_camera = visibility(scene, lights, camera=camera, receivers=True)
        by_points = visibility(scene, lights, points=floor_points, receivers=True)
        for result, shape in ((by_camera, (12, 16)), (by_points, (n,))):
            assert result.values.shape == result.standard_error.shape == leading + shape + trailing
            assert result.values.dtype == result.standard_error.dtype == np.float32
            assert result.valid.shape == result.triangles.shape == shape
            assert result.positions.shape == result.normals.shape == (*shape, 3)
    assert visibility(scene, [light, light], points=np.empty((0, 3))).values.shape == (2, 0)


def test_receivers_and_standard_error_come_when_asked_for(scene, floor_points):
    bare = visibility(scene, light_above(), points=floor_points, standard_error=False)
    assert bare.standard_error is bare.positions is bare.normals is bare.triangles is None
    placed = visibility(scene, light_above(), points=floor_points, receivers=True)
    np.testing.assert_allclose(placed.positions, floor_points, atol=1e-6)
    assert (placed.triangles == -1).all()
    in_penumbra = (placed.values > 0) & (placed.values < 1)
    assert (placed.standard_error[in_penumbra] > 0).all()


def test_several_lights_are_one_call_each(scene, floor_points):
    lights = [
        light_above(),
        light_above(2.5),
        ss.SunLight(30, 50),
        ss.DiscLight(radius=0.4, world_from_light=POSE),
    ]
    together = visibility(scene, lights, points=floor_points).values
    for light, values in zip(lights, together, strict=True):
        np.testing.assert_array_equal(values, visibility(scene, light, points=floor_points).values)


POSE = ss.look_at((1, 3, 0), (0, 0, 0))


def test_a_texture_weighs_what_is_visible(scene):
    """The red half of the light is hidden, the blue half is seen."""
    half = ss.Scene.from_arrays(CARD * [1, 1, 4] * [20, 1, 20] + [10.0, 0.5, 0], SQUARE)
    texture = np.zeros((1, 64, 3))
    pose = ss.look_at((0, 3, 0), (0, 0, 0))
    along_x = pose[0, 0]
    texture[:, :32, 0] = 1
    texture[:, 32:, 2] = 1
    light = ss.RectLight(width=1, height=1, world_from_light=pose, texture=texture)
    result = visibility(half, light, points=[[-0.0, 0, 0]], technique=ss.RayTraced(samples=1024))
    red, green, blue = result.values[0]
    seen, hidden = (red, blue) if along_x > 0 else (blue, red)
    assert seen == pytest.approx(1, abs=0.03)
    assert hidden == pytest.approx(0, abs=0.03)
    # Of a colour that the light has none of, all there is is visible or nothing is: both are numbers.
    assert np.isfinite(green)


def test_a_light_without_size_casts_a_hard_shadow(scene, floor_points):
    values = visibility(scene, light_above(0.0), points=floor_points).values
    x = floor_points[:, 0]
    expected = (x > 0.75).astype(np.float32)
    clear = np.abs(x - 0.75) > 0.01
    np.testing.assert_array_equal(values[clear], expected[clear])


def test_hard_shadow_maps_are_nearly_hard(scene, floor_points):
    result = visibility(scene, light_above(), points=floor_points, technique=ss.HardShadowMap())
    clear = np.abs(floor_points[:, 0] - 0.75) > 0.05
    np.testing.assert_allclose(result.values[clear], (floor_points[:, 0] > 0.75)[clear], atol=1e-3)
    assert result.standard_error is None
    assert result.info["technique"] == {"name": "hard_shadow_map", "resolution": 2048}


def test_settings_change_results(scene):
    light = light_above()
    points = np.stack([np.linspace(0.5, 1, 40), np.full(40, 1e-3), np.linspace(0, 0.9, 40)], axis=1)
    base = visibility(scene, light, points=points).values
    for technique in (
        ss.RayTraced(samples=32),
        ss.RayTraced(pattern="low_discrepancy"),
        ss.RayTraced(seed=1),
        ss.RayTraced(passes=2),
    ):
        assert not np.array_equal(visibility(scene, light, points=points, technique=technique).values, base)
    np.testing.assert_array_equal(visibility(scene, light, points=points).values, base)


def test_blocks_under_a_memory_limit_change_nothing(scene):
    camera = camera_above((64, 48))
    whole = visibility(scene, light_above(), camera=camera)
    blocks = visibility(scene, light_above(), camera=camera, memory_limit=100_000)
    assert blocks.info["blocks"] > whole.info["blocks"]
    np.testing.assert_array_equal(blocks.values, whole.values)


def test_info_says_what_made_the_result(scene, floor_points):
    info = visibility(scene, light_above(), points=floor_points, technique=ss.RayTraced(samples=7, seed=3)).info
    assert info["technique"]["samples"] == 7
    assert info["technique"]["seed"] == 3
    assert info["adapter"]["device_type"] == "software"
    assert info["receivers"] == len(floor_points)
    assert info["wall_ms"] > 0
    json.dumps(info)


def test_light_points_are_the_samples_of_the_light(scene):
    light = light_above(texture=np.ones((1, 1, 3)))
    points = ss.light_points(light, 256, scene=scene)
    assert points.positions.shape == (256, 3)
    assert points.parameters.shape == (256, 2)
    local = np.linalg.inv(light.world_from_light) @ np.c_[points.positions, np.ones(256)].T
    np.testing.assert_allclose(local[:2].T, points.parameters * 0.5, atol=1e-6)
    np.testing.assert_allclose(local[2], 0, atol=1e-6)
    other = ss.light_points(light, 256, scene=scene, seed=1)
    assert not np.array_equal(points.positions, other.positions)
    np.testing.assert_array_equal(points.positions, ss.light_points(light, 256, scene=scene).positions)


def test_visible_samples_are_those_of_light_points(scene):
    light, camera = light_above(), camera_above((16, 12))
    technique = ss.RayTraced(samples=40)
    result = visibility(scene, light, camera=camera, technique=technique, sample_masks=True, receivers=True)
    assert result.visible_samples.shape == (12, 16, 40)
    shares = result.visible_samples.mean(axis=2)
    np.testing.assert_allclose(shares[result.valid], result.values[result.valid], atol=1e-6)
    assert not result.visible_samples[~result.valid].any()
    # The card lies at y = 1 and hides a sample where the ray crosses it.
    samples = ss.light_points(light, 40, scene=scene).positions.reshape(-1, 3)
    origins = np.where(result.valid[..., None], result.positions, 9)[:, :, None]
    on_floor = origins[..., 1] < 0.5
    across = origins + (samples - origins) * ((1 - origins[..., 1]) / (samples[:, 1] - origins[..., 1]))[..., None]
    inside = np.abs(across[..., [0, 2]]).max(axis=-1)
    clear = np.abs(inside - 0.5) > 1e-4
    assert ((inside > 0.5) == result.visible_samples)[on_floor & clear].all()
    assert (~result.visible_samples & on_floor).sum() > 100
    two = visibility(scene, [light, light_above(2.0)], camera=camera, technique=technique, sample_masks=True)
    assert two.visible_samples.shape == (2, 12, 16, 40)
    for other in (ss.HardShadowMap(), ss.RayTraced(probes=16)):
        with pytest.raises(ss.SettingsError, match="sample_masks"):
            visibility(scene, light, camera=camera, technique=other, sample_masks=True)


@pytest.mark.parametrize("spread", ["decorrelated", "interleaved"])
def test_light_points_know_the_samples_of_every_pixel(scene, spread):
    light, camera, settings = light_above(), camera_above((16, 12)), {"spread": spread, "tile": 3, "seed": 2}
    masks = [
        visibility(scene, light, camera=camera, technique=technique, sample_masks=True, receivers=True)
        for technique in (ss.RayTraced(samples=40, **settings), ss.DepthComplexity(samples=40, **settings))
    ]
    result = masks[0]
    np.testing.assert_array_equal(masks[1].visible_samples, result.visible_samples)
    assert result.info["technique"]["spread"] == spread
    origins = np.where(result.valid[..., None], result.positions, 9.0)
    points = ss.light_points(light, 40, origins, scene=scene, **settings)
    assert points.positions.shape == (12, 16, 40, 3)
    assert points.parameters.shape == (12, 16, 40, 2)
    assert not np.array_equal(points.parameters[4, 4], points.parameters[4, 5])
    assert np.array_equal(points.parameters[4, 4], points.parameters[7, 7]) == (spread == "interleaved")
    # The card lies at y = 1 and hides a sample where the ray crosses it.
    on_floor = origins[..., None, 1] < 0.5
    share = (1 - origins[..., None, 1]) / (points.positions[..., 1] - origins[..., None, 1])
    across = origins[:, :, None] + (points.positions - origins[:, :, None]) * share[..., None]
    inside = np.abs(across[..., [0, 2]]).max(axis=-1)
    clear = np.abs(inside - 0.5) > 1e-4
    assert ((inside > 0.5) == result.visible_samples)[on_floor & clear].all()
    assert (~result.visible_samples & on_floor).sum() > 100
    # Averages of neighbours are no shares of 40; a pixel's own samples are.
    steps = result.values[result.valid] * 40
    assert (np.abs(steps - steps.round()) > 1e-3).any() == (spread == "interleaved")


def test_light_points_of_points_are_drawn_by_index(scene, floor_points):
    sphere = ss.SphereLight(radius=0.5, world_from_light=POSE)
    for light, apart in ((light_above(), False), (sphere, True)):
        points = ss.light_points(light, 16, floor_points, scene=scene, spread="decorrelated")
        assert points.positions.shape == (len(floor_points), 16, 3)
        first = ss.light_points(light, 16, floor_points[:5], scene=scene, spread="decorrelated")
        np.testing.assert_array_equal(points.positions[:5], first.positions)
        one_set = ss.light_points(light, 16, floor_points, scene=scene)
        assert one_set.parameters.shape == (16, 2)
        assert one_set.positions.shape == ((len(floor_points), 16, 3) if apart else (16, 3))


def test_silhouette_edges_see_the_samples_that_rays_see(scene):
    light, camera = light_above(), camera_above((32, 24))
    both = [
        visibility(scene, light, camera=camera, technique=technique, sample_masks=True)
        for technique in (ss.RayTraced(samples=64), ss.DepthComplexity(samples=64, exact_area=False))
    ]
    rays, edges = (result.visible_samples for result in both)
    assert edges.shape == (24, 32, 64)
    np.testing.assert_array_equal(rays, edges)
    assert (~edges).sum() > 100
    assert edges.sum() > 100
    np.testing.assert_array_equal(both[0].values, both[1].values)
    assert both[1].info["silhouette_edges"] > 0
    assert both[1].info["area_receivers"] == 0
    by_area = visibility(scene, light, camera=camera, technique=ss.DepthComplexity())
    assert by_area.info["area_receivers"] > 0
    assert by_area.info["notes"] == []
    difference = np.abs(by_area.values - both[1].values)[by_area.valid]
    assert 0 < difference.max() < 0.1, "areas differ from samples by no more than samples from the truth"


@pytest.mark.parametrize("settings", [{}, {"base": 64, "batches": 2}, {"initial_counts": "z_fail"}])
def test_wedges_see_the_samples_that_tiles_see(scene, settings):
    light, camera = light_above(), camera_above((32, 24))
    drawn = ss.DepthComplexity(evaluation="blended", **settings)
    assert drawn == ss.DepthComplexity(evaluation="blended", counters="words", **settings)
    tiles, wedges = (
        visibility(scene, light, camera=camera, technique=technique, sample_masks=True)
        for technique in (ss.DepthComplexity(exact_area=False), drawn)
    )
    np.testing.assert_array_equal(tiles.visible_samples, wedges.visible_samples)
    np.testing.assert_array_equal(tiles.values, wedges.values)
    assert (~wedges.visible_samples).sum() > 100
    assert wedges.info["silhouette_edges"] > 0
    assert "list wedges" in wedges.info["plan"]
    assert wedges.info["area_receivers"] == 0
    assert any("exact_area" in note for note in wedges.info["notes"])


def test_triangles_see_the_samples_that_edges_see_and_info_says_which(scene):
    light, camera = light_above(), camera_above((32, 24))
    edges, triangles = (
        visibility(
            scene,
            light,
            camera=camera,
            technique=ss.DepthComplexity(exact_area=False, unit=unit),
            sample_masks=True,
        )
        for unit in ("edges", "triangles")
    )
    np.testing.assert_array_equal(edges.visible_samples, triangles.visible_samples)
    assert (~triangles.visible_samples).sum() > 100
    assert (edges.info["occluder_units"], triangles.info["occluder_units"]) == (["edges"], ["triangles"])
    assert triangles.info["silhouette_edges"] == 0


def test_light_points_of_a_sphere_fill_its_disc_as_each_receiver_sees_it(scene, floor_points):
    light = ss.SphereLight(radius=0.5, world_from_light=POSE)
    points = ss.light_points(light, 32, floor_points, scene=scene)
    assert points.positions.shape == (len(floor_points), 32, 3)
    towards, center = points.positions - floor_points[:, None], POSE[:3, 3] - floor_points[:, None]
    distance = np.linalg.norm(center, axis=-1)
    cosine = (towards * center).sum(axis=-1) / np.linalg.norm(towards, axis=-1) / distance
    angle, half_angle = np.arccos(cosine), np.arcsin(0.5 / distance)
    assert (angle <= half_angle + 1e-5).all()
    assert (angle.max(axis=1) > 0.9 * half_angle[:, 0]).all()


def test_visibility_png_is_sixteen_bit_linear_grey(scene, tmp_path):
    result = visibility(scene, light_above(), camera=camera_above((31, 17)))
    result.save(tmp_path / "map.PNG")
    read = read_png(tmp_path / "map.PNG")
    assert read.max() > 255
    expected = np.round(np.nan_to_num(result.values.astype(np.float64), nan=0.0) * 65535)
    np.testing.assert_array_equal(read, expected)
    assert result._repr_png_() == (tmp_path / "map.PNG").read_bytes()


def test_npy_holds_the_values(scene, tmp_path):
    result = visibility(scene, [light_above(), light_above(2.0)], camera=camera_above())
    result.save(tmp_path / "map.npy")
    np.testing.assert_array_equal(np.load(tmp_path / "map.npy"), result.values)


def test_no_points_are_a_table_without_rows(scene, tmp_path):
    visibility(scene, light_above(), points=np.empty((0, 3))).save(tmp_path / "none.csv")
    assert (tmp_path / "none.csv").read_text().splitlines() == ["x,y,z,visibility,standard_error,valid"]


def test_what_cannot_be_saved_is_refused(scene, floor_points, tmp_path):
    several = visibility(scene, [light_above()], camera=camera_above())
    points = visibility(scene, light_above(), points=floor_points)
    for result in (several, points):
        assert result._repr_png_() is None
        with pytest.raises(ss.SettingsError, match="npy"):
            result.save(tmp_path / "map.png")
    for name in ("map.tif", "map", "map.png.txt"):
        with pytest.raises(ss.SettingsError, match="unknown format"):
            points.save(tmp_path / name)
    with pytest.raises(ss.SettingsError, match="path"):
        points.save(3)
    with pytest.raises(FileNotFoundError):
        points.save(tmp_path / "nowhere" / "map.npy")
    assert list(tmp_path.iterdir()) == []


def test_pictures(scene, tmp_path):
    light, camera = light_above(radiance=(30, 20, 10)), camera_above((31, 17))
    picture = render(scene, light, camera=camera, background=(0.25, 0.5, 1))
    assert picture.linear.shape == picture.srgb.shape == (17, 31, 3)
    assert picture.linear.dtype == np.float32
    assert picture.info["technique"]["name"] == "ray_traced"
    nothing = ~picture.visibility.valid
    np.testing.assert_array_equal(picture.linear[nothing], [[0.25, 0.5, 1]] * nothing.sum())
    red, green, _ = np.moveaxis(picture.linear[~nothing], -1, 0)
    np.testing.assert_allclose(green, red * 2 / 3, rtol=1e-4)
    clipped = np.clip(picture.linear.astype(np.float64), 0, 1)
    encoded = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(picture.srgb, encoded * 255, atol=0.51)
    picture.save(tmp_path / "a.png")
    np.testing.assert_array_equal(read_png(tmp_path / "a.png"), picture.srgb)
    picture.save(tmp_path / "a.npy")
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), picture.linear)
    np.testing.assert_array_equal(read_png(io.BytesIO(picture._repr_png_())), picture.srgb)


def test_exposure_shading_and_lights_add_up_in_pictures(scene):
    light, camera = light_above(radiance=(5, 5, 5)), camera_above()
    base = render(scene, light, camera=camera)
    brighter = render(scene, light, camera=camera, exposure=1)
    np.testing.assert_allclose(brighter.linear, base.linear * 2, rtol=1e-6)
    twice = render(scene, [light, light], camera=camera)
    np.testing.assert_allclose(twice.linear, base.linear * 2, rtol=1e-5)
    assert twice.visibility.values.shape == (2, 12, 16)
    modulated = render(scene, light, camera=camera, shading="modulated")
    assert not np.array_equal(modulated.linear, base.linear)
    lit = base.visibility.values == 1
    np.testing.assert_allclose(modulated.linear[lit], base.linear[lit], rtol=1e-4)


def test_comparisons(scene):
    techniques = [ss.RayTraced(samples=4), ss.RayTraced(samples=256), ss.HardShadowMap(resolution=512)]
    reference = ss.RayTraced(samples=1024, pattern="low_discrepancy")
    camera = camera_above((32, 24))
    result = compare(scene, light_above(), camera=camera, techniques=techniques, reference=reference, repeats=1)
    few, many, hard = (row["penumbra"]["rmse"] for row in result.rows)
    assert many < few < hard
    assert result.reference["technique"]["samples"] == 1024
    assert [row["technique"]["name"] for row in result.rows] == [
        "ray_traced",
        "ray_traced",
        "hard_shadow_map",
    ]
    lines = str(result).splitlines()
    assert len(lines) == 4
    assert "hard_shadow_map(resolution=512)" in lines[3]
    assert json.loads(result.to_json())["rows"] == result.rows


def test_defaults_are_those_of_the_library(scene, floor_points):
    from softshadow import _core  # noqa: TID251 - what the defaults are compared with

    every = (ss.RayTraced, ss.HardShadowMap, ss.OcclusionCamera, ss.OcclusionLayers, ss.PenumbraMap, ss.DepthComplexity)
    kinds: dict[str, type[ss.Technique]] = {kind.name: kind for kind in every}
    for row in json.loads(_core.technique_defaults()):
        kind = kinds[row["name"]]
        assert json.loads(kind().to_json()) == row
    info = visibility(scene, light_above(), points=floor_points).info
    assert info["technique"] == json.loads(ss.RayTraced().to_json())


def test_doctor_lists_adapters():
    found = ss.doctor()
    assert found.version == ss.__version__
    assert found.adapters
    assert found.chosen in str(found)
    assert all(adapter["name"] in str(found) for adapter in found.adapters)
    json.dumps(found.to_dict())


def test_doctor_says_what_is_slow_and_known_bad():
    by_backend = {adapter["backend"]: adapter for adapter in ss.doctor().adapters if adapter["mesa"]}
    software = by_backend["vulkan"]
    assert re.fullmatch(r"\d+\.\d+\.\d+", software["mesa"])
    assert software["mesa"] in software["driver"]
    said = "\n".join(software["remarks"])
    for words in ("slow: a driver that computes on the processor", "65,535 steps", "clock", "128 MiB"):
        assert words in said
        assert words in str(ss.doctor())
    if "gl" in by_backend:
        assert "float32" in "\n".join(by_backend["gl"]["remarks"])


def test_doctor_has_nothing_to_remark_on_a_good_card():
    card = {
        "name": "card",
        "backend": "vulkan",
        "device_type": "gpu",
        "driver": "NVIDIA 550.1",
        "storage_binding_bytes": 1 << 31,
        "texture_size": 32768,
        "features": ["timestamp-query", "float32-blendable"],
    }
    assert diagnosis.described(card) == card | {"mesa": None, "remarks": []}
    slow = diagnosis.described(card | {"features": [], "storage_binding_bytes": 1 << 27, "backend": "gl"})
    assert [words.split(":")[0].split(" (")[0] for words in slow["remarks"]] == [
        "no clock",
        "does not blend float32",
        "small storage bindings",
        "slow to open, and taken only where nothing else answers or by its index",
    ]
    assert diagnosis.described(card | {"driver": "radv Mesa 24.1"})["mesa"] == "24.1"


@pytest.mark.parametrize(
    ("release", "command"),
    [
        ({"ID": "debian"}, "`apt-get install -y mesa-vulkan-drivers libvulkan1`"),
        ({"ID": "linuxmint", "ID_LIKE": "ubuntu debian"}, "`apt-get install"),
        ({"ID": "rocky", "ID_LIKE": "rhel centos fedora"}, "`dnf install"),
        ({"ID": "arch"}, "`pacman"),
        ({"ID": "beos"}, "no command is known for this system"),
        ({}, "no command is known for this system"),
    ],
)
def test_doctor_has_the_command_that_installs_a_driver(release, command, monkeypatch):
    monkeypatch.setattr(diagnosis, "_os_release", lambda: release)
    monkeypatch.setattr(diagnosis._core, "adapters", lambda: "[]")
    found = ss.doctor()
    assert any(command in words for words in found.advice)
    assert "no graphics driver" in str(found)


def test_doctor_says_what_the_environment_chooses_and_which_extras_are_there(monkeypatch):
    monkeypatch.delenv("SOFTSHADOW_DEVICE", raising=False)
    assert ss.doctor().advice == []
    monkeypatch.setenv("SOFTSHADOW_DEVICE", "toaster")
    found = ss.doctor()
    assert found.chosen is None
    assert "SOFTSHADOW_DEVICE=toaster overrides device='auto'" in str(found)
    assert found.extras == {"trimesh": True, "plot": True, "progress": True}
    assert "extras: trimesh yes, plot yes, progress yes" in str(found)
    monkeypatch.setitem(sys.modules, "tqdm", None)
    assert not ss.doctor().extras["progress"]


def test_the_occlusion_camera_is_soft_and_says_what_it_did(scene, floor_points):
    technique = ss.OcclusionCamera(resolution=256, bias=0.1)
    result = visibility(scene, light_above(), points=floor_points, technique=technique)
    assert ((result.values > 0.05) & (result.values < 0.95)).any()
    assert result.info["technique"] == {
        "name": "occlusion_camera",
        "resolution": 256,
        "steps": 3,
        "bias": pytest.approx(0.1),
        "ramp": "outline",
    }
    assert result.info["camera_steps"] in (1, 2, 3)
    assert result.info["camera_bias"] > 0
    assert result.info["colliding_receivers"] >= 0
