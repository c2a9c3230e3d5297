from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypedDict, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Camera",
    "Context",
    "ForeignCall",
    "ForeignDevice",
    "Light",
    "Scene",
    "__version__",
    "adapters",
    "cache_folder",
    "check_technique",
    "compare",
    "default_material",
    "exr",
    "light_points",
    "load_scene_file",
    "look_at",
    "png_grey16",
    "png_palette8",
    "png_srgb8",
    "render",
    "shader",
    "shipped_names",
    "shipped_scene",
    "svg_png",
    "technique_defaults",
    "visibility",
    "visibility_within",
]

__version__: str

_Vector = tuple[float, float, float] | list[float]
_Matrix = list[list[float]]
_FlatMesh = tuple[
    str, NDArray[np.float64], NDArray[np.uint32], _Vector, float, float, float, NDArray[np.float32] | None
]
_Progress = Callable[[int, int], object]

class _PlacedArrays(TypedDict):
    positions: NDArray[np.float64]
    normals: NDArray[np.float32]
    triangles: NDArray[np.int64]

class _VisibilityArrays(TypedDict):
    values: NDArray[np.float32]
    channels: int
    valid: NDArray[np.bool_]
    standard_error: NDArray[np.float32] | None
    placed: _PlacedArrays | None
    visible_samples: NDArray[np.bool_] | None
    info: str

class _PictureArrays(TypedDict):
    linear: NDArray[np.float32]
    srgb: NDArray[np.uint8]
    visibility: _VisibilityArrays

class _ComparisonArrays(TypedDict):
    measured: str
    reference_values: NDArray[np.float32]
    values: list[NDArray[np.float32]]

class _LightPointArrays(TypedDict):
    parameters: NDArray[np.float32]
    positions: NDArray[np.float64]
    rows: int
    at_infinity: bool

class _ShippedLight(TypedDict):
    shape: str
    sizes: list[float]
    position: list[float]
    target: list[float]
    up: list[float]
    radiance: list[float]

class _ShippedCamera(TypedDict):
    eye: list[float]
    target: list[float]
    up: list[float]
    fov_y_deg: float
    size: list[int]

class _ShippedScene(TypedDict):
    description: str
    scene: Scene
    light: _ShippedLight
    camera: _ShippedCamera

class _FileLight(TypedDict):
    name: str
    shape: str
    sizes: list[float]
    world_from_light: _Matrix
    radiance: list[float]

class _FileCamera(TypedDict):
    eye: list[float]
    target: list[float]
    up: list[float] | None
    fov_y_deg: float
    size: list[int]

class _SceneFile(TypedDict):
    scene: Scene
    lights: list[_FileLight]
    camera: _FileCamera | None
    meters_per_unit: float | None

class _ForeignStage(TypedDict):
    description: str
    values: dict[str, bytes]

@final
class Context:
    def __new__(cls, device: str) -> Context: ...
    @property
    def adapter(self) -> str: ...

@final
class ForeignDevice:
    def __new__(cls, described: str) -> ForeignDevice: ...
    def visibility(
        self,
        scene: Scene,
        lights: list[Light],
        *,
        camera: Camera | None,
        points: NDArray[np.float64] | None,
        normals: NDArray[np.float64] | None,
        technique: str,
        memory_limit: int | None,
        standard_error: bool,
    ) -> ForeignCall: ...

@final
class ForeignCall:
    @property
    def results(self) -> list[tuple[str, int]]: ...
    @property
    def channels(self) -> int: ...
    @property
    def stages(self) -> int: ...
    @property
    def superseded(self) -> list[int]: ...
    def upload(self, key: int) -> bytes: ...
    def stage(self, index: int, decision: bytes) -> _ForeignStage | None: ...
    def finish(self, outputs: Sequence[dict[str, bytes]], wall_ms: float, submissions: int) -> str: ...

@final
class Scene:
    def __new__(cls, meshes: Sequence[_FlatMesh], notes: list[str]) -> Scene: ...
    @staticmethod
    def load(path: str) -> Scene: ...
    def meshes(self) -> list[_FlatMesh]: ...
    def with_vertices(self, vertices: Sequence[NDArray[np.float64] | None]) -> Scene: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def bounds(self) -> tuple[list[float], list[float]] | None: ...
    @property
    def triangle_count(self) -> int: ...

