"""The front door: calls on a device that their caller owns, and what they leave there."""

from __future__ import annotations

import json
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import wgpu
from numpy.typing import ArrayLike, NDArray

from softshadow import _core
from softshadow.camera import Camera
from softshadow.checks import memory_limit_bytes
from softshadow.errors import SettingsError
from softshadow.lights import Light, built_lights
from softshadow.scene import Scene
from softshadow.techniques import RayTraced, Technique, technique_json
from softshadow.visibility import receivers_of, scene_of

from .run import Interpreter, refusals

_VISIBILITY = "visibility"
_STANDARD_ERROR = "standard error"
_RESULT = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.VERTEX | wgpu.BufferUsage.COPY_SRC | wgpu.BufferUsage.COPY_DST
# Rows of a buffer that is copied to a texture begin at multiples of this.
_ROW_BYTES = 256


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DeviceVisibility:
    """What :meth:`Host.visibility` leaves on the device.

    Attributes
    ----------
    device : wgpu.GPUDevice
        The device.
    buffer : wgpu.GPUBuffer
        float32, the visible share of the light: 1 is fully lit. The value of a pixel that sees nothing has no meaning.
    standard_error : wgpu.GPUBuffer, or None
        Like `buffer`; None where the technique has none or it was not asked for.
    shape : tuple of int
        Of the values in the buffers, in C order: (H, W) or (points,), with several lights (lights, H, W) or
        (lights, points); a textured light adds a last axis of 3.
    info : dict
        What made the result, as in :class:`softshadow.Visibility`, and `image` and `channels`; how many receivers are
        valid is not known.
    """

    device: wgpu.GPUDevice
    buffer: wgpu.GPUBuffer
    standard_error: wgpu.GPUBuffer | None
    shape: tuple[int, ...]
    info: dict[str, Any]

    def copy_to_texture(self, texture: wgpu.GPUTexture, light: int = 0) -> None:
        """Copies what one light gives to a texture of the same device, on the device.

        Parameters
        ----------
        texture : wgpu.GPUTexture
            Of format ``"r32float"`` and usage ``COPY_DST``: as wide and high as the image, or for points with a texel
            for each, row by row.
        light : int
            Which one, where several were given.

        Raises
        ------
        SettingsError
            For coloured values, a light that there is not, and a texture of another size or format.
        GpuError
            Where the device refuses.
        """
        if self.info["channels"] != 1:
            raise SettingsError("texture: coloured values have no texture format of three channels")
        if not 0 <= light < self.info["lights"]:
            raise SettingsError(f"light: 0 to {self.info['lights'] - 1} expected, got {light}")
        (width, height), receivers, image = texture.size[:2], self.info["receivers"], self.info["image"]
        fits = width * height == receivers if image is None else [height, width] == image
        if not fits or texture.format != "r32float":
            wanted = f"{receivers} texels" if image is None else f"{image[1]} × {image[0]}"
            there = f"{texture.format} of {width} × {height}"
            raise SettingsError(f"texture: r32float of {wanted} expected, got {there}")
        row = 4 * width
        whole = row % _ROW_BYTES == 0
        parts = [(0, height)] if whole else [(y, 1) for y in range(height)]
        with refusals(self.device, "copy to a texture"):
            encoder = self.device.create_command_encoder()
            for y, rows in parts:
                offset, stride = 4 * receivers * light + row * y, -(-row // _ROW_BYTES) * _ROW_BYTES
                encoder.copy_buffer_to_texture(
                    {"buffer": self.buffer, "offset": offset, "bytes_per_row": stride, "rows_per_image": rows},
                    {"texture": texture, "origin": (0, y, 0)},
                    (width, rows, 1),
                )
            self.device.queue.submit([encoder.finish()])

    def read(self) -> NDArray[np.float32]:
        """A copy of the values on the processor: float32 of `shape`."""
        with refusals(self.device, "read"):
            size = 4 * int(np.prod(self.shape))
            data = self.device.queue.read_buffer(self.buffer, 0, size) if size else b""
        return np.frombuffer(data, np.float32).reshape(self.shape)

    def __repr__(self) -> str:
        return f"<DeviceVisibility of shape {self.shape}>"


class Host:
    """Runs techniques on a device that somebody else owns, and keeps pipelines and scenes for it.

    Whatever is submitted goes to the device's queue before a call returns, so what is submitted later sees the result.
    A call cannot be put into an encoder of yours: long passes are split into submissions, and some techniques choose
    their next stage by what the last one found. Calls of several threads take turns.

    Parameters
    ----------
    device : wgpu.GPUDevice
        The device; its limits and features are what calls are checked against. ``float32-blendable`` is the only
        feature that a technique may ask for.

    Raises
    ------
    SettingsError
        For anything but a device.
    """

    def __init__(self, device: wgpu.GPUDevice) -> None:
        if not isinstance(device, wgpu.GPUDevice):
            raise SettingsError(f"device: a wgpu.GPUDevice expected, got {type(device).__name__}")
        self.device = device
        self._foreign = _core.ForeignDevice(json.dumps(_described(device)))
        self._interpreter = Interpreter(device)
        self._turn = threading.Lock()

    def visibility(
        self,
        scene: Scene,
        lights: Light | Sequence[Light],
        *,
        camera: Camera | None = None,
        points: ArrayLike | None = None,
        normals: ArrayLike | None = None,
        technique: Technique = RayTraced(),  # noqa: B008 - frozen
        memory_limit: int | None = None,
        standard_error: bool = False,
        into: wgpu.GPUBuffer | None = None,
    ) -> DeviceVisibility:
        """As :func:`softshadow.visibility`, with the values left on the device.

        Parameters
        ----------
        scene, lights, camera, points, normals, technique, memory_limit
            As there.
        standard_error : bool
            Whether to leave it on the device, too, where the technique has one.
        into : wgpu.GPUBuffer, optional
            Where to leave visibility: a buffer of usage ``COPY_DST``, at least as large as the values. Otherwise each
            call makes a new one.

        Raises
        ------
        SceneError, SettingsError, TooLargeError
            As there, before anything is made on the device.
        GpuError
            Where the device refuses, is lost or runs out of memory.
        """
        built, several = built_lights(lights)
        where = receivers_of(camera, points, normals)
        call = self._foreign.visibility(
            scene_of(scene),
            built,
            **where.arguments,
            technique=technique_json("technique", technique),
            memory_limit=memory_limit_bytes(memory_limit),
            standard_error=bool(standard_error),
        )
        channels = call.channels
        shape = ((len(built),) if several else ()) + where.shape + ((channels,) if channels > 1 else ())
        sizes = dict(call.results)
        if into is not None:
            _check_result(into, sizes[_VISIBILITY])
        with self._turn, refusals(self.device, "visibility", self._interpreter.pool):
            made = {
                name: self._result(name, size) for name, size in sizes.items() if name != _VISIBILITY or into is None
            }
            results = made if into is None else {**made, _VISIBILITY: into}
            info = self._interpreter.run(call, results)
        info |= {"image": list(where.shape) if len(where.shape) == 2 else None, "channels": channels}
        return DeviceVisibility(
            device=self.device,
            buffer=results[_VISIBILITY],
            standard_error=results.get(_STANDARD_ERROR),
            shape=shape,
            info=info,
        )

    def _result(self, name: str, size: int) -> wgpu.GPUBuffer:
        # A binding has at least a word.
        return self.device.create_buffer(label=name, size=max(size, 4), usage=_RESULT)


def _check_result(buffer: object, size: int) -> None:
    if not isinstance(buffer, wgpu.GPUBuffer):
        raise SettingsError(f"into: a wgpu.GPUBuffer expected, got {type(buffer).__name__}")
    if buffer.size < size or not buffer.usage & wgpu.BufferUsage.COPY_DST:
        raise SettingsError(f"into: at least {size} bytes and usage COPY_DST are needed, got {buffer.size} bytes")


def _described(device: wgpu.GPUDevice) -> dict[str, Any]:
    """A device as the core knows one."""
    info, limits = device.adapter.info, device.limits
    backend = str(info["backend_type"]).lower()
    return {
        "name": info["device"],
        "backend": {"opengl": "gl", "d3d12": "dx12"}.get(backend, backend),
        "is_software": info["adapter_type"] == "CPU",
        "driver": f"{info['vendor']} {info['description']}".strip(),
        "features": sorted(device.features),
        "storage_binding_bytes": limits["max-storage-buffer-binding-size"],
        "buffer_bytes": limits["max-buffer-size"],
        "texture_size": limits["max-texture-dimension-2d"],
        "texture_layers": limits["max-texture-array-layers"],
        "groups": limits["max-compute-workgroups-per-dimension"],
        "storage_buffers": limits["max-storage-buffers-per-shader-stage"],
        "color_targets": limits["max-color-attachments"],
        "color_bytes": limits["max-color-attachment-bytes-per-sample"],
    }
