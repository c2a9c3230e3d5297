"""Frozen dataclasses that hold arrays: equal and hashed by what they hold."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np


class ByValue:
    """Base of dataclasses declared with ``eq=False``."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        mine, theirs = _fields(self), _fields(other)
        return all(np.array_equal(a, b) for a, b in zip(mine, theirs, strict=True))

    def __hash__(self) -> int:
        return hash((type(self), *(_hashable(value) for value in _fields(self))))


def _fields(instance: Any) -> list[Any]:
    return [getattr(instance, field.name) for field in fields(instance)]


def _hashable(value: Any) -> Any:
    return (value.shape, tuple(value.ravel().tolist())) if isinstance(value, np.ndarray) else value


def set_fields(instance: object, **values: object) -> None:
    """Replaces fields of a frozen dataclass; only for its own ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)