@final
class Light:
    @staticmethod
    def rectangle(
        width: float,
        height: float,
        world_from_light: _Matrix,
        radiance: _Vector,
        texture: NDArray[np.float32] | None,
    ) -> Light: ...
    @staticmethod
    def disc(radius: float, world_from_light: _Matrix, radiance: _Vector) -> Light: ...
    @staticmethod
    def sphere(radius: float, world_from_light: _Matrix, radiance: _Vector) -> Light: ...
    @staticmethod
    def polygon(outline: list[list[float]], world_from_light: _Matrix, radiance: _Vector) -> Light: ...
    @staticmethod
    def sun(azimuth: float, elevation: float, diameter_deg: float, up: str, radiance: _Vector) -> Light: ...

@final
class Camera:
    def __new__(
        cls, world_from_camera: _Matrix, intrinsics: tuple[float, float, float, float], size: tuple[int, int]
    ) -> Camera: ...
    @staticmethod
    def with_fov(world_from_camera: _Matrix, fov_y_deg: float, size: tuple[int, int]) -> Camera: ...

def adapters() -> str: ...
def shader(file: str) -> str: ...
def look_at(eye: _Vector, target: _Vector, up: _Vector | None = None) -> _Matrix: ...
def default_material() -> tuple[list[float], float, float, float]: ...
def technique_defaults() -> str: ...
def check_technique(technique: str) -> None: ...
def shipped_names() -> list[str]: ...
def shipped_scene(name: str) -> _ShippedScene: ...
def load_scene_file(path: str) -> _SceneFile: ...
def png_grey16(values: NDArray[np.float32], size: tuple[int, int]) -> bytes: ...
def png_srgb8(colors: NDArray[np.uint8], size: tuple[int, int]) -> bytes: ...
def png_palette8(places: NDArray[np.uint8], palette: NDArray[np.uint8], size: tuple[int, int]) -> bytes: ...
def svg_png(svg: str, scale: float) -> bytes: ...
def exr(channels: Sequence[tuple[str, NDArray[np.float32]]], size: tuple[int, int], info: str) -> bytes: ...
def visibility(
    context: Context,
    scene: Scene,
    lights: list[Light],
    *,
    camera: Camera | None,
    points: NDArray[np.float64] | None,
    normals: NDArray[np.float64] | None,
    technique: str,
    memory_limit: int | None,
    standard_error: bool,
    receivers: bool,
    sample_masks: bool,
    progress: _Progress | None,
) -> _VisibilityArrays: ...
def visibility_within(
    context: Context,
    scene: Scene,
    lights: list[Light],
    *,
    camera: Camera | None,
    points: NDArray[np.float64] | None,
    normals: NDArray[np.float64] | None,
    max_error: float | None,
    max_ms: float | None,
    error_norm: str,
    confidence: float | None,
    memory_limit: int | None,
    standard_error: bool,
    receivers: bool,
    progress: _Progress | None,
) -> tuple[_VisibilityArrays, str | None]: ...
def cache_folder() -> Path | None: ...
def render(
    context: Context,
    scene: Scene,
    lights: list[Light],
    *,
    camera: Camera,
    technique: str,
    shading: str,
    exposure: float,
    background: _Vector | None,
    memory_limit: int | None,
    progress: _Progress | None,
) -> _PictureArrays: ...
def compare(
    context: Context,
    scene: Scene,
    light: Light,
    *,
    camera: Camera | None,
    points: NDArray[np.float64] | None,
    normals: NDArray[np.float64] | None,
    techniques: list[str],
    reference: str,
    repeats: int,
    progress: _Progress | None,
) -> _ComparisonArrays: ...
def light_points(
    scene: Scene,
    light: Light,
    pattern: str,
    count: int,
    seed: int,
    spread: str,
    tile: int,
    receivers: NDArray[np.float64],
    image_width: int,
) -> _LightPointArrays: ...
