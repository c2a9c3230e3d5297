"""False colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

WALL = (0.6, 0.62, 0.65)
"""Linear colour where a camera sees nothing."""

_NOTHING = np.array([200, 203, 208], np.uint8)
_LESS, _EQUAL, _MORE = np.array([[23, 80, 172], [250, 250, 248], [190, 28, 32]], np.float64)
# Layers: nothing is light, every second layer, a closed body, is another hue; darker is more.
_COUNTS = np.array(
    [
        [250, 250, 248],
        [253, 224, 140],
        [250, 170, 70],
        [238, 110, 65],
        [214, 50, 80],
        [165, 30, 115],
        [110, 25, 130],
        [60, 20, 105],
        [25, 10, 55],
    ],
    np.uint8,
)


def signed(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Blue for −1, white for 0, red for 1 and beyond; grey where there is no number."""
    share = np.clip(np.nan_to_num(values), -1.0, 1.0)[..., None]
    mixed = _EQUAL + np.abs(share) * (np.where(share > 0, _MORE, _LESS) - _EQUAL)
    return _where_known(values, mixed.round().astype(np.uint8))


def counts(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    """A colour for each whole number from 0 to 8, the last for all above; grey where there is no number."""
    whole = np.clip(np.nan_to_num(values).round(), 0, len(_COUNTS) - 1).astype(np.intp)
    return _where_known(values, _COUNTS[whole])


def shaded(image: NDArray[np.uint8], up: NDArray[np.floating]) -> NDArray[np.uint8]:
    """A little darker where surfaces look to the side, so that bodies can be told."""
    share = 0.82 + 0.18 * np.clip(np.nan_to_num(up, nan=1.0), 0, 1)[..., None]
    return np.asarray(share * image, np.uint8)


def srgb(linear: ArrayLike) -> NDArray[np.uint8]:
    """Linear colours in 0..1, encoded for display."""
    c = np.clip(np.asarray(linear, np.float64), 0.0, 1.0)
    encoded = np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
    return np.asarray((255 * encoded).round(), np.uint8)


def _where_known(values: NDArray[np.floating], image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.where(np.isnan(values)[..., None], _NOTHING, image)
