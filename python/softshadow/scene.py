"""Scenes: what casts shadows and receives them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .by_value import ByValue, set_fields
from .checks import color, floats, frozen, integers, items, real, text, vector
from .errors import SceneError
from .extras import needed

if TYPE_CHECKING:
    import trimesh

_material = _core.default_material()
_BASE_COLOR, _ROUGHNESS, _SPECULAR, _OPACITY = vector("base_color", _material[0]), *_material[1:]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Mesh(ByValue):
    """Triangles in world space, two-sided; open, non-manifold and inconsistently wound ones are welcome.

    Parameters
    ----------
    vertices : (n, 3) float
        World coordinates.
    faces : (m, 3) int
        Vertex indices.
    name : str
        What error messages call it.
    base_color : (3,) float
        Linear reflectance in 0..1; only pictures use it, as `roughness` and `specular`.
    roughness, specular : float
        Of the glossy lobe; a specular of 0 leaves a matte surface.
    opacity : float or (m,) float
        Share of the light that is lost where it crosses a triangle, from either side: 1 lets nothing through, and
        with 0 the triangle is not there, for lights and for cameras. A closed box of opacity 0.5 is crossed twice and
        passes a quarter. Cameras see every other triangle as a solid surface. One number for all triangles, or one
        for each.

    Raises
    ------
    SceneError
        For a wrong dtype or shape, and for an index out of range.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    name: str = "mesh"
    base_color: tuple[float, float, float] = _BASE_COLOR
    roughness: float = _ROUGHNESS
    specular: float = _SPECULAR
    opacity: float | NDArray[np.float32] = _OPACITY

    def __post_init__(self) -> None:
        what = f"mesh '{self.name}'"
        vertices = floats(f"{what} vertices", self.vertices, ("n", 3))
        faces = integers(f"{what} faces", self.faces, ("m", 3))
        outside = (faces < 0) | (faces >= len(vertices))
        if outside.any():
            triangle, corner = (int(i) for i in np.argwhere(outside)[0])
            vertex = faces[triangle, corner]
            there_are = f"there are {len(vertices)} vertices"
            raise SceneError(f"{what}: triangle {triangle} refers to vertex {vertex}, but {there_are}")
        set_fields(
            self,
            name=text("mesh name", self.name),
            vertices=frozen(vertices),
            faces=frozen(faces.astype(np.uint32)),
            base_color=color(f"{what} base_color", self.base_color),
            roughness=real(f"{what} roughness", self.roughness),
            specular=real(f"{what} specular", self.specular),
            opacity=_opacity(f"{what} opacity", self.opacity, len(faces)),
        )

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r}: {len(self.vertices)} vertices, {len(self.faces)} triangles>"


