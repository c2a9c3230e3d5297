"""What callers may pass: numbers and arrays are converted only where nothing is lost."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral, Real
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import SceneError, SettingsError, SoftShadowError

T = TypeVar("T")

UINT32_MAX = 2**32 - 1

_KINDS = {"f": "float32 or float64", "iu": "integer"}


def floats(what: str, value: ArrayLike, shape: tuple[int | str, ...]) -> NDArray[np.float64]:
    """A C-contiguous float64 array of `shape`, in which a name stands for any length.

    Arrays must hold floats already; lists may also hold whole numbers.
    """
    array = _array(what, value, "f")
    if not np.can_cast(array.dtype, np.float64, "safe"):
        raise SceneError(f"{what}: dtype {array.dtype} does not fit into float64")
    return np.ascontiguousarray(_shaped(what, array, shape), dtype=np.float64)


def integers(what: str, value: ArrayLike, shape: tuple[int | str, ...]) -> NDArray[Any]:
    """An integer array of `shape`, of its own dtype."""
    return _shaped(what, _array(what, value, "iu"), shape)


def real(what: str, value: object, error: type[SoftShadowError] = SceneError) -> float:
    """One number; strings, booleans and complex numbers are refused."""
    if isinstance(value, Real) and not isinstance(value, (bool, np.bool_)):
        try:
            return float(value)
        except OverflowError:
            raise error(f"{what}: {type(value).__name__} too large for float64") from None
    raise error(f"{what}: a number expected, got {_type_name(value)}")


def whole(what: str, value: object, *, low: int = 0, high: int = UINT32_MAX) -> int:
    """One whole number between `low` and `high`."""
    if not isinstance(value, Integral) or isinstance(value, (bool, np.bool_)):
        raise SettingsError(f"{what}: a whole number expected, got {_type_name(value)}")
    number = int(value)
    if not low <= number <= high:
        raise SettingsError(f"{what}: must lie between {low} and {high}, got {number}")
    return number


def flag(what: str, value: object) -> bool:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise SettingsError(f"{what}: True or False expected, got {_type_name(value)}")
    return bool(value)


def memory_limit_bytes(value: object) -> int | None:
    """A number of bytes, or None for the library's own limit."""
    return None if value is None else whole("memory_limit", value, low=1, high=2**64 - 1)


def vector(what: str, value: ArrayLike) -> tuple[float, float, float]:
    """Three numbers."""
    x, y, z = floats(what, value, (3,)).tolist()
    return x, y, z


def color(what: str, value: ArrayLike) -> tuple[float, float, float]:
    """Linear red, green and blue, finite and not negative."""
    channels = vector(what, value)
    if not all(0.0 <= x < np.inf for x in channels):
        raise SceneError(f"{what}: must be finite and not negative, got {channels}")
    return channels


def matrix(what: str, value: ArrayLike) -> NDArray[np.float64]:
    """A read-only copy of a 4×4 matrix."""
    return frozen(floats(what, value, (4, 4)))


def image_size(value: object) -> tuple[int, int]:
    """``(width, height)`` in pixels."""
    if (
        not isinstance(value, (tuple, list, np.ndarray))
        or (isinstance(value, np.ndarray) and value.ndim != 1)
        or len(value) != 2
    ):
        raise SceneError(f"camera size: (width, height) expected, got {value!r}")
    width, height = value
    return whole("camera width", width, low=1), whole("camera height", height, low=1)


def choice(what: str, value: object, choices: tuple[str, ...]) -> str:
    """One of the named choices."""
    # An array compares with each of them.
    if isinstance(value, str) and value in choices:
        return str(value)
    raise SettingsError(f"{what}: choose one of {', '.join(map(repr, choices))}, got {value!r}")


def items(what: str, value: Iterable[T]) -> tuple[T, ...]:
    """What an iterable gives."""
    try:
        return tuple(value)
    except TypeError:
        raise SceneError(f"{what}: an iterable expected, got {_type_name(value)}") from None


def text(what: str, value: object) -> str:
    """A name or a note, which files and the core hold as UTF-8."""
    words = str(value)
    try:
        words.encode()
    except UnicodeEncodeError:
        raise SceneError(f"{what}: {words!r:.80} is no text: it holds half of a surrogate pair") from None
    return words


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """A read-only copy."""
    copy = array.copy()
    copy.setflags(write=False)
    return copy


def _array(what: str, value: ArrayLike, kinds: str) -> NDArray[Any]:
    if isinstance(value, np.ma.MaskedArray):
        raise SceneError(f"{what}: a masked array would lose its mask; fill it first")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError) as error:
        raise SceneError(f"{what}: not an array of numbers ({error})") from None
    has_dtype = hasattr(value, "dtype")
    # Lists say nothing of their type: whole numbers in them may be coordinates, an empty one may be anything.
    accepted = kinds if has_dtype else kinds + "iu"
    if array.dtype.kind not in accepted and (has_dtype or array.size):
        raise SceneError(f"{what}: {_KINDS[kinds]} numbers expected, got dtype {array.dtype}")
    return array


def _shaped(what: str, array: NDArray[Any], shape: tuple[int | str, ...]) -> NDArray[Any]:
    if array.shape == (0,) and isinstance(shape[0], str):
        return array.reshape([0 if isinstance(n, str) else n for n in shape])
    fits = array.ndim == len(shape) and all(
        isinstance(n, str) or n == got for n, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "")
        raise SceneError(f"{what}: shape ({wanted}) expected, got {array.shape}")
    return array


def _type_name(value: object) -> str:
    return type(value).__name__ + (f" {value!r}" if isinstance(value, (bool, str, float)) else "")
