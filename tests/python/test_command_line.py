"""The command line, in processes of its own."""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
import trimesh

import softshadow as ss
from conftest import CARD, FLOOR, SQUARE, read_png, visibility
from softshadow import cli, cli_values
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
        (["gallery", "mona-lisa"], "unknown exhibit 'mona-lisa'; there are silhouettes"),
        (["gallery", "areas", "--size", "4"], "1024x768"),
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


def test_the_gallery_is_a_command(tmp_path):
    out = tmp_path / "gallery"
    done = run("gallery", "areas", "glass", "-o", out, "--size", "48x36", "--device", "software", "--json")
    assert done.returncode == 0, done.stderr
    made = json.loads(done.stdout)
    assert list(made["exhibits"]) == ["areas", "glass"]
    assert made["exhibits"]["areas"]["areas"]["rmse"] < made["exhibits"]["areas"]["samples"]["rmse"]
    assert made["page"] == str(out / "index.md")
    assert "llvmpipe" in made["device"]
    page = (out / "index.md").read_text()
    pictures = sorted(path.name for path in out.glob("*.png"))
    assert len(pictures) > 6
    assert all(f"({name})" in page for name in pictures)
    assert read_png(out / "areas_areas.png").shape == (36, 48, 3)
    said = done.stderr.splitlines()
    assert [line.split(",")[0] for line in said] == ["areas", "glass", f"page {out / 'index.md'}"]
    assert f"those of {made['device']}." in page


def test_progress_is_shown_on_a_terminal_alone(tmp_path, monkeypatch, capsys):
    arguments = ["visibility", "hall", "-o", str(tmp_path / "a.npy"), *SMALL]
    assert main(arguments) == 0
    assert "1 of 1" not in capsys.readouterr().err
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert "1 of 1" in said.err
    assert said.out == ""


# What an option changes: files, whether anything is printed, what is said of the result.
CHANGES = {
    "scene": ["fork"],
    "-o": ["-o", "other.npy"],
    "--light": ["--light", "sun:azimuth=40,elevation=60"],
    "--camera": ["--camera", "eye=9/9/9,target=0/0/0"],
    "--size": ["--size", "12x9"],
    "--technique": ["--technique", "hard-shadow-map"],
    "--device": ["--device", "native"],
    "--info": ["--info", "info.json"],
    "--json": ["--json"],
}
GALLERY_CHANGES = {"exhibits": ["glass"]} | {name: CHANGES[name] for name in ("-o", "--size", "--device", "--json")}
MADE = [("render", CHANGES), ("visibility", CHANGES), ("gallery", GALLERY_CHANGES)]
# Options that change which technique is chosen, tested in test_choice.py.
GOALS = {"--max-error", "--max-ms", "--error-norm"}
COMPARE_CHANGES = {name: CHANGES[name] for name in ("scene", "--light", "--camera", "--size", "--device", "--json")} | {
    "-o": ["-o", "other"],
    "--technique": ["--technique", "depth-complexity:samples=4"],
    "--reference": ["--reference", "ray-traced:samples=9"],
    "--repeats": ["--repeats", "2"],
}


def names_of(command: str) -> set[str]:
    """The arguments of a command, by their first name."""
    (commands,) = (action for action in cli._parser()._actions if isinstance(action.choices, dict))
    actions = commands.choices[command]._actions
    return {(action.option_strings or [action.dest])[0] for action in actions} - {"-h"}


def test_every_option_of_every_command_is_known_here():
    (commands,) = (action for action in cli._parser()._actions if isinstance(action.choices, dict))
    assert set(commands.choices) == {command for command, _ in MADE} | {"compare", "doctor"}
    for command, changes in MADE:
        assert names_of(command) == set(changes) | (GOALS if command == "visibility" else set())
    # Lines of other tracers are read by tests of reports.
    assert names_of("compare") == set(COMPARE_CHANGES) | {"--lines"}
    assert names_of("doctor") == {"--json", "--quick"}


def timeless(value: object, key: str = "") -> object:
    """Numbers of a report without its times: of those it keeps how many there are."""
    if isinstance(value, dict):
        return {name: timeless(inner, name) for name, inner in value.items() if name not in ("summary", "judgement")}
    if isinstance(value, list):
        return len(value) if "ms" in key else [timeless(inner, key) for inner in value]
    return 0 if "ms" in key else value


