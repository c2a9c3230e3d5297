"""Packages that only some calls need: each comes with an extra, and is imported when it is used."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from .errors import MissingExtra

EXTRAS = {"trimesh": "trimesh", "plot": "matplotlib", "progress": "tqdm"}
"""What each extra installs."""


def needed(extra: str, what: str, module: str | None = None) -> Any:
    """The package of an extra, or a module of it; `what` says who wants it."""
    package = EXTRAS[extra]
    try:
        return import_module(module or package)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != package:
            raise
        install = f"`python -m pip install {package}`"
        raise MissingExtra(f"{what}: needs {package}: {install}, or softshadow with its extra [{extra}]") from None


def installed() -> dict[str, bool]:
    """Which extras are there; nothing is imported."""
    return {extra: find_spec(package) is not None for extra, package in EXTRAS.items()}
