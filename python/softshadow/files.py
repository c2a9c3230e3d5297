"""Writing results."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .errors import SettingsError


def png_or_npy(path: str | os.PathLike[str]) -> Literal["png", "npy"]:
    """The format that a path's extension names."""
    try:
        extension = Path(path).suffix.lower()
    except TypeError:
        raise SettingsError(f"a path expected, got {path!r:.80}") from None
    if extension == ".png":
        return "png"
    if extension == ".npy":
        return "npy"
    raise SettingsError(f"{os.fspath(path)}: unknown format '{extension}'; writable are .png and .npy")


def write(path: str | os.PathLike[str], content: bytes | NDArray[Any]) -> None:
    """Bytes as they are, arrays in numpy's format."""
    with open(path, "wb") as file:
        if isinstance(content, bytes):
            file.write(content)
        else:
            np.save(file, content)
