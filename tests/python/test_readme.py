"""What the documents say can be typed, and what they refer to is there."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import softshadow as ss
from conftest import read_png

ROOT = Path(__file__).parents[2]
PAGES = sorted(path.name for path in ROOT.glob("*.md"))
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


def typed(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """As in a shell without a desktop, and without what developers set."""
    dropped = ("SOFTSHADOW_DEVICE", "VK_LOADER_LAYERS_DISABLE", "XDG_RUNTIME_DIR")
    environment = {name: value for name, value in os.environ.items() if name not in dropped}
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=120, check=False, env=environment
    )


def test_the_eight_lines_run_as_they_stand(tmp_path):
    (lines,) = blocks("python")
    assert len([line for line in lines.splitlines() if line]) == 8
    done = typed([sys.executable, "-c", lines], tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    mean, milliseconds, error = map(float, done.stdout.split())
    assert 0.5 < mean < 1
    assert milliseconds > 0
    assert 0 < error < 0.1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picture.png", "visibility.png"]
    assert read_png(tmp_path / "visibility.png").shape == (512, 512)
    assert len(np.unique(read_png(tmp_path / "picture.png"))) > 100


def test_the_commands_run_as_they_stand(tmp_path):
    lines = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("softshadow ")]
    assert len(lines) > 3
    for line in lines:
        command = shlex.split(line)
        done = typed([sys.executable, "-m", *command], tmp_path)
        assert done.returncode == 0, done.stderr
        assert "error" not in done.stderr
        written = [command[at + 1] for at, word in enumerate(command) if word == "-o"]
        assert all((tmp_path / name).stat().st_size > 0 for name in written)
        assert bool(done.stdout) == ("--json" in command or "doctor" in command)


@pytest.mark.parametrize("page", PAGES)
def test_what_pages_refer_to_is_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (ROOT / link).exists(), link
    targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
    for target in re.findall(r"(?:^|`)make ([\w-]+)", text, flags=re.MULTILINE):
        assert target in targets
    for path in re.findall(r"`((?:crates|python|shaders_wgsl|tests)/[\w./-]+)`", text):
        assert "NAME" in path or (ROOT / path).exists(), path


@pytest.mark.parametrize("page", PAGES)
def test_names_of_the_package_in_pages_are_public(page):
    for name in re.findall(r"\bss\.((?:scenes\.)?\w+)", (ROOT / page).read_text(encoding="utf-8")):
        owner, _, member = name.rpartition(".")
        assert hasattr(getattr(ss, owner) if owner else ss, member), name
