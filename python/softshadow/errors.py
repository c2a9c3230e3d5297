"""Everything that softshadow raises. Each class also has the base that Python users expect to catch."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .visibility import Visibility


class SoftShadowError(Exception):
    """Any error of this library; raised itself only for internal errors."""


class SceneError(SoftShadowError, ValueError):
    """A scene, light, camera or receiver that cannot be used; messages name it and the first bad index."""


class SceneFileNotFound(SceneError, FileNotFoundError):
    """The scene's file does not exist."""


class SettingsError(SoftShadowError, ValueError):
    """A setting outside its range, an option that does not exist, or options that exclude each other."""


class TooLargeError(SoftShadowError, ValueError):
    """More than the library or the device can take; nothing was computed."""


class NoAdapterError(SoftShadowError, RuntimeError):
    """No device fits the choice; the message has the command that installs a software one."""


class GpuError(SoftShadowError, RuntimeError):
    """The graphics driver failed or was lost."""


class GpuOutOfMemory(GpuError, MemoryError):
    """The device has too little memory; a smaller ``memory_limit`` makes smaller blocks."""


class MissingExtra(SoftShadowError, ImportError):
    """A call needs a package that is not installed; the message has the command that installs it."""


class MeasureError(SoftShadowError, ValueError):
    """Results that cannot be compared."""


class BoundNotMet(SoftShadowError, RuntimeError):
    """No technique keeps the error or the time that was asked for; `best` is the result that comes closest.

    What it reaches is in ``best.info["choice"]``.
    """

    best: Visibility | None = None


class Interrupted(SoftShadowError, RuntimeError):
    """The progress callback returned ``False``."""


class OutputError(SoftShadowError, OSError):
    """An image could not be encoded or written."""


class SoftwareAdapterWarning(UserWarning):
    """``device="auto"`` found no graphics card to draw triangles and took a software adapter, which is much slower."""
