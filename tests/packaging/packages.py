"""Makes the packages that would be published and tries them where nothing of this checkout is at hand.

Run by ``make package``. The sdist is unpacked and built the way pip builds it, but with the workspace's build folder:
only the crates of this workspace are compiled again. Its wheel is installed in an empty virtual environment and used
from another folder.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from email.message import Message
from email.parser import HeaderParser
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PLACE = TARGET / "packages"
LICENCES = {"LICENSE-MIT", "LICENSE-APACHE"}
# What a wheel may be made of: each asks for its notice at most.
PERMISSIVE = {
    *("0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "CC0-1.0", "ISC", "MIT", "MIT-0", "Unicode-3.0"),
    *("Unlicense", "Zlib"),
}


def run(*command: str | Path, cwd: Path = ROOT, **environment: str) -> str:
    """The output of a program that has to succeed."""
    # The build backend is a program, which pip looks for.
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env={**os.environ, "PATH": path, **environment},
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


def expect(holds: bool, words: str) -> None:
    """Ends with words unless something holds."""
    if not holds:
        sys.exit(f"packages: {words}")


def unpack(archive: Path, place: Path) -> set[str]:
    """Puts the files of an archive in a folder, and gives their paths.

    What is there with the same bytes keeps its date, and is not compiled again; archives have one date for all.
    """
    with tarfile.open(archive) as tar:
        members = {member.name: member for member in tar.getmembers() if member.isfile()}
        for name, member in members.items():
            path, file = place / name, tar.extractfile(member)
            content = file.read() if file else b""
            if not path.is_file() or path.read_bytes() != content:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
    for folder in {name.partition("/")[0] for name in members}:
        for path in (place / folder).rglob("*"):
            if path.is_file() and str(path.relative_to(place)) not in members:
                path.unlink()
    return set(members)


def is_permissive(expression: str) -> bool:
    """Whether an SPDX expression lets us choose permissive licences alone."""
    either = re.split(r" OR |/", re.sub(r"[()]| WITH LLVM-exception", "", expression))
    return any(all(part.strip() in PERMISSIVE for part in choice.split(" AND ")) for choice in either)


def check_licences() -> None:
    """Every crate that ends up in the wheel has a permissive licence."""
    metadata = json.loads(run("cargo", "metadata", "--format-version", "1", "--locked", "--offline"))
    used = run(
        "cargo",
        "tree",
        "-p",
        "softshadow_python",
        "-e",
        "normal",
        "--prefix",
        "none",
        "-f",
        "{p}",
        "--offline",
        "--target",
        "all",
    )
    names = {line.split()[0] for line in used.splitlines() if line}
    expect(len(names) > 50, f"cargo tree names {len(names)} crates")
    for package in metadata["packages"]:
        if package["name"] in names:
            licence = package["license"] or "none"
            expect(is_permissive(licence), f"{package['name']} has the licence {licence}")


def missing_from_sdist(names: set[str]) -> set[str]:
    """What a wheel cannot be built or used without, of files with paths from the sdist's folder."""
    shaders = {str(path.relative_to(ROOT / "shaders_wgsl")) for path in (ROOT / "shaders_wgsl").rglob("*.wgsl")}
    scenes = {path.name for path in (ROOT / "crates/softshadow_scene/scenes").glob("*.json")}
    needed = {
        *LICENCES,
        *("PKG-INFO", "pyproject.toml", "README.md", "Cargo.toml", "Cargo.lock"),
        *(f"crates/softshadow_shaders/shaders_wgsl/{name}" for name in shaders),
        *(f"crates/softshadow_scene/scenes/{name}" for name in scenes),
        *(str(path.relative_to(ROOT)) for path in (ROOT / "python").rglob("*.py*") if path.suffix != ".pyc"),
        "python/softshadow/py.typed",
    }
    expect(len(shaders) > 50 and len(scenes) >= 5, "there are shaders and scenes")
    return needed - names


def make_sdist() -> Path:
    """The sdist, unpacked."""
    shutil.rmtree(PLACE / "dist", ignore_errors=True)
    run(sys.executable, "-m", "maturin", "sdist", "--out", PLACE / "dist")
    (archive,) = (PLACE / "dist").glob("*.tar.gz")
    names = unpack(archive, PLACE / "sdist")
    folder = PLACE / "sdist" / archive.name.removesuffix(".tar.gz")
    names = {name.partition("/")[2] for name in names}
    missing = missing_from_sdist(names)
    expect(not missing, f"{archive.name} lacks {sorted(missing)[:5]}")
    expect(missing_from_sdist(names - {"LICENSE-MIT"}) == {"LICENSE-MIT"}, "a missing file is seen")
    return folder


