"""Files, and trimesh scenes, that hold lights or a camera beside their meshes."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import _core
from .camera import Camera
from .checks import image_size, vector
from .errors import SceneError
from .lights import DiscLight, Light, PolygonLight, RectLight, SphereLight, SunLight
from .scene import Scene, path_name, trimesh_reader

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SceneFile:
    """What :func:`load` and :func:`from_trimesh` read.

    Attributes
    ----------
    scene : Scene
        The meshes, in world units.
    lights : tuple of lights
        In the file's order and with its names; empty for all formats but ``scene.json``.
    camera : Camera or None
        The view of a ``scene.json`` or trimesh scene that has one.
    meters_per_unit : float or None
        Metres a world unit, where the source says: 1 for glTF, not known for OBJ, PLY and STL.
    """

    scene: Scene
    lights: tuple[Light, ...]
    camera: Camera | None
    meters_per_unit: float | None

    def __repr__(self) -> str:
        camera = "a camera" if self.camera else "no camera"
        return f"<SceneFile: {self.scene.triangle_count} triangles, {len(self.lights)} lights, {camera}>"


def load(path: str | os.PathLike[str]) -> SceneFile:
    """Reads all that a file holds: ``.json``, or ``.glb``, ``.gltf``, ``.obj``, ``.ply`` and ``.stl`` without lights.

    A ``scene.json`` names meshes with their transforms and materials, lights in UsdLux's words, a camera and a unit
    of length; ``scene.schema.json`` describes it::

        {"softshadow": 1,
         "meters_per_unit": 1,
         "meshes": [{"path": "bunny.ply", "translate": [0, 0.1, 0], "rotate_xyz_deg": [0, 90, 0], "scale": [2, 2, 2],
                     "material": {"base_color": [0.8, 0.4, 0.2], "roughness": 0.5}, "opacity": 1}],
         "lights": [{"type": "RectLight", "name": "key", "width": 1, "height": 1, "intensity": 17,
                     "translate": [1.5, 3.5, 1], "target": [0, 0.3, 0]},
                    {"type": "DistantLight", "angle": 0.53, "rotate_xyz_deg": [-50, -40, 0], "color": [1, 0.9, 0.7]}],
         "camera": {"eye": [2.2, 1.9, 3], "target": [0, 0.4, 0], "fov_y_deg": 40, "size": [640, 480]}}

    Lengths are in world units, angles in degrees, colours linear. Paths are relative to the file. A mesh may have
    ``world_from_mesh``, four rows, instead of the three parts; a light ``world_from_light``. The radiance of a light is
    color · intensity · 2^exposure. Meshes of another unit, which glTF always has (metres) and others with a
    ``meters_per_unit`` of their own, are scaled to that of the scene.

    Parameters
    ----------
    path : path
        The file; its extension, in any case, decides the format.

    Returns
    -------
    SceneFile

    Raises
    ------
    SceneFileNotFound
        Where there is no such file, or none of a mesh that it names; also a ``FileNotFoundError``.
    SceneError
        For an unknown format and a broken file; an unknown field is named with its place.
    TooLargeError
        For more bytes or triangles than a scene may have.
    """
    found = _core.load_scene_file(path_name(path))
    view = found["camera"]
    camera = view and Camera.look_at(
        eye=view["eye"],
        target=view["target"],
        up=view["up"],
        fov_y_deg=view["fov_y_deg"],
        size=image_size(view["size"]),
    )
    return SceneFile(
        scene=Scene._from_core(found["scene"]),
        lights=tuple(_light(light) for light in found["lights"]),
        camera=camera or None,
        meters_per_unit=found["meters_per_unit"],
    )


def from_trimesh(source: trimesh.Trimesh | trimesh.Scene) -> SceneFile:
    """All that a trimesh object holds: meshes as :meth:`Scene.from_trimesh` reads them, a scene's camera, its unit.

    The object is read and never changed: a scene that was given no camera has none, though trimesh would make one when
    asked. Its lights have no area and are left out, which :attr:`Scene.notes` says.

    Parameters
    ----------
    source : trimesh.Trimesh or trimesh.Scene
        In any unit; coordinates are taken as they are.

    Returns
    -------
    SceneFile

    Raises
    ------
    SceneError
        For anything else, and as :meth:`Scene.from_trimesh`; for a camera that stands nowhere in the scene's graph.
    MissingExtra
        Where trimesh is not installed.
    """
    reader = trimesh_reader()
    return SceneFile(
        scene=Scene.from_trimesh(source),
        lights=(),
        camera=None if (view := reader.camera(source)) is None else Camera.from_trimesh(*view),
        meters_per_unit=reader.meters_per_unit(source),
    )


def _light(source: _core._FileLight) -> Light:
    name, sizes, radiance = source["name"], source["sizes"], vector("radiance", source["radiance"])
    pose = np.array(source["world_from_light"])
    match source["shape"]:
        case "rectangle":
            return RectLight(width=sizes[0], height=sizes[1], world_from_light=pose, radiance=radiance, name=name)
        case "disc":
            return DiscLight(radius=sizes[0], world_from_light=pose, radiance=radiance, name=name)
        case "sphere":
            return SphereLight(radius=sizes[0], world_from_light=pose, radiance=radiance, name=name)
        case "polygon":
            outline = np.array(sizes).reshape(-1, 2)
            return PolygonLight(outline=outline, world_from_light=pose, radiance=radiance, name=name)
        case "sun":
            # It shines along its −Z, so it stands at its +Z.
            east, height, south = pose[:3, 2].tolist()
            azimuth = math.degrees(math.atan2(east, -south))
            elevation = math.degrees(math.atan2(height, math.hypot(east, south)))
            return SunLight(azimuth, elevation, diameter_deg=sizes[0], radiance=radiance, name=name)
    raise SceneError(f"light '{name}': unknown shape '{source['shape']}'")
