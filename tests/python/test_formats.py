"""Scenes from every format, results to every format, and what the command line makes of both."""

from __future__ import annotations

import csv
import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import FLOOR, SQUARE, camera_above, light_above, read_png, render, visibility
from softshadow import cli

SMALL = ["--size", "24x16", "--device", "software"]
FEW = ss.RayTraced(samples=9)


def cube_on_floor() -> trimesh.Trimesh:
    """Coordinates that float32 holds, so that all formats can hold them."""
    box = trimesh.creation.box(bounds=[[-0.5, 0.25, -0.5], [0.5, 1.25, 0.5]])
    faces = np.concatenate([SQUARE, box.faces + 4])
    return trimesh.Trimesh(np.concatenate([FLOOR, box.vertices]), faces, process=False)


def big_endian_ply(mesh: trimesh.Trimesh) -> bytes:
    header = (
        f"ply\nformat binary_big_endian 1.0\nelement vertex {len(mesh.vertices)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.zeros(len(mesh.faces), [("count", "u1"), ("corners", ">i4", 3)])
    rows["count"], rows["corners"] = 3, mesh.faces
    return header.encode() + mesh.vertices.astype(">f4").tobytes() + rows.tobytes()


WRITERS = {
    "cube.obj": lambda mesh: mesh.export(file_type="obj").encode(),
    "cube.glb": lambda mesh: mesh.export(file_type="glb"),
    "cube.stl": lambda mesh: mesh.export(file_type="stl"),
    "ascii.stl": lambda mesh: mesh.export(file_type="stl_ascii").encode(),
    "cube.ply": lambda mesh: mesh.export(file_type="ply"),
    "ascii.ply": lambda mesh: mesh.export(file_type="ply", encoding="ascii"),
    "big.ply": big_endian_ply,
}


def values_of(scene: ss.Scene) -> np.ndarray:
    return visibility(scene, light_above(), camera=camera_above((24, 18)), technique=FEW).values


def write_scene(folder: Path, **fields: object) -> Path:
    """A scene.json with the cube as OBJ beside it."""
    (folder / "cube.obj").write_bytes(WRITERS["cube.obj"](cube_on_floor()))
    path = folder / "scene.json"
    path.write_text(json.dumps({"softshadow": 1, "meshes": [{"path": "cube.obj"}], **fields}))
    return path


LIGHTS = [
    {"type": "RectLight", "name": "key", "width": 1, "height": 0.5, "translate": [0, 3, 0], "target": [0, 0, 0]},
    {"type": "DiskLight", "radius": 0.25, "translate": [2, 3, 0], "target": [0, 0, 0], "color": [1, 0.5, 0.25]},
]
VIEW = {"eye": [3, 4, 3], "target": [0, 0, 0], "fov_y_deg": 50, "size": [24, 16]}


@pytest.mark.parametrize("name", WRITERS)
def test_a_cube_is_the_same_through_every_format(tmp_path, name):
    mesh = cube_on_floor()
    expected = values_of(ss.Scene.from_trimesh(mesh))
    assert 0 < np.nanmin(expected) + 1 < np.nanmax(expected) + 1
    path = tmp_path / name
    path.write_bytes(WRITERS[name](mesh))
    scene = ss.Scene.load(path)
    assert scene.triangle_count == 14
    np.testing.assert_array_equal(values_of(scene), expected)
    described = tmp_path / "scene.json"
    described.write_text(json.dumps({"softshadow": 1, "meshes": [{"path": name}]}))
    np.testing.assert_array_equal(values_of(ss.Scene.load(described)), expected)


def meshes_folder() -> Path:
    folder = Path(os.environ.get("SOFTSHADOW_MESHES", "../shared/meshes"))
    if not folder.is_dir():
        pytest.skip("no public meshes: set SOFTSHADOW_MESHES to their folder")
    return folder


def test_real_models_as_ply_and_stl_can_be_read():
    paths = [path for path in sorted(meshes_folder().iterdir()) if path.suffix.lower() in (".ply", ".stl")]
    if not paths:
        pytest.skip("no .ply and no .stl among the public meshes")
    for path in paths:
        theirs = trimesh.load(path, process=False)
        scene = ss.Scene.load(path)
        assert scene.triangle_count == len(theirs.faces), path
        np.testing.assert_allclose(scene.bounds, theirs.bounds, rtol=1e-6, err_msg=str(path))


@pytest.mark.parametrize("name", ["fandisk", "spot"])
def test_a_real_model_is_the_same_as_ply_and_stl(tmp_path, name):
    path = meshes_folder() / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"{path.name} is not among the public meshes")
    meshes = ss.Scene.load(path).meshes
    mesh = trimesh.Trimesh(meshes[0].vertices.astype(np.float32), meshes[0].faces, process=False)
    original = ss.Scene.from_trimesh(mesh)
    low, high = original.bounds
    top = (high - low).max()
    middle = (low + high) / 2
    light = ss.RectLight(width=top, height=top, world_from_light=ss.look_at(middle + [0.1 * top, 2 * top, 0], middle))
    camera = ss.Camera.look_at(eye=middle + [top, top, 2 * top], target=middle, fov_y_deg=40, size=(24, 18))

    def seen(scene: ss.Scene) -> np.ndarray:
        return visibility(scene, light, camera=camera, technique=FEW).values

    expected = seen(original)
    assert np.isfinite(expected).sum() > 30
    for writer in ("cube.stl", "ascii.ply", "cube.ply", "big.ply"):
        other = tmp_path / writer
        other.write_bytes(WRITERS[writer](mesh))
        np.testing.assert_array_equal(seen(ss.Scene.load(other)), expected, err_msg=writer)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 9999999999\nproperty float x\nend_header\n", "announced"),
        ("a.stl", bytes(80) + b"\xff\xff\xff\xff" + bytes(50), "4294967295 triangles"),
        ("a.stl", b"solid\nfacet\nouter loop\nvertex 0 0 0\n", "it is truncated"),
        ("a.json", b'{"softshadow": 1, "meshes": [{"path": "b.obj", "colour": 1}]}', "meshes[0].colour"),
        ("a.json", b'{"softshadow": 7, "meshes": []}', "version 7 cannot be read"),
        ("a.json", b'{"softshadow": 1, "meshes": [{"path": "a.json"}]}', "cannot hold another"),
        ("a.json", b"[" * 100_000, "line 1"),
        ("a.fbx", b"", ".ply, .stl and .json"),
    ],
)
def test_broken_files_are_refused(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    for read in (ss.Scene.load, ss.load):
        with pytest.raises(ss.SceneError) as caught:
            read(path)
        assert words in str(caught.value)


def test_mesh_files_that_are_missing_or_not_files_are_named(tmp_path):
    path = write_scene(tmp_path, meshes=[{"path": "nowhere.ply"}])
    with pytest.raises(ss.SceneFileNotFound, match=r"nowhere\.ply"):
        ss.load(path)
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(ss.SceneError, match="not a regular file"):
        ss.load(write_scene(tmp_path, meshes=[{"path": "folder.obj"}]))
    inner = tmp_path / "inner"
    inner.mkdir()
    assert ss.load(write_scene(inner, meshes=[{"path": "../cube.obj"}])).scene.triangle_count == 14
    with pytest.raises(ss.SceneError, match="a path expected"):
        ss.load(3)


def test_a_scene_file_brings_lights_and_a_camera(tmp_path):
    sun = {"type": "DistantLight", "angle": 2, "rotate_xyz_deg": [-60, 30, 0], "intensity": 2, "exposure": 1}
    ball = {"type": "SphereLight", "name": "ball", "radius": 0.1, "translate": [1, 2, 3]}
    file = ss.load(write_scene(tmp_path, lights=[*LIGHTS, sun, ball], camera=VIEW, meters_per_unit=0.01))
    key, disc, distant, sphere = file.lights
    assert key == ss.RectLight(
        width=1, height=0.5, world_from_light=ss.look_at((0, 3, 0), (0, 0, 0)), radiance=(1, 1, 1), name="key"
    )
    assert disc.radiance == (1, 0.5, 0.25)
    assert (sphere.name, sphere.radius, sphere.world_from_light[:3, 3].tolist()) == ("ball", 0.1, [1, 2, 3])
    assert distant.radiance == (4, 4, 4)
    # Turned about X by −60 degrees, its −Z points down; about Y by 30 more, it comes from the south-east.
    assert distant == ss.SunLight(
        distant.azimuth, distant.elevation, diameter_deg=distant.diameter_deg, radiance=(4, 4, 4)
    )
    np.testing.assert_allclose([distant.azimuth, distant.elevation, distant.diameter_deg], [150, 60, 2])
    assert file.camera == ss.Camera.look_at(eye=(3, 4, 3), target=(0, 0, 0), fov_y_deg=50, size=(24, 16))
    assert file.meters_per_unit == 0.01
    assert repr(file) == "<SceneFile: 14 triangles, 4 lights, a camera>"
    result = visibility(file.scene, file.lights, camera=file.camera, technique=FEW)
    assert result.values.shape == (4, 16, 24)
    assert result.light_names == ("key", "light1", "light2", "ball")
    (tmp_path / "cube.glb").write_bytes(WRITERS["cube.glb"](cube_on_floor()))
    plain = ss.load(tmp_path / "cube.glb")
    assert (plain.lights, plain.camera, plain.meters_per_unit) == ((), None, 1.0)
    assert ss.load(tmp_path / "cube.obj").meters_per_unit is None


def test_the_example_of_the_documentation_can_be_read(tmp_path):
    text = ss.load.__doc__
    text = text[text.index('{"softshadow"') : text.index("Lengths are in")]
    cube_on_floor().export(tmp_path / "bunny.ply")
    (tmp_path / "example.json").write_text(text)
    file = ss.load(tmp_path / "example.json")
    assert [type(light) for light in file.lights] == [ss.RectLight, ss.SunLight]
    assert file.camera.size == (640, 480)
    assert file.scene.meshes[0].base_color == pytest.approx((0.8, 0.4, 0.2))


def test_meshes_are_scaled_to_the_unit_of_the_scene(tmp_path):
    (tmp_path / "cube.glb").write_bytes(WRITERS["cube.glb"](cube_on_floor()))
    entries = [{"path": "cube.glb"}, {"path": "cube.obj"}, {"path": "cube.obj", "meters_per_unit": 0.1}]
    scene = ss.load(write_scene(tmp_path, meters_per_unit=0.01, meshes=entries)).scene
    widths = [np.ptp(mesh.vertices[:, 0]) for mesh in scene.meshes]
    np.testing.assert_allclose(widths, [800, 8, 80])


def test_cameras_of_trimesh_scenes_see_what_trimesh_sees():
    source = trimesh.Scene(cube_on_floor())
    # A wide image; setting K makes trimesh work the resolution out anew.
    source.camera = trimesh.scene.Camera(resolution=(40, 20), fov=(60, 32))
    source.camera.K = [[30.0, 0, 16], [0, 30.0, 10], [0, 0, 1]]
    source.camera_transform = source.camera.look_at(
        [[0, 0.5, 0]], rotation=ss.look_at((3, 4, 3), (0, 0, 0)), distance=4
    )
    camera = ss.Camera.from_trimesh(source.camera, source.camera_transform)
    assert camera.size == tuple(source.camera.resolution) == (32, 20)
    np.testing.assert_array_equal(camera.K, [[30, 0, 16], [0, 30, 10], [0, 0, 1]])
    # The pose itself, not its inverse: the eye stands above the floor, at the distance that was asked for.
    np.testing.assert_allclose(np.linalg.norm(camera.world_from_camera[:3, 3] - [0, 0.5, 0]), 4)
    result = visibility(ss.Scene.from_trimesh(source), light_above(), camera=camera, receivers=True, technique=FEW)
    origins, directions, pixels = source.camera_rays()
    rows, columns = camera.size[1] - 1 - pixels[:, 1], pixels[:, 0]
    hit = result.valid[rows, columns]
    assert hit.sum() > 100
    towards = result.positions[rows, columns][hit] - origins[hit]
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    np.testing.assert_allclose(towards, directions[hit], atol=1e-4)


def two_lights() -> list[ss.Light]:
    texture = np.random.default_rng(1).random((2, 2, 3))
    return [light_above(texture=texture), light_above(2.0, name="füll")]


def rows_of(path: Path) -> dict[str, np.ndarray]:
    with path.open(newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    return {name: np.array([float(row[k]) for row in rows]) for k, name in enumerate(names)}


def test_npz_holds_all_that_is_there(tmp_path, scene):
    result = visibility(scene, two_lights(), camera=camera_above(), technique=FEW, receivers=True)
    names = ("values", "valid", "standard_error", "positions", "normals", "triangles")
    result.save(tmp_path / "all.NPZ")
    with np.load(tmp_path / "all.NPZ", allow_pickle=False) as file:
        assert set(file) == {*names, "light_names", "info"}
        for name in names:
            np.testing.assert_array_equal(file[name], getattr(result, name))
        assert file["light_names"].tolist() == ["light0", "füll"]
        assert json.loads(str(file["info"])) == result.info
    picture = render(scene, light_above(), camera=camera_above(), technique=FEW)
    picture.save(tmp_path / "picture.npz")
    with np.load(tmp_path / "picture.npz") as file:
        np.testing.assert_array_equal(file["linear"], picture.linear)
        np.testing.assert_array_equal(file["srgb"], picture.srgb)
        np.testing.assert_array_equal(file["values"], picture.visibility.values)


def test_csv_of_points_gives_back_every_bit(tmp_path, scene, floor_points):
    points = np.tile(floor_points, (2000, 1)) + [1e-9, 0, 0.1]
    result = visibility(scene, two_lights(), points=points, technique=FEW)
    given = points.copy()
    points += 1  # What the caller does with his own array later does not matter.
    result.save(tmp_path / "points.csv")
    table = rows_of(tmp_path / "points.csv")
    of = [f"{name}.{channel}" for name in ("light0", "füll") for channel in "RGB"]
    expected = [*"xyz", *(f"visibility.{name}" for name in of), *(f"standard_error.{name}" for name in of), "valid"]
    assert list(table) == expected
    np.testing.assert_array_equal(np.stack([table[axis] for axis in "xyz"], axis=1), given)
    for word, array in (("visibility", result.values), ("standard_error", result.standard_error)):
        for light, name in enumerate(("light0", "füll")):
            for k, channel in enumerate("RGB"):
                read = table[f"{word}.{name}.{channel}"].astype(np.float32)
                np.testing.assert_array_equal(read, array[light, :, k])
    assert (table["valid"] == 1).all()


def test_csv_of_a_camera_names_pixels(tmp_path, scene):
    result = visibility(scene, light_above(), camera=camera_above(), technique=FEW, receivers=True)
    result.save(tmp_path / "map.csv")
    table = rows_of(tmp_path / "map.csv")
    assert list(table) == ["column", "row", "x", "y", "z", "visibility", "standard_error", "valid"]
    rows, columns = table["row"].astype(int), table["column"].astype(int)
    assert (rows.max(), columns.max()) == (11, 15)
    np.testing.assert_array_equal(table["visibility"].astype(np.float32), result.values[rows, columns])
    np.testing.assert_array_equal(table["valid"] == 1, result.valid[rows, columns])
    np.testing.assert_array_equal(table["z"], result.positions[rows, columns, 2])
    picture = render(scene, light_above(), camera=camera_above(), technique=FEW)
    picture.save(tmp_path / "picture.csv")
    table = rows_of(tmp_path / "picture.csv")
    assert list(table) == ["column", "row", "R", "G", "B", "valid"]
    np.testing.assert_array_equal(table["G"].astype(np.float32), picture.linear[rows, columns, 1])


def read_exr(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """Channels and the text of the attribute `softshadow`; only what OpenEXR calls ZIP with scan lines of float."""
    data = path.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01"
    attributes, place = {}, 8
    while data[place]:
        end = data.index(0, place)
        kind_end = data.index(0, end + 1)
        (size,) = struct.unpack_from("<i", data, kind_end + 1)
        attributes[data[place:end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        place = kind_end + 5 + size
    assert attributes["compression"] == b"\x03"
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    names, channels = [], attributes["channels"]
    while channels[0]:
        end = channels.index(0)
        assert struct.unpack_from("<i", channels, end + 1) == (2,)
        names.append(channels[:end].decode())
        channels = channels[end + 17 :]
    lines = []
    for chunk in range(-(-height // 16)):
        (offset,) = struct.unpack_from("<Q", data, place + 1 + 8 * chunk)
        y, size = struct.unpack_from("<2i", data, offset)
        assert y == 16 * chunk
        wanted = 4 * width * len(names) * min(16, height - y)
        raw = data[offset + 8 : offset + 8 + size]
        if size < wanted:
            steps = np.frombuffer(zlib.decompress(raw), np.uint8).astype(np.int64)
            steps[1:] -= 128
            halves = (np.cumsum(steps) % 256).astype(np.uint8)
            woven = np.empty(wanted, np.uint8)
            woven[::2], woven[1::2] = halves[: (wanted + 1) // 2], halves[(wanted + 1) // 2 :]
            raw = woven.tobytes()
        lines.append(np.frombuffer(raw, "<f4").reshape(-1, len(names), width))
    image = np.concatenate(lines)
    return {name: image[:, k] for k, name in enumerate(names)}, attributes["softshadow"].decode()


def test_exr_has_a_channel_for_each_light(tmp_path, scene):
    result = visibility(scene, two_lights(), camera=camera_above((20, 37)), technique=FEW, receivers=True)
    result.save(tmp_path / "map.exr")
    channels, info = read_exr(tmp_path / "map.exr")
    assert json.loads(info) == result.info
    for k, channel in enumerate("RGB"):
        for light, name in enumerate(("light0", "f_ll")):
            np.testing.assert_array_equal(channels.pop(f"visibility.{name}.{channel}"), result.values[light, ..., k])
            np.testing.assert_array_equal(
                channels.pop(f"standard_error.{name}.{channel}"), result.standard_error[light, ..., k]
            )
    for k, axis in enumerate("XYZ"):
        np.testing.assert_array_equal(channels.pop(f"position.{axis}"), result.positions[..., k].astype(np.float32))
        np.testing.assert_array_equal(channels.pop(f"normal.{axis}"), result.normals[..., k])
    np.testing.assert_array_equal(channels.pop("valid"), result.valid)
    assert not channels
    visibility(scene, light_above(), camera=camera_above(), technique=FEW, standard_error=False).save(
        tmp_path / "a.exr"
    )
    assert list(read_exr(tmp_path / "a.exr")[0]) == ["valid", "visibility"]


def test_exr_of_a_picture_has_linear_colours(tmp_path, scene):
    picture = render(scene, light_above(), camera=camera_above(), technique=FEW, exposure=6)
    picture.save(tmp_path / "picture.exr")
    channels, info = read_exr(tmp_path / "picture.exr")
    assert list(channels) == ["B", "G", "R"]
    for k, name in enumerate("RGB"):
        np.testing.assert_array_equal(channels[name], picture.linear[..., k])
    assert picture.linear.max() > 1
    assert json.loads(info) == picture.info


def test_lights_of_one_name_have_channels_of_their_own(scene):
    lights = [light_above(name=name) for name in ("a", "a", "", "light2", "a_1")]
    result = visibility(scene, lights, camera=camera_above(), technique=FEW)
    assert len(set(result.light_names)) == 5
    assert result.light_names[0] == "a"
    assert light_above(name="a") != light_above(name="b")


def test_what_a_format_cannot_hold_is_refused(tmp_path, scene, floor_points):
    at_points = visibility(scene, light_above(), points=floor_points, technique=FEW)
    with pytest.raises(ss.SettingsError, match="an EXR holds images"):
        at_points.save(tmp_path / "a.exr")
    with pytest.raises(ss.SettingsError, match="a PNG holds one grey image"):
        at_points.save(tmp_path / "a.png")
    with pytest.raises(ss.SettingsError, match=r"writable are \.png, \.npy, \.npz, \.csv, \.exr"):
        at_points.save(tmp_path / "a.tif")
    assert list(tmp_path.iterdir()) == []


def test_the_command_line_takes_lights_and_camera_of_a_scene_file(tmp_path, capsys):
    path = write_scene(tmp_path, lights=LIGHTS, camera=VIEW)
    out = tmp_path / "map.npz"
    assert cli.main(["visibility", str(path), "-o", str(out), "--device", "software", "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["size"] == [24, 16]
    assert "map.npz: 24 × 16, ray_traced" in said.err
    file = ss.load(path)
    expected = visibility(file.scene, file.lights, camera=file.camera)
    with np.load(out) as saved:
        np.testing.assert_array_equal(saved["values"], expected.values)
        assert saved["light_names"].tolist() == ["key", "light1"]


def test_options_go_before_what_a_scene_file_says(tmp_path):
    path = write_scene(tmp_path, lights=LIGHTS, camera=VIEW)
    out = tmp_path / "map.npy"
    light = ["--light", "rect:width=1,height=1,position=0/3/0"]
    camera = ["--camera", "eye=3/4/3,target=0/0/0,fov=50"]
    arguments = ["visibility", str(path), "-o", str(out), *light, *camera, "--size", "16x12", "--device", "software"]
    assert cli.main(arguments) == 0
    expected = visibility(ss.Scene.load(path), light_above(), camera=camera_above()).values
    np.testing.assert_array_equal(np.load(out), expected)


@pytest.mark.parametrize("command", ["render", "visibility"])
@pytest.mark.parametrize("extension", ["png", "npy", "npz", "csv", "exr"])
def test_every_command_writes_every_format(tmp_path, capsys, command, extension):
    out = tmp_path / f"out.{extension}"
    scene = write_scene(tmp_path, lights=LIGHTS[:1])
    assert cli.main([command, str(scene), "-o", str(out), *SMALL]) == 0
    assert capsys.readouterr().out == "", "stdout is for --json alone"
    reads = {"png": read_png, "npy": np.load, "npz": np.load, "csv": rows_of, "exr": read_exr}
    assert len(reads[extension](out)) > 0


def test_a_map_of_several_lights_is_no_png_and_that_is_said_before_any_work(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(cli, "_say_progress", pytest.fail)
    out = tmp_path / "map.png"
    assert cli.main(["visibility", str(write_scene(tmp_path, lights=LIGHTS)), "-o", str(out), *SMALL]) == 2
    assert "not one for each of 2 lights" in capsys.readouterr().err
    assert not out.exists()


def test_a_scene_file_without_lights_is_lit_from_above(tmp_path):
    described, plain = tmp_path / "described.npy", tmp_path / "plain.npy"
    assert cli.main(["visibility", str(write_scene(tmp_path)), "-o", str(described), *SMALL]) == 0
    assert cli.main(["visibility", str(tmp_path / "cube.obj"), "-o", str(plain), *SMALL]) == 0
    np.testing.assert_array_equal(np.load(described), np.load(plain))


def test_exit_codes_tell_mistakes_machines_and_people_apart(tmp_path, capsys, monkeypatch):
    scene, out = str(write_scene(tmp_path, lights=LIGHTS)), str(tmp_path / "a.exr")
    assert cli.main(["render", scene, "-o", out, *SMALL]) == 0
    assert cli.main(["render", scene, "-o", out, "--device", "999"]) == 1
    (tmp_path / "scene.json").write_text('{"softshadow": 1, "meshes": [], "ligths": []}')
    assert cli.main(["render", scene, "-o", out]) == 2
    assert "unknown field `ligths`" in capsys.readouterr().err

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "load", interrupted)
    assert cli.main(["render", scene, "-o", out]) == 130
    said = capsys.readouterr()
    assert (said.out, said.err) == ("", "interrupted\n")
