"""Soft shadows from area lights, as numbers and as pictures.

>>> import softshadow as ss
>>> hall = ss.scenes.load("hall")
>>> result = ss.visibility(hall.scene, hall.light, camera=hall.camera)  # doctest: +SKIP
>>> result.values.shape  # doctest: +SKIP
(540, 960)

Matrices are row-major arrays of column-vector mathematics with the translation in ``[:3, 3]``. Cameras look
along −Z with +Y up, lights emit along −Z. Sizes are ``(width, height)`` in arguments, ``(H, W)`` in arrays.
Visibility is 1 where a light is fully seen. Colours are linear; only PNGs of pictures are sRGB.
"""

from . import scenes
from ._core import __version__
from .camera import Camera, look_at
from .comparison import Comparison, compare
from .diagnosis import Diagnosis, doctor
from .errors import (
    BoundNotMet,
    GpuError,
    GpuOutOfMemory,
    Interrupted,
    MeasureError,
    MissingExtra,
    NoAdapterError,
    OutputError,
    SceneError,
    SceneFileNotFound,
    SettingsError,
    SoftShadowError,
    SoftwareAdapterWarning,
    TooLargeError,
)
from .light_samples import LightPoints, light_points
from .lights import DiscLight, Light, PolygonLight, RectLight, SphereLight, SunLight
from .picture import Picture, render
from .scene import Mesh, Scene
from .scene_file import SceneFile, from_trimesh, load
from .techniques import (
    DepthComplexity,
    HardShadowMap,
    OcclusionCamera,
    OcclusionLayers,
    PenumbraMap,
    RayTraced,
    Technique,
)
from .visibility import Visibility, visibility

__all__ = [
    "BoundNotMet",
    "Camera",
    "Comparison",
    "DepthComplexity",
    "Diagnosis",
    "DiscLight",
    "GpuError",
    "GpuOutOfMemory",
    "HardShadowMap",
    "Interrupted",
    "Light",
    "LightPoints",
    "MeasureError",
    "Mesh",
    "MissingExtra",
    "NoAdapterError",
    "OcclusionCamera",
    "OcclusionLayers",
    "OutputError",
    "PenumbraMap",
    "Picture",
    "PolygonLight",
    "RayTraced",
    "RectLight",
    "Scene",
    "SceneError",
    "SceneFile",
    "SceneFileNotFound",
    "SettingsError",
    "SoftShadowError",
    "SoftwareAdapterWarning",
    "SphereLight",
    "SunLight",
    "Technique",
    "TooLargeError",
    "Visibility",
    "__version__",
    "compare",
    "doctor",
    "from_trimesh",
    "light_points",
    "load",
    "look_at",
    "render",
    "scenes",
    "visibility",
]
