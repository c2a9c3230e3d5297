"""Buffers and textures of plans, kept between runs and given back when they have not been used for a while."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import wgpu

Slot: TypeAlias = wgpu.GPUBuffer | wgpu.GPUTexture

# Runs after which uploads that were not used are given back; what else was not used in a run is given back after it.
_KEPT_RUNS = 8
_BUFFER = wgpu.BufferUsage
_WRITTEN = _BUFFER.STORAGE | _BUFFER.VERTEX | _BUFFER.INDIRECT | _BUFFER.COPY_SRC | _BUFFER.COPY_DST
_UPLOADED = _BUFFER.STORAGE | _BUFFER.VERTEX | _BUFFER.COPY_DST
_PARAMETER = _BUFFER.UNIFORM | _BUFFER.STORAGE | _BUFFER.COPY_DST


class Pool:
    """What plans have made on one device."""

    def __init__(self, device: wgpu.GPUDevice) -> None:
        self._device = device
        self._slots: dict[object, tuple[Slot, int]] = {}
        self._run = 0

    def begin_run(self) -> None:
        """Gives back what has not been used for a while."""
        self._run += 1
        kept = {key: used + (_KEPT_RUNS if isinstance(key, int) else 1) for key, (_, used) in self._slots.items()}
        self.forget([key for key, until in kept.items() if until < self._run])

    def forget(self, keys: Iterable[object]) -> None:
        """Gives back what will not be used again."""
        for key in keys:
            if key in self._slots:
                self._slots.pop(key)[0].destroy()

    def clear(self) -> None:
        """Gives everything back."""
        self.forget(list(self._slots))

    def slot(self, resource: dict[str, Any], upload: Callable[[int], bytes]) -> Slot:
        """The buffer or texture of a resource; contents are uploaded when they are new."""
        origin, shape = resource["origin"], resource["shape"]
        content = origin.get("uploaded") if isinstance(origin, dict) else None
        # Labels are unique within a plan, and runs do not overlap. Parameters are apart, because they can be uniforms.
        key = content if content is not None else (resource["label"], repr(shape), origin == "parameter")
        if key in self._slots:
            slot = self._slots[key][0]
        elif "texture" in shape:
            texture = shape["texture"]
            slot = self._texture(resource["label"], texture["format"], texture["size"], texture["layers"])
        else:
            usage = _UPLOADED if content is not None else _PARAMETER if origin == "parameter" else _WRITTEN
            slot = self._buffer(resource["label"], shape["buffer"]["bytes"], usage)
            if content is not None:
                self._device.queue.write_buffer(slot, 0, upload(content))
        self._slots[key] = slot, self._run
        return slot

    def _buffer(self, label: str, size: int, usage: int) -> wgpu.GPUBuffer:
        # Copies move whole words.
        return self._device.create_buffer(label=label, size=-(-size // 4) * 4, usage=usage)

    def _texture(self, label: str, texels: str, size: list[int], layers: int) -> wgpu.GPUTexture:
        usage = wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.TEXTURE_BINDING
        return self._device.create_texture(label=label, size=(*size, layers), format=texels, usage=usage)
