"""Visibility and its error as small PNGs that a page can hold."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from softshadow import _core
from softshadow.gallery import colors

LARGEST_SIDE = 1024
"""Pixels of an image on the page; larger ones are averaged over squares."""

_NOTHING = (200, 203, 208)
_LEVELS = 255
_GREYS = np.vstack([np.repeat(colors.srgb(np.linspace(0, 1, _LEVELS))[:, None], 3, axis=1), _NOTHING]).astype(np.uint8)
_SIGNED = np.vstack([colors.signed(np.linspace(-1, 1, _LEVELS)), _NOTHING]).astype(np.uint8)


@dataclass(frozen=True)
class Shown:
    """An image on the page."""

    png: bytes
    size: tuple[int, int]
    """Width and height in pixels."""

    @property
    def uri(self) -> str:
        """The image itself as an address."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode("ascii")


def visibility(values: NDArray[np.float32]) -> Shown:
    """Grey as light would be: 1 is white; grey-blue where the camera sees nothing."""
    return _painted(_reduced(values), _GREYS)


def error(values: NDArray[np.float32], reference: NDArray[np.float32], limit: float) -> Shown:
    """False colours: red is too bright, blue too dark, both saturated at `limit`."""
    return _painted(_reduced(values - reference) / (2 * limit) + 0.5, _SIGNED)


def reduction(width: int, height: int) -> int:
    """The side in pixels of the squares that are averaged."""
    return math.ceil(max(width, height) / LARGEST_SIDE)


def _reduced(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """One channel, small enough. The last rows and columns are left out where squares do not fit."""
    grey = values.mean(axis=-1) if values.ndim == 3 else values
    height, width = grey.shape
    side = reduction(width, height)
    if side == 1:
        return grey
    squares = grey[: height // side * side, : width // side * side]
    squares = squares.reshape(height // side, side, width // side, side)
    known = np.isfinite(squares)
    count = known.sum(axis=(1, 3))
    total = np.where(known, squares, 0).sum(axis=(1, 3), dtype=np.float64)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan).astype(np.float32)


def _painted(shares: NDArray[np.float32], palette: NDArray[np.uint8]) -> Shown:
    """The palette's last colour is for what is not known."""
    places = np.nan_to_num(np.clip(shares, 0, 1) * (_LEVELS - 1)).round()
    indices: NDArray[np.uint8] = np.where(np.isnan(shares), _LEVELS, places).astype(np.uint8)
    height, width = shares.shape
    return Shown(_core.png_palette8(indices.ravel(), palette, (width, height)), (width, height))
