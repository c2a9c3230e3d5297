"""Writing results: what a file of each kind holds, and how."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import SettingsError

FORMATS = ("png", "npy", "npz", "csv", "exr")

# Rows of a table are made into text in blocks: a number takes some hundred bytes on its way.
_ROWS = 1 << 14


def output_format(path: str | os.PathLike[str]) -> str:
    """The format that a path's extension names, in any case: one of `FORMATS`."""
    try:
        extension = Path(path).suffix.lower()
    except TypeError:
        raise SettingsError(f"a path expected, got {path!r:.80}") from None
    if extension[1:] in FORMATS:
        return extension[1:]
    writable = ", ".join(f".{name}" for name in FORMATS)
    raise SettingsError(f"{os.fspath(path)}: unknown format '{extension}'; writable are {writable}")


def write(path: str | os.PathLike[str], content: bytes | NDArray[Any]) -> None:
    """Bytes as they are, arrays in numpy's format."""
    with open(path, "wb") as file:
        if isinstance(content, bytes):
            file.write(content)
        else:
            np.save(file, content)


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Named arrays, compressed; numpy reads them without pickle."""
    # An open file, because numpy would add to a name that ends in .NPZ.
    with open(path, "wb") as file:
        named: dict[str, Any] = dict(arrays)
        np.savez_compressed(file, **named)


def write_csv(path: str | os.PathLike[str], columns: Mapping[str, NDArray[Any]]) -> None:
    """Columns of one length under their names: the shortest digits that give back every bit, 0 and 1 for booleans."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        numbers = [column.astype(np.uint8) if column.dtype == np.bool_ else column for column in columns.values()]
        for start in range(0, len(numbers[0]), _ROWS):
            texts = [column[start : start + _ROWS].astype(str).tolist() for column in numbers]
            writer.writerows(zip(*texts, strict=True))
