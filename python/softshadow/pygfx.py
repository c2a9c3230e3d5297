"""Scenes, cameras and lights of pygfx, and visibility for its materials without leaving the device.

>>> import softshadow as ss
>>> from softshadow import pygfx as bridge
>>> from softshadow.wgpu import Host
>>> host = Host(bridge.device())  # doctest: +SKIP
>>> lamp = ss.RectLight(width=1, height=1, world_from_light=bridge.light_pose(spot_light))  # doctest: +SKIP
>>> points, normals = bridge.vertices(ground)  # doctest: +SKIP
>>> seen = host.visibility(bridge.scene(world), lamp, points=points, normals=normals)  # doctest: +SKIP
>>> ground.geometry.colors = bridge.vertex_colors(seen)  # doctest: +SKIP

pygfx has no area lights: the shape of one is described beside its light. Needs ``pip install softshadow[pygfx]``.
"""

from __future__ import annotations

import numpy as np
import pygfx
import wgpu
from numpy.typing import NDArray
from pygfx.renderers.wgpu import get_shared
from pygfx.renderers.wgpu.engine.update import ensure_wgpu_object

from .camera import Camera, look_at
from .errors import SceneError, SettingsError
from .scene import Mesh, Scene
from .wgpu import DeviceVisibility


def device() -> wgpu.GPUDevice:
    """The device that pygfx draws with."""
    return get_shared().device


def scene(root: pygfx.WorldObject) -> Scene:
    """Every visible mesh at or below an object, in world coordinates.

    The opacity of a material counts; what else it has does not, as visibility has no colour. The scene's notes name
    what is left out: instances, and objects that are no meshes.

    Raises
    ------
    SceneError
        For anything but an object of pygfx, and as :class:`softshadow.Scene` does.
    """
    if not isinstance(root, pygfx.WorldObject):
        raise SceneError(f"scene: a pygfx.WorldObject expected, got {type(root).__name__}")
    meshes: list[Mesh] = []
    notes: list[str] = []

    def visit(one: pygfx.WorldObject) -> None:
        if not one.visible:
            return
        name = one.name or f"{type(one).__name__} {len(meshes)}"
        if type(one) is pygfx.Mesh:
            opacity = 1.0 if one.material is None else float(one.material.opacity)
            meshes.append(Mesh(name=name, vertices=_positions(one), faces=_faces(one), opacity=opacity))
        elif one.geometry is not None:
            notes.append(f"'{name}' left out: {type(one).__name__} is no plain mesh")
        for child in one.children:
            visit(child)

    visit(root)
    return Scene(meshes, notes=notes)


def camera(source: pygfx.PerspectiveCamera, size: tuple[int, int]) -> Camera:
    """A camera of pygfx that fills an image of `size`, (width, height) in pixels, with its zoom and aspect.

    Raises
    ------
    SceneError
        For orthographic cameras, and where the camera is scaled.
    """
    if not isinstance(source, pygfx.PerspectiveCamera) or source.fov <= 0:
        raise SceneError(f"camera: a pygfx.PerspectiveCamera with a field of view expected, got {source!r:.80}")
    before, (width, height) = source._view_size, size
    source.set_view_size(width, height)
    clip_from_camera = np.array(source.projection_matrix, dtype=np.float64)
    source.set_view_size(*before)
    # Clip space has y upwards, pixels have it downwards; the camera looks along −Z, so what stands there is negated.
    (fx, _, x), (_, fy, y) = clip_from_camera[:2, :3]
    intrinsics = [
        [fx * width / 2, 0, (1 - x) * width / 2],
        [0, fy * height / 2, (1 + y) * height / 2],
        [0, 0, 1],
    ]
    return Camera(world_from_camera=np.array(source.world.matrix, dtype=np.float64), K=np.array(intrinsics), size=size)