def make_wheel(sdist: Path) -> Path:
    """The wheel of an unpacked sdist, by its build backend."""
    command = (sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet")
    run(*command, "--wheel-dir", PLACE / "dist", sdist, CARGO_TARGET_DIR=str(TARGET))
    (wheel,) = (PLACE / "dist").glob("*.whl")
    expect("-cp311-abi3-" in wheel.name, f"{wheel.name} is for one version of Python")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        folder = metadata.rpartition("/")[0]
        for name in ("softshadow/py.typed", "softshadow/_core.pyi", "softshadow/_core.abi3.so"):
            expect(name in names, f"{wheel.name} lacks {name}")
        for name in LICENCES:
            expect(f"{folder}/licenses/{name}" in names, f"{wheel.name} lacks {name}")
        expect(not any(name.endswith((".pyc", ".rs", ".wgsl")) for name in names), f"{wheel.name} holds sources")
        check_metadata(HeaderParser().parsestr(archive.read(metadata).decode()))
    return wheel


def check_metadata(of: Message) -> None:
    """What an index and ``pip show`` say."""
    expect(of["Name"] == "softshadow", "its name is softshadow")
    expect(of["License-Expression"] == "MIT OR Apache-2.0", "the licence is an expression")
    expect(set(of.get_all("License-File", [])) == LICENCES, "both licence files are named")
    expect(of["Requires-Python"] == ">=3.11", "Python 3.11 or newer")
    expect(bool(of["Summary"]) and bool(of["Author"]), "there are a summary and authors")
    plain = [row for row in of.get_all("Requires-Dist", []) if "extra ==" not in row]
    expect(len(plain) == 1 and plain[0].startswith("numpy"), f"numpy alone is required, not {plain}")
    expect("Typing :: Typed" in of.get_all("Classifier", []), "it says that it is typed")


USE = """
import importlib, pathlib, pickle, pkgutil, sys
import numpy as np
import softshadow as ss

assert pathlib.Path(ss.__file__).is_relative_to(sys.prefix), ss.__file__
for module in pkgutil.walk_packages(ss.__path__, "softshadow."):
    # Extras are not there: only they may be missing.
    try:
        module.name.endswith("__main__") or importlib.import_module(module.name)
    except ModuleNotFoundError as error:
        extras = ("trimesh", "open3d", "mitsuba", "drjit", "embreex", "wgpu", "pygfx", "rendercanvas")
        assert error.name in extras, error
try:
    ss.Scene.from_trimesh(None)
except ss.MissingExtra as error:
    assert "[trimesh]" in str(error), error
hall = ss.scenes.load("fork")
camera = ss.Camera(world_from_camera=hall.camera.world_from_camera, fov_y_deg=40, size=(32, 18))
seen = ss.visibility(pickle.loads(pickle.dumps(hall.scene)), hall.light, camera=camera, device="native")
assert seen.info["adapter"]["device_type"] == "native"
share = seen.values[seen.valid]
assert share.size and 0 < np.mean(share) < 1, share
seen.save("seen.png")
print(sys.version_info[:2], ss.__version__, float(np.mean(share)))
"""


def try_wheel(wheel: Path, python: str | None) -> None:
    """Installs the wheel in an empty environment and uses it: as a library, as a program, as types."""
    place = PLACE / "venv"
    shutil.rmtree(place, ignore_errors=True)
    if python is None:
        venv.create(place, with_pip=True)
    else:
        run(python, "-m", "venv", place)
    away = place / "away"
    away.mkdir()
    binaries = place / ("Scripts" if os.name == "nt" else "bin")
    clean = {"PYTHONPATH": "", "PYTHONWARNINGS": "error"}
    run(binaries / "python", "-m", "pip", "install", "--quiet", wheel, cwd=away)
    run(binaries / "python", "-m", "pip", "check", cwd=away)
    print(run(binaries / "python", "-I", "-c", USE, cwd=away, **clean).strip())
    expect((away / "seen.png").read_bytes().startswith(b"\x89PNG"), "a picture was saved")
    shown = run(binaries / "python", "-m", "pip", "show", "softshadow", cwd=away)
    expect("Requires: numpy\n" in shown, shown)
    expect("native" in run(binaries / "softshadow", "doctor", cwd=away), "the program runs")
    (away / "typed.py").write_text("import softshadow as ss\nreveal_type(ss.RayTraced(samples=4).samples)\n")
    command = (sys.executable, "-m", "mypy", "--python-executable", binaries / "python", "typed.py")
    revealed = run(*command, cwd=away)
    # Newer mypy leaves the module of builtins out.
    expect(re.search(r'"(builtins\.)?int"', revealed) is not None, f"types are not seen from outside: {revealed}")


def check_crates() -> None:
    """Packs every crate that is published, and compiles what the packages hold, each with the others' packages."""
    metadata = json.loads(run("cargo", "metadata", "--format-version", "1", "--no-deps", "--offline"))
    published = [package for package in metadata["packages"] if package["publish"] is None]
    names = [package["name"] for package in published]
    expect("softshadow" in names, "the front door is published")
    folder = TARGET / "package"
    private = [package["name"] for package in metadata["packages"] if package["publish"] is not None]
    excluded = [word for name in private for word in ("--exclude", name)]
    run("cargo", "package", "--workspace", *excluded, "--no-verify", "--allow-dirty", "--quiet")
    place = PLACE / "crates"
    for package in published:
        names = unpack(folder / f"{package['name']}-{package['version']}.crate", place)
        expect({name.partition("/")[2] for name in names} >= LICENCES, f"{package['name']} lacks its licences")
        for field in ("description", "license", "keywords", "categories", "authors"):
            expect(bool(package[field]), f"{package['name']} has no {field}")
    folders = {package["name"]: f"{package['name']}-{package['version']}" for package in published}
    patches = [f'{name} = {{ path = "{path}" }}' for name, path in folders.items()]
    manifest = [
        "[workspace]",
        'resolver = "3"',
        f"members = {json.dumps(list(folders.values()))}",
        "[patch.crates-io]",
        *patches,
    ]
    (place / "Cargo.toml").write_text("\n".join(manifest) + "\n")
    shutil.copy(ROOT / "Cargo.lock", place)
    run(
        "cargo",
        "check",
        "--release",
        "--offline",
        "--quiet",
        "-p",
        "softshadow",
        cwd=place,
        CARGO_TARGET_DIR=str(TARGET),
    )
    print(f"{len(published)} crates packed and compiled from their packages")


def main() -> None:
    """Everything, or what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", help="an interpreter for the empty environment")
    python = parser.parse_args().python
    PLACE.mkdir(parents=True, exist_ok=True)
    check_licences()
    wheel = make_wheel(make_sdist())
    try_wheel(wheel, python)
    check_crates()
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
