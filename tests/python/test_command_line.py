"""The command line, in processes of its own."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, read_png, visibility
from softshadow.cli import main

SMALL = ["--size", "24x16", "--device", "software"]


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "softshadow", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.fixture
def mesh_file(tmp_path):
    path = tmp_path / "card.obj"
    joined = trimesh.Trimesh(np.concatenate([FLOOR, CARD]), np.concatenate([SQUARE, SQUARE + 4]), process=False)
    joined.export(path)
    return path


def test_a_shipped_scene_becomes_a_picture(tmp_path):
    out, info = tmp_path / "hall.png", tmp_path / "hall.json"
    done = run("render", "hall", "-o", out, "--info", info, "--json", *SMALL)
    assert done.returncode == 0, done.stderr
    assert read_png(out).shape == (16, 24, 3)
    assert json.loads(done.stdout) == json.loads(info.read_text())
    assert json.loads(done.stdout)["size"] == [24, 16]
    assert "hall.png: 24 × 16, ray_traced" in done.stderr


def test_options_mean_what_they_mean_in_python(tmp_path, mesh_file):
    out = tmp_path / "map.npy"
    done = run(
        *("visibility", mesh_file, "-o", out, *SMALL),
        *("--light", "rect:width=1,height=0.5,position=0/3/0,target=0/0/0"),
        *("--camera", "eye=3/4/3,target=0/0/0,fov=50"),
        *("--technique", "ray-traced:samples=9,seed=5,spread=interleaved,tile=2"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    light = ss.RectLight(width=1, height=0.5, world_from_light=ss.look_at((0, 3, 0), (0, 0, 0)))
    camera = ss.Camera.look_at(eye=(3, 4, 3), target=(0, 0, 0), fov_y_deg=50, size=(24, 16))
    technique = ss.RayTraced(samples=9, seed=5, spread="interleaved", tile=2)
    expected = visibility(ss.Scene.load(mesh_file), light, camera=camera, technique=technique).values
    np.testing.assert_array_equal(np.load(out), expected)


def test_a_file_alone_is_lit_from_above_and_all_in_view(tmp_path, mesh_file):
    out = tmp_path / "map.npy"
    assert main(["visibility", str(mesh_file), "-o", str(out), *SMALL]) == 0
    values = np.load(out)
    seen = np.isfinite(values)
    assert seen.sum() > 40
    assert not seen[0].any()
    assert not seen[:, 0].any()
    assert np.nanmin(values) < 0.2
    assert np.nanmax(values) == 1


@pytest.mark.parametrize(
    "light",
    [
        "disc:radius=0.3,position=0/3/0",
        "sphere:radius=0.3,position=0/3/0",
        "sun:azimuth=40,elevation=60,up=y",
    ],
)
def test_every_kind_of_light(tmp_path, mesh_file, light):
    out = tmp_path / "map.npy"
    assert main(["visibility", str(mesh_file), "-o", str(out), "--light", light, *SMALL]) == 0
    assert np.nanmin(np.load(out)) < 0.5


def test_several_lights_are_added_in_a_picture(tmp_path, mesh_file):
    out = tmp_path / "a.png"
    lights = [
        "--light",
        "sun:azimuth=40,elevation=60",
        "--light",
        "disc:radius=0.3,position=0/3/0,radiance=9/9/9",
    ]
    assert main(["render", str(mesh_file), "-o", str(out), *lights, *SMALL]) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["render", "nowhere", "-o", "a.png"], "hall"),
        (["render", "nowhere.glb", "-o", "a.png"], "nowhere.glb"),
        (["render", "hall", "-o", "a.bmp"], "unknown format '.bmp'"),
        (["render", "hall", "-o", "no/such/folder/a.png"], "no/such/folder"),
        (["render", "hall"], "required"),
        (["render", "hall", "-o", "a.png", "--size", "4"], "1024x768"),
        (["render", "hall", "-o", "a.png", "--size", "0x4", "--device", "software"], "camera width"),
        (["render", "hall", "-o", "a.png", "--size", "99999x4", "--device", "software"], "99999"),
        (["render", "hall", "-o", "a.png", "--light", "lamp:"], "unknown light"),
        (["render", "hall", "-o", "a.png", "--light", "rect:width=1,height=1"], "lacks position"),
        (["render", "hall", "-o", "a.png", "--light", "rect:widht=1"], "unknown 'widht'"),
        (["render", "hall", "-o", "a.png", "--light", "disc:radius=-1,position=0/1/0"], "radius"),
        (["render", "hall", "-o", "a.png", "--light", "disc:radius=x,position=0/1/0"], "number"),
        (["render", "hall", "-o", "a.png", "--light", "disc:radius=1,position=0/0/0"], "same point"),
        (["render", "hall", "-o", "a.png", "--camera", "eye=0/0,target=0/0/0"], "three numbers"),
        (["render", "hall", "-o", "a.png", "--camera", "eye=0/0/0,target=0/0/0"], "same point"),
        (["render", "hall", "-o", "a.png", "--technique", "magic"], "hard-shadow-map"),
        (["render", "hall", "-o", "a.png", "--technique", "ray-traced:samples=0"], "32768"),
        (["render", "hall", "-o", "a.png", "--technique", "ray-traced:samples=x"], "whole number"),
        (["render", "hall", "-o", "a.png", "--technique", "ray-traced:spread=wide"], "'wide' is none of"),
        (["render", "hall", "-o", "a.png", "--technique", "depth-complexity:spread=interleaved,tile=1"], "2 and 8"),
        (["render", "hall", "-o", "a.png", "--technique", "depth-complexity:exact_area=maybe"], "true or false"),
        (["render", "hall", "-o", "a.png", "--technique", "depth-complexity:base=64"], "'blended' alone"),
        (["render", "hall", "-o", "a.png", "--technique", "depth-complexity:evaluation=blended,base=9"], "64 or 256"),
        (["render", "hall", "-o", "a.png", "--technique", "depth-complexity:unit=leaves"], "triangles"),
        (["render", "hall", "-o", "a.png", "--device", "toaster"], "toaster"),
        ([], "required"),
    ],
)
def test_mistakes_end_with_two_and_a_message(arguments, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    try:
        code = main(arguments)
    except SystemExit as end:
        code = end.code
    said = capsys.readouterr()
    assert code == 2
    assert words in said.err
    assert "Traceback" not in said.err
    assert list(tmp_path.iterdir()) == []


def test_mistakes_in_a_process_have_no_traceback():
    done = run("render", "nowhere.glb", "-o", "a.png")
    assert done.returncode == 2
    assert "nowhere.glb" in done.stderr
    assert "Traceback" not in done.stderr


def test_no_device_ends_with_one(capsys, tmp_path):
    out = tmp_path / "a.png"
    assert main(["render", "hall", "-o", str(out), "--size", "8x8", "--device", "999"]) == 1
    assert "999" in capsys.readouterr().err


def test_doctor(capsys):
    assert main(["doctor", "--quick"]) == 0
    assert "device='auto' takes" in capsys.readouterr().out
    assert main(["doctor", "--quick", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["version"] == ss.__version__


def test_the_version(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--version"])
    assert capsys.readouterr().out == f"softshadow {ss.__version__}\n"