@pytest.mark.parametrize("option", COMPARE_CHANGES)
def test_every_option_of_compare_changes_something(option, tmp_path, monkeypatch, capsys):
    base = {"positional": ["hall"], "-o": ["-o", "report"], "--size": ["--size", "24x16"]}
    base |= {"--technique": ["--technique", "ray-traced:samples=4"], "--repeats": ["--repeats", "1"]}
    base |= {"--reference": ["--reference", "ray-traced:samples=16"], "--device": ["--device", "software"]}

    def made(folder: str, words: dict[str, list[str]]) -> tuple[bool, list[str], object]:
        (tmp_path / folder).mkdir()
        monkeypatch.chdir(tmp_path / folder)
        assert main(["compare", *chain(*words.values())]) == 0
        (page,) = Path().rglob("report.json")
        files = sorted(str(path) for path in Path().rglob("*.*") if path.is_file())
        return bool(capsys.readouterr().out), files, timeless(json.loads(page.read_text()))

    plain, again = made("plain", base), made("again", base)
    assert plain == again, "nothing changes by itself"
    changed = base | {option if option.startswith("-") else "positional": COMPARE_CHANGES[option]}
    assert made("changed", changed) != plain


@pytest.mark.parametrize(("command", "option"), [(command, option) for command, known in MADE for option in known])
def test_every_option_changes_something(command, option, tmp_path, monkeypatch, capsys):
    source = {"gallery": ["areas"]}.get(command, ["hall"])
    base = {"-o": ["-o", "map.npy"], "--size": ["--size", "24x16"], "--device": ["--device", "software"]}
    change = dict(MADE)[command][option]

    def made(folder: str, *arguments: str) -> tuple[bool, str, dict[str, bytes]]:
        (tmp_path / folder).mkdir()
        monkeypatch.chdir(tmp_path / folder)
        assert main([command, *arguments]) == 0
        said = capsys.readouterr()
        words = re.sub(r"\d[\d.]* m?s\b", "", said.err)
        files = {str(path.relative_to(".")): path for path in sorted(Path().rglob("*.*")) if path.is_file()}
        pictures = {name: path.read_bytes() for name, path in files.items() if path.suffix in (".npy", ".png")}
        return bool(said.out), words if option == "--device" else "", dict.fromkeys(files, b"") | pictures

    plain = {"positional": source} | base
    changed = plain | {option if option.startswith("-") else "positional": change}
    one, other = (made(name, *chain(*words.values())) for name, words in (("plain", plain), ("changed", changed)))
    assert one != other


PLACED = {"position": "0/3/0", "target": "1/0/0", "up": "0/0/1", "radiance": "3/2/1"}
WORDS = {
    "rect": (PLACED | {"width": "2", "height": "2"}, "width=1,height=1,position=0/4/0"),
    "disc": (PLACED | {"radius": "2"}, "radius=1,position=0/4/0"),
    "sphere": (PLACED | {"radius": "2"}, "radius=1,position=0/4/0"),
    "sun": (
        {"azimuth": "9", "elevation": "9", "diameter": "9", "up": "z", "radiance": "3/2/1"},
        "azimuth=1,elevation=2",
    ),
}


@pytest.mark.parametrize(("kind", "word"), [(kind, word) for kind, (words, _) in WORDS.items() for word in words])
def test_every_word_of_a_light_changes_it(kind, word):
    words, base = WORDS[kind]
    with pytest.raises(argparse.ArgumentTypeError, match="unknown 'x'; there are") as error:
        cli_values.parse_light(f"{kind}:x=1")
    assert sorted(str(error.value).split("there are ")[1].split(", ")) == sorted(words)
    before = ",".join(pair for pair in base.split(",") if not pair.startswith(f"{word}="))
    assert cli_values.parse_light(f"{kind}:{before},{word}={words[word]}") != cli_values.parse_light(f"{kind}:{base}")


@pytest.mark.parametrize("word", ["eye=1/2/4", "target=1/0/0", "up=1/0/0", "fov=50"])
def test_every_word_of_a_camera_changes_it(word):
    base = {"eye": "1/2/3", "target": "0/0/0"}
    name, value = word.split("=")
    text = ",".join(f"{name}={value}" for name, value in (base | {name: value}).items())
    plain = ",".join(f"{name}={value}" for name, value in base.items())
    assert cli_values.parse_camera(text)((4, 3)) != cli_values.parse_camera(plain)((4, 3))


def test_doctor(capsys):
    assert main(["doctor", "--quick"]) == 0
    assert "device='auto' takes" in capsys.readouterr().out
    assert main(["doctor", "--quick", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["version"] == ss.__version__


def test_the_version(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--version"])
    assert capsys.readouterr().out == f"softshadow {ss.__version__}\n"
