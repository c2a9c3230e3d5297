"""Reads trimesh objects. trimesh is imported only here, and only when it is used."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from .errors import SceneError
from .scene import Mesh


def read(source: object) -> tuple[list[Mesh], list[str]]:
    """Meshes with their transforms applied, and what was left out."""
    notes: list[str] = []
    if isinstance(source, trimesh.Trimesh):
        return [_mesh(source, str(source.metadata.get("name", "mesh")), np.eye(4), notes)], notes
    if not isinstance(source, trimesh.Scene):
        kind = type(source).__name__
        raise SceneError(f"from_trimesh: a trimesh.Trimesh or trimesh.Scene expected, got {kind}")
    meshes = []
    for node in source.graph.nodes_geometry:
        world_from_mesh, geometry_name = source.graph[node]
        geometry = source.geometry[geometry_name]
        if isinstance(geometry, trimesh.Trimesh):
            meshes.append(_mesh(geometry, str(node), np.asarray(world_from_mesh, dtype=np.float64), notes))
        else:
            notes.append(f"'{node}' left out: {type(geometry).__name__} is no mesh")
    if lights := getattr(source, "_lights", None):
        notes.append(f"{len(lights)} lights without an area left out")
    return meshes, notes


def camera(source: object) -> tuple[Any, NDArray[np.float64]] | None:
    """A scene's camera and its pose, where it was given one; asking a scene without one would make one."""
    if not isinstance(source, trimesh.Scene) or not source.has_camera:
        return None
    name = source.camera.name
    if name not in source.graph.nodes:
        raise SceneError(f"camera '{name}': it stands nowhere in the scene's graph; set scene.camera_transform")
    return source.camera, np.array(source.graph[name][0], dtype=np.float64)


def meters_per_unit(source: Any) -> float | None:
    """Metres a unit; None where meshes have none, different ones, or one that trimesh does not know."""
    geometries = source.geometry.values() if isinstance(source, trimesh.Scene) else [source]
    units = {geometry.units for geometry in geometries}
    if len(units) != 1 or None in units:
        return None
    try:
        return float(trimesh.units.unit_conversion(units.pop(), "meters"))
    except (KeyError, ValueError):
        return None


def _mesh(source: trimesh.Trimesh, name: str, world_from_mesh: NDArray[np.float64], notes: list[str]) -> Mesh:
    vertices = np.array(source.vertices, dtype=np.float64, subok=False)
    moved = vertices @ world_from_mesh[:3, :3].T + world_from_mesh[:3, 3]
    material = _material(source.visual, name, notes)
    return Mesh(name=name, vertices=moved, faces=np.array(source.faces, subok=False), **material)


def _material(visual: Any, name: str, notes: list[str]) -> dict[str, Any]:
    """The one colour of a mesh, and its opacity; trimesh keeps linear colours as bytes, as it reads and writes glTF."""
    if visual.kind == "texture":
        material = visual.material
        images = (getattr(material, name, None) for name in ("baseColorTexture", "image"))
        if any(image is not None for image in images):
            notes.append(f"textures of '{name}' left out")
        if getattr(material, "baseColorFactor", material.main_color) is None:
            return {"base_color": (1.0, 1.0, 1.0)}
        color = np.asarray(material.main_color) / 255.0
        # Alpha is opacity where it blends, as in glTF, and means nothing elsewhere.
        opacity = {"opacity": float(color[3])} if getattr(material, "alphaMode", None) == "BLEND" else {}
        return {"base_color": tuple(color[:3].tolist()), **opacity}
    if visual.kind in ("face", "vertex"):
        colors = np.unique(visual.face_colors if visual.kind == "face" else visual.vertex_colors, axis=0)
    else:
        return {}
    if len(colors) != 1:
        notes.append(f"{visual.kind} colours of '{name}' left out")
        return {}
    return {"base_color": tuple((colors[0, :3] / 255.0).tolist())}
