"""The pinhole camera."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .by_value import ByValue, set_fields
from .checks import choice, floats, frozen, image_size, matrix, real, vector
from .errors import SceneError

if TYPE_CHECKING:
    from trimesh.scene.cameras import Camera as TrimeshCamera

_OPENGL_FROM_OPENCV = np.diag([1.0, -1.0, -1.0, 1.0])


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike | None = None) -> NDArray[np.float64]:
    """The pose at `eye` whose local −Z points at `target`: of a camera, or of a light that emits towards it.

    Parameters
    ----------
    eye, target : (3,) float
        World coordinates.
    up : (3,) float, optional
        Where local +Y points as far as possible; else world +Y, or world −Z for a vertical view.

    Returns
    -------
    (4, 4) float
        ``world_from_local``, translation in ``[:3, 3]``.

    Raises
    ------
    SceneError
        Where both points are the same, or `up` is parallel to the view.
    """
    upwards = None if up is None else vector("up", up)
    return np.array(_core.look_at(vector("eye", eye), vector("target", target), upwards))


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera(ByValue):
    """A pinhole camera that looks along local −Z with +Y up; pixel centres lie at half integers.

    Parameters
    ----------
    world_from_camera : (4, 4) float
        Pose, a rotation and a translation.
    size : (width, height)
        In pixels. Images are arrays of shape ``(height, width)``.
    fov_y_deg : float
        Vertical field of view in degrees; either this or `K`.
    K : (3, 3) float
        ``[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]`` in pixels from the upper left corner, y downwards.
    frame : {"opengl", "opencv"}
        ``"opencv"`` reads `world_from_camera` as of a camera that looks along +Z with +Y down.

    Raises
    ------
    SceneError, SettingsError
        For matrices, angles and sizes that have no meaning.
    """

    world_from_camera: NDArray[np.float64]
    size: tuple[int, int]
    fov_y_deg: float | None = None
    K: NDArray[np.float64] | None = None
    frame: str = "opengl"

    def __post_init__(self) -> None:
        if (self.K is None) == (self.fov_y_deg is None):
            raise SceneError("camera: give either fov_y_deg or K")
        set_fields(
            self,
            world_from_camera=matrix("world_from_camera", self.world_from_camera),
            size=image_size(self.size),
            fov_y_deg=None if self.fov_y_deg is None else real("camera fov_y_deg", self.fov_y_deg),
            K=None if self.K is None else _intrinsics(self.K),
            frame=choice("camera frame", self.frame, ("opengl", "opencv")),
        )
        self._built()

    @property
    def shape(self) -> tuple[int, int]:
        """``(height, width)``, the shape of the camera's images."""
        return self.size[1], self.size[0]

    @classmethod
    def look_at(
        cls,
        *,
        eye: ArrayLike,
        target: ArrayLike,
        up: ArrayLike | None = None,
        fov_y_deg: float,
        size: tuple[int, int],
    ) -> Camera:
        """A camera at `eye` that looks at `target`.

        Parameters
        ----------
        eye, target, up
            As in :func:`softshadow.look_at`.
        fov_y_deg : float
            Vertical field of view in degrees.
        size : (width, height)
            In pixels.

        Raises
        ------
        SceneError, SettingsError
            As :func:`softshadow.look_at`, and for angles and sizes that have no meaning.
        """
        try:
            pose = look_at(eye, target, up)
        except SceneError as error:
            raise SceneError(f"camera: {error}") from None
        return cls(world_from_camera=pose, fov_y_deg=fov_y_deg, size=size)

    @classmethod
    def from_trimesh(cls, camera: TrimeshCamera, transform: ArrayLike) -> Camera:
        """The camera of a trimesh scene.

        Parameters
        ----------
        camera : trimesh.scene.Camera
            Read, never changed.
        transform : (4, 4) float
            ``scene.camera_transform``, or what ``camera.look_at`` returns: the pose, against its docstring.

        Raises
        ------
        SceneError, SettingsError
            For a transform that is no pose, and a resolution that has no meaning.
        """
        # Its resolution is (width, height), against its docstring. K is left alone: its setter changes it.
        # Asking a copy keeps what trimesh works out and caches off the caller's camera.
        try:
            own = copy.copy(camera)
            width, height = (int(n) for n in own.resolution)
            fx, fy = (float(n) for n in own.focal)
        except (AttributeError, TypeError, ValueError):
            raise SceneError(f"camera: a trimesh camera expected, got {type(camera).__name__}") from None
        intrinsics = np.array([[fx, 0.0, width / 2], [0.0, fy, height / 2], [0.0, 0.0, 1.0]])
        return cls(world_from_camera=matrix("transform", transform), K=intrinsics, size=(width, height))

    def _built(self) -> _core.Camera:
        """The checked camera of the core."""
        pose = self.world_from_camera
        if self.frame == "opencv":
            pose = pose @ _OPENGL_FROM_OPENCV
        rows: Any = pose.tolist()
        if self.fov_y_deg is not None:
            return _core.Camera.with_fov(rows, self.fov_y_deg, self.size)
        assert self.K is not None
        return _core.Camera(rows, (self.K[0, 0], self.K[1, 1], self.K[0, 2], self.K[1, 2]), self.size)


def _intrinsics(value: ArrayLike) -> NDArray[np.float64]:
    K = floats("camera K", value, (3, 3))
    if K[0, 1] != 0.0 or K[1, 0] != 0.0 or K[2].tolist() != [0.0, 0.0, 1.0]:
        raise SceneError("camera K: [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] expected; skew is not modelled")
    return frozen(K)
