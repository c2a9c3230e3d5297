"""One pass as commands: pipeline, bindings, targets, and how many invocations."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import wgpu

from .pipelines import Pipelines
from .pool import Slot

# Distance of two slices in their buffer; at least the uniform offset alignment of every device.
_SLICE_STRIDE = 256


@dataclass(frozen=True, eq=False)
class Encoding:
    """What the passes of one plan refer to while they are encoded.

    Attributes
    ----------
    device : wgpu.GPUDevice
        The device.
    pipelines : Pipelines
        Its pipelines.
    stage : dict
        The plan, its bindings and its dispatches.
    slots : list
        Buffers and textures by resource.
    slices : wgpu.GPUBuffer
        The parts of the items, one a dispatch.
    """

    device: wgpu.GPUDevice
    pipelines: Pipelines
    stage: dict[str, Any]
    slots: list[Slot]
    slices: wgpu.GPUBuffer

    def dispatch(self, dispatch: dict[str, int], encoder: wgpu.GPUCommandEncoder) -> None:
        """Encodes one dispatch, with its pass around it."""
        one = self.stage["plan"]["passes"][dispatch["pass"]]
        bindings = self.stage["bindings"][dispatch["pass"]]
        match one["work"]:
            case {"clear": {"target": target}}:
                encoder.clear_buffer(self.slots[target])
            case {"copy": {"source": source, "target": target, "bytes": size}}:
                encoder.copy_buffer_to_buffer(self.slots[source], 0, self.slots[target], 0, size)
            case {"compute": {"kernel": kernel, "over": over}}:
                pipeline, layout = self.pipelines.compute(kernel)
                group = self._group(one["label"], layout, bindings, dispatch["slice"])
                compute = encoder.begin_compute_pass(label=one["label"])
                compute.set_pipeline(pipeline)
                compute.set_bind_group(0, group)
                if "indirect" in over:
                    compute.dispatch_workgroups_indirect(self.slots[over["indirect"]], 0)
                else:
                    compute.dispatch_workgroups(dispatch["groups"])
                compute.end()
            case {"raster": raster}:
                self._raster(one["label"], raster, bindings, encoder)

    def _raster(
        self, label: str, raster: dict[str, Any], bindings: list[dict[str, Any]], encoder: wgpu.GPUCommandEncoder
    ) -> None:
        pipeline, layout = self.pipelines.raster(raster, self.stage["plan"]["resources"], bool(bindings))
        colors, depth = raster["colors"], raster["depth"]
        attachments = [
            {"view": self._layer(color), "store_op": "store", **_load("load_op", "clear_value", color["clear"], 4)}
            for color in colors
        ]
        depth_attachment = depth and {
            "view": self._layer(depth),
            "depth_store_op": "store",
            **_load("depth_load_op", "depth_clear_value", depth["clear"], 1),
        }
        draw = encoder.begin_render_pass(
            label=label, color_attachments=attachments, depth_stencil_attachment=depth_attachment
        )
        draw.set_pipeline(pipeline)
        if bindings:
            draw.set_bind_group(0, self._group(label, layout, bindings, 0))
        match raster["vertices"]:
            case {"corners": {"buffer": buffer, "count": count}}:
                draw.set_vertex_buffer(0, self.slots[buffer])
                draw.draw(count)
            case {"generated": {"fixed": count}}:
                draw.draw(count)
            case {"generated": {"indirect": counts}}:
                draw.draw_indirect(self.slots[counts], 0)
        draw.end()

    def _group(self, label: str, layout: Any, bindings: list[dict[str, Any]], index: int) -> wgpu.GPUBindGroup:
        entries = [{"binding": b["binding"], "resource": self._bound(b, index)} for b in bindings]
        return self.device.create_bind_group(label=label, layout=layout, entries=entries)

    def _bound(self, binding: dict[str, Any], index: int) -> object:
        if binding["resource"] is None:
            return {"buffer": self.slices, "offset": index * _SLICE_STRIDE, "size": 8}
        slot = self.slots[binding["resource"]]
        if isinstance(slot, wgpu.GPUTexture):
            return slot.create_view(dimension="2d-array" if binding["is_array"] else "2d")
        return {"buffer": slot, "offset": 0, "size": slot.size}

    def _layer(self, target: dict[str, Any]) -> wgpu.GPUTextureView:
        texture = self.slots[target["texture"]]
        return texture.create_view(dimension="2d", base_array_layer=target["layer"], array_layer_count=1)


def slices_of(dispatches: list[dict[str, int]]) -> bytes:
    """The parts of the items that dispatches cover, each at its place in the buffer."""
    parts = bytearray(max(len(dispatches), 1) * _SLICE_STRIDE)
    for dispatch in dispatches:
        struct.pack_into("<II", parts, dispatch["slice"] * _SLICE_STRIDE, dispatch["first"], dispatch["count"])
    return bytes(parts)


def _load(operation: str, name: str, value: float | None, components: int) -> dict[str, Any]:
    if value is None:
        return {operation: "load"}
    return {operation: "clear", name: (value,) * components if components > 1 else value}
