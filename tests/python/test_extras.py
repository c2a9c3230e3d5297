"""What is imported from elsewhere has an extra that installs it, and every extra is used."""

from __future__ import annotations

import ast
import sys
import tomllib
from pathlib import Path

from softshadow.extras import EXTRAS

ROOT = Path(__file__).resolve().parents[2]
# Names of modules where they differ from those of packages, and what comes with another package.
PACKAGE_OF = {"PIL": "pillow", "drjit": "mitsuba", "rendercanvas": "pygfx"}


def imported(source: str) -> set[str]:
    """Packages that a module imports, anywhere in it, by their top names; not its own and not Python's."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(str(node.module).partition(".")[0])
    return {PACKAGE_OF.get(name, name) for name in names - sys.stdlib_module_names - {"softshadow"}}


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def package(requirement: str) -> str:
    return requirement.partition(">")[0]


def used() -> set[str]:
    """What is imported by name, or when it is needed."""
    sources = (path.read_text() for path in (ROOT / "python").rglob("*.py"))
    return set().union(EXTRAS.values(), *map(imported, sources))


def test_every_import_has_an_extra():
    extras = {package(row) for rows in project()["optional-dependencies"].values() for row in rows}
    required = {package(row) for row in project()["dependencies"]}
    assert used() <= extras | required
    assert required == {"numpy"}


def test_every_extra_is_imported():
    for extra, rows in project()["optional-dependencies"].items():
        if extra != "test":
            # embreex works through trimesh.
            assert {package(row) for row in rows} - {"embreex"} <= used(), extra


def test_imports_are_found_wherever_they_stand():
    source = (
        "import os\nimport a.b\ndef f():\n    from c.d import e\n    from .own import g\n    from PIL import Image\n"
    )
    assert imported(source) == {"a", "c", "pillow"}
