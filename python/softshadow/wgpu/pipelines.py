"""Pipelines by kernel, made at first use and kept. Layouts come from the shader itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import wgpu

from softshadow import _core

_CORNERS = {
    "array_stride": 16,
    "step_mode": "vertex",
    "attributes": [
        {"format": "float32x3", "offset": 0, "shader_location": 0},
        {"format": "uint32", "offset": 12, "shader_location": 1},
    ],
}


class Pipelines:
    """The pipelines of one device, each with the layout of its only group of bindings."""

    def __init__(self, device: wgpu.GPUDevice) -> None:
        self._device = device
        self._modules: dict[str, wgpu.GPUShaderModule] = {}
        self._made: dict[object, tuple[Any, Any]] = {}

    def compute(self, kernel: dict[str, str]) -> tuple[Any, Any]:
        """The pipeline of a compute kernel, and its layout."""

        def make() -> Any:
            stage = {"module": self._module(kernel["file"]), "entry_point": kernel["entry"]}
            return self._device.create_compute_pipeline(label=kernel["entry"], layout="auto", compute=stage)

        return self._kept((kernel["file"], kernel["entry"]), True, make)

    def raster(self, raster: dict[str, Any], resources: list[dict[str, Any]], binds: bool) -> tuple[Any, Any]:
        """The pipeline of a raster pass, and its layout where it binds anything."""
        kernel, depth = raster["kernel"], raster["depth"]
        colors = [(_format(resources, color), color["blend"]) for color in raster["colors"]]
        compare = depth and (_format(resources, depth), depth["compare"])
        has_corners = "corners" in raster["vertices"]
        key = (*kernel.values(), *colors, compare, has_corners)
        return self._kept(key, binds, lambda: self._raster(kernel, colors, compare, has_corners))

    def _raster(
        self, kernel: dict[str, Any], colors: list[tuple[str, str]], depth: tuple[str, str] | None, has_corners: bool
    ) -> Any:
        module = self._module(kernel["file"])
        targets = [{"format": texels, **_blend(blend)} for texels, blend in colors]
        buffers = [_CORNERS] if has_corners else []
        return self._device.create_render_pipeline(
            label=kernel["vertex"],
            layout="auto",
            vertex={"module": module, "entry_point": kernel["vertex"], "buffers": buffers},
            primitive={"topology": "triangle-list"},
            depth_stencil=depth and {"format": depth[0], "depth_write_enabled": True, "depth_compare": depth[1]},
            fragment=kernel["fragment"] and {"module": module, "entry_point": kernel["fragment"], "targets": targets},
        )

    def _kept(self, key: object, binds: bool, make: Callable[[], Any]) -> tuple[Any, Any]:
        if key not in self._made:
            pipeline = make()
            self._made[key] = pipeline, pipeline.get_bind_group_layout(0) if binds else None
        return self._made[key]

    def _module(self, file: str) -> wgpu.GPUShaderModule:
        if file not in self._modules:
            self._modules[file] = self._device.create_shader_module(label=file, code=_core.shader(file))
        return self._modules[file]


def _format(resources: list[dict[str, Any]], target: dict[str, Any]) -> str:
    return str(resources[target["texture"]]["shape"]["texture"]["format"])


def _blend(blend: str) -> dict[str, Any]:
    if blend == "replace":
        return {}
    component = {"src_factor": "one", "dst_factor": "one", "operation": blend}
    return {"blend": {"color": component, "alpha": component}}