class Scene:
    """Meshes in world space: a description that can be pickled and shared by threads.

    Parameters
    ----------
    meshes : iterable of Mesh
        Triangle ids count through them in order.
    notes : iterable of str
        What a source held that is left out: :attr:`notes`, which every result repeats.

    Raises
    ------
    SceneError
        For coordinates that are not finite and opacities outside 0..1, with the mesh's name and the first bad index.
    TooLargeError
        For more triangles than a scene may have.
    """

    __slots__ = ("_core_scene", "_meshes", "_notes")

    def __init__(self, meshes: Iterable[Mesh] = (), *, notes: Iterable[str] = ()) -> None:
        self._meshes: tuple[Mesh, ...] | None = items("scene", meshes)
        self._notes = tuple(text("scene notes", note) for note in items("scene notes", notes))
        if not all(isinstance(mesh, Mesh) for mesh in self._meshes):
            raise SceneError("scene: an iterable of Mesh expected; see Scene.from_arrays")
        self._core_scene: _core.Scene | None = _built(self._meshes, self._notes)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """The meshes of a ``.glb``, ``.gltf``, ``.obj``, ``.ply``, ``.stl`` or ``scene.json`` file.

        What is left out is listed in :attr:`notes`. Lights and camera of a ``scene.json`` come with
        :func:`softshadow.load`.

        Parameters
        ----------
        path : path
            The file; its extension, in any case, decides the format.

        Raises
        ------
        SceneFileNotFound
            Where there is no such file; also a ``FileNotFoundError``.
        SceneError
            For an unknown format and a broken file.
        TooLargeError
            For more bytes or triangles than a scene may have.
        """
        return cls._from_core(_core.Scene.load(path_name(path)))

    @classmethod
    def _from_core(cls, built: _core.Scene) -> Scene:
        scene = cls.__new__(cls)
        scene._meshes, scene._notes, scene._core_scene = None, tuple(built.notes), built
        return scene

    @classmethod
    def from_arrays(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        name: str = "mesh",
        base_color: ArrayLike = _BASE_COLOR,
        opacity: ArrayLike = _OPACITY,
    ) -> Scene:
        """A scene of one mesh.

        Parameters
        ----------
        vertices : (n, 3) float
            World coordinates, float32 or float64; copied.
        faces : (m, 3) int
            Vertex indices; copied.
        name : str
            What error messages call the mesh.
        base_color : (3,) float
            Linear reflectance in 0..1.
        opacity : float or (m,) float
            Share of the light that is lost where it crosses a triangle, in 0..1; see :class:`Mesh`.

        Raises
        ------
        SceneError
            For a wrong dtype or shape, coordinates that are not finite, indices out of range, opacities outside 0..1.
        """
        arrays: Any = {"vertices": vertices, "faces": faces, "base_color": base_color, "opacity": opacity}
        return cls([Mesh(name=name, **arrays)])

    @classmethod
    def from_trimesh(cls, source: trimesh.Trimesh | trimesh.Scene) -> Scene:
        """A scene from trimesh, which is read and never changed: nothing is merged, repaired or cached.

        Every instance in a scene's graph becomes a mesh of its own, with its transform and its node's name.
        Base colours are taken where one material or one colour covers a mesh; what is left out is listed in
        :attr:`notes`. A scene's camera comes with :func:`softshadow.from_trimesh`.

        Parameters
        ----------
        source : trimesh.Trimesh or trimesh.Scene
            Coordinates are taken as they are.

        Raises
        ------
        SceneError
            For anything but a ``Trimesh`` or a ``trimesh.Scene``, and as :meth:`from_arrays`.
        MissingExtra
            Where trimesh is not installed.
        """
        meshes, notes = trimesh_reader().read(source)
        return cls(meshes, notes=notes)

    def with_vertices(self, vertices: Iterable[ArrayLike | None]) -> Scene:
        """The same meshes with other vertices: the next frame of a scene that moves.

        Faces and materials stay. The new scene remembers where it came from, so a call with it refits what the last
        frame left (order of triangles, hierarchies, edges) instead of building it; ``result.info`` counts both and
        gives ``rebuild_reasons``. The result is that of a scene made anew from the same vertices.

        Parameters
        ----------
        vertices : iterable of (n, 3) float or None
            One entry a mesh, in world coordinates, with as many rows as the mesh has; copied. None leaves a mesh where
            it is.

        Raises
        ------
        SceneError
            Unless there is one entry a mesh, for another number of vertices, and for coordinates that are not finite,
            with the mesh's name and the first bad index.
        """
        if isinstance(vertices, np.ndarray) or not isinstance(vertices, Iterable):
            raise SceneError("scene vertices: an iterable with one array or None a mesh expected")
        rows = [
            None if given is None else floats(f"vertices of mesh {index}", given, ("n", 3))
            for index, given in enumerate(vertices)
        ]
        return self._from_core(self._built().with_vertices(rows))

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """The meshes in order; their arrays are read-only copies."""
        if self._meshes is None:
            self._meshes = _copied(self._built())
        return self._meshes

    @property
    def notes(self) -> tuple[str, ...]:
        """What a source held that the library does not model, in words."""
        return self._notes

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """(2, 3) float: lower and upper corner around all vertices; None where there are none."""
        bounds = self._built().bounds
        return None if bounds is None else np.array(bounds)

    @property
    def triangle_count(self) -> int:
        """How many triangles there are, degenerate ones included."""
        return self._built().triangle_count

    def _built(self) -> _core.Scene:
        """The scene of the core, made again after unpickling."""
        if self._core_scene is None:
            self._core_scene = _built(self.meshes, self._notes)
        return self._core_scene

    def __getstate__(self) -> tuple[tuple[Mesh, ...], tuple[str, ...]]:
        return self.meshes, self._notes

    def __setstate__(self, state: tuple[tuple[Mesh, ...], tuple[str, ...]]) -> None:
        self._meshes, self._notes = state
        self._core_scene = None

    def __repr__(self) -> str:
        return f"<Scene: {len(self.meshes)} meshes, {self.triangle_count} triangles>"


def trimesh_reader() -> Any:
    """The module that reads trimesh objects; it is imported when it is used."""
    needed("trimesh", "from_trimesh")
    return import_module("softshadow.trimesh_reader")


def path_name(path: object) -> str:
    """A path as text."""
    try:
        name = os.fsdecode(path)  # type: ignore[arg-type]
        os.fsencode(name)
        return name
    except (TypeError, UnicodeEncodeError):
        raise SceneError(f"scene: a path expected, got {path!r:.80}") from None


def _built(meshes: tuple[Mesh, ...], notes: tuple[str, ...]) -> _core.Scene:
    def row(mesh: Mesh) -> _core._FlatMesh:
        each = mesh.opacity if isinstance(mesh.opacity, np.ndarray) else None
        opacity = _OPACITY if isinstance(mesh.opacity, np.ndarray) else mesh.opacity
        material = mesh.base_color, mesh.roughness, mesh.specular, opacity
        return mesh.name, mesh.vertices, mesh.faces, *material, each

    return _core.Scene([row(mesh) for mesh in meshes], list(notes))


def _opacity(what: str, value: ArrayLike, triangles: int) -> float | NDArray[np.float32]:
    """One number, or a read-only float32 copy of one a triangle."""
    if isinstance(value, Real):
        return real(what, value)
    with np.errstate(over="ignore"):
        return frozen(floats(what, value, (triangles,)).astype(np.float32))


def _copied(scene: _core.Scene) -> tuple[Mesh, ...]:
    return tuple(
        Mesh(
            name=name,
            vertices=vertices.reshape(-1, 3),
            faces=faces.reshape(-1, 3),
            base_color=vector("base_color", base_color),
            roughness=roughness,
            specular=specular,
            opacity=opacity if each is None else each,
        )
        for name, vertices, faces, base_color, roughness, specular, opacity, each in scene.meshes()
    )