def light_pose(light: pygfx.Light) -> NDArray[np.float64]:
    """The pose of a light of pygfx, ``world_from_light``, for an area light in its place.

    A light with a target emits towards it, whatever its rotation was when it was last drawn; a point light emits along
    its own −Z, which matters for flat shapes only.

    Raises
    ------
    SceneError
        For ambient light, which is nowhere, and a light at its own target.
    """
    if not isinstance(light, pygfx.Light) or isinstance(light, pygfx.AmbientLight):
        raise SceneError(f"light: a pygfx light with a place expected, got {type(light).__name__}")
    place = np.array(light.world.position, dtype=np.float64)
    if isinstance(light.parent, pygfx.Camera) or not hasattr(light, "target"):
        return look_at(place, place + np.array(light.world.forward, dtype=np.float64))
    return look_at(place, np.array(light.target.world.position, dtype=np.float64))


def vertices(mesh: pygfx.Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions and normals of a mesh's vertices in world coordinates, both (n, 3): receivers for vertex colours."""
    normals = np.array(mesh.geometry.normals.data, dtype=np.float64)
    # Normals are planes: they turn by the inverse transpose.
    return _positions(mesh), normals @ np.linalg.inv(_world(mesh)[:3, :3])


def texture(result: DeviceVisibility, size: tuple[int, int] | None = None, light: int = 0) -> pygfx.Texture:
    """The visibility of one light as a texture of pygfx, copied on the device.

    Parameters
    ----------
    result : DeviceVisibility
        Of a camera, or of points with a texel for each, row by row; the first row has texture coordinate v = 0.
    size : (width, height), optional
        For points.
    light : int
        Which one, where several were given.

    Returns
    -------
    pygfx.Texture
        Of one channel, in the colour space ``"physical"``: visibility is linear.

    Raises
    ------
    SettingsError
        Where sizes do not fit, values are coloured, or the result is on another device than pygfx's.
    """
    _check_device(result)
    rows = result.info["image"]
    if size is None and rows is None:
        raise SettingsError("size: points have none of their own; give (width, height)")
    width, height = size or (rows[1], rows[0])
    usage = wgpu.TextureUsage.COPY_DST | wgpu.TextureUsage.TEXTURE_BINDING
    made = pygfx.Texture(size=(width, height, 1), dim=2, format="1xf4", colorspace="physical", usage=usage)
    result.copy_to_texture(ensure_wgpu_object(made), light)
    return made


def vertex_colors(result: DeviceVisibility) -> pygfx.Buffer:
    """The visibility of one light as the colours of vertices: a grey each, linear, as pygfx wants them.

    Raises
    ------
    SettingsError
        Where there are several lights or coloured values, or the result is on another device than pygfx's.
    """
    _check_device(result)
    if len(result.shape) != 1:
        raise SettingsError(f"vertex colours: values of shape (vertices,) expected, got {result.shape}")
    count = result.shape[0]
    usage = wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.VERTEX
    made = pygfx.Buffer(nbytes=4 * count, nitems=count, format="f4", usage=usage)
    encoder = result.device.create_command_encoder()
    encoder.copy_buffer_to_buffer(result.buffer, 0, ensure_wgpu_object(made), 0, 4 * count)
    result.device.queue.submit([encoder.finish()])
    return made


def _check_device(result: DeviceVisibility) -> None:
    if result.device is not device():
        raise SettingsError(
            "the result is on another device than pygfx's; make the host with softshadow.pygfx.device()"
        )


def _world(mesh: pygfx.Mesh) -> NDArray[np.float64]:
    return np.array(mesh.world.matrix, dtype=np.float64)


def _positions(mesh: pygfx.Mesh) -> NDArray[np.float64]:
    world_from_mesh = _world(mesh)
    local = np.array(mesh.geometry.positions.data, dtype=np.float64)
    return np.asarray(local @ world_from_mesh[:3, :3].T + world_from_mesh[:3, 3])


def _faces(mesh: pygfx.Mesh) -> NDArray[np.uint32]:
    """Triangles; pygfx knows quads, too."""
    faces = np.array(mesh.geometry.indices.data, dtype=np.uint32)
    return faces if faces.shape[1] == 3 else np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
