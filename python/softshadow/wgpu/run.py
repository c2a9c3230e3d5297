"""The interpreter: stages of a call as commands of a device. It does what passes say, and knows no technique."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import wgpu

from softshadow import _core
from softshadow.errors import GpuError, GpuOutOfMemory

from .encode import Encoding, slices_of
from .pipelines import Pipelines
from .pool import Pool


class Interpreter:
    """Runs stages on one device, and keeps pipelines and buffers for it."""

    def __init__(self, device: wgpu.GPUDevice) -> None:
        self._device = device
        self._pipelines = Pipelines(device)
        self.pool = Pool(device)

    def run(self, call: _core.ForeignCall, results: dict[str, wgpu.GPUBuffer]) -> dict[str, Any]:
        """Runs a call, leaves its results in buffers by name, and returns what made them."""
        self.pool.begin_run()
        self.pool.forget(call.superseded)
        started, submissions = time.perf_counter(), 0
        outputs: list[dict[str, bytes]] = []
        decision = b""
        while (made := call.stage(len(outputs), decision)) is not None:
            stage = json.loads(made["description"])
            read, count = self._run_stage(stage, made["values"], call, results)
            resources, chosen_by = stage["plan"]["resources"], stage["plan"]["decision"]
            decision = b"" if chosen_by is None else read[chosen_by]
            outputs.append({resources[output]["label"]: read[output] for output in stage["plan"]["outputs"]})
            submissions += count
        wall_ms = (time.perf_counter() - started) * 1e3
        info: dict[str, Any] = json.loads(call.finish(outputs, wall_ms, submissions))
        return info

    def _run_stage(
        self,
        stage: dict[str, Any],
        values: dict[str, bytes],
        call: _core.ForeignCall,
        results: dict[str, wgpu.GPUBuffer],
    ) -> tuple[dict[int, bytes], int]:
        """What the stage's outputs and its decision hold, by resource, and how many submissions it took."""
        plan, queue = stage["plan"], self._device.queue
        slots = [self.pool.slot(resource, call.upload) for resource in plan["resources"]]
        for resource, slot in zip(plan["resources"], slots, strict=True):
            if resource["origin"] == "parameter":
                value = values[resource["label"]]
                queue.write_buffer(slot, 0, value + bytes(-len(value) % 4))
        parts = slices_of([dispatch for dispatches in stage["submissions"] for dispatch in dispatches])
        usage = wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.COPY_DST
        slices = self._device.create_buffer(label="slice", size=len(parts), usage=usage)
        queue.write_buffer(slices, 0, parts)
        encoding = Encoding(self._device, self._pipelines, stage, slots, slices)
        wanted = list(dict.fromkeys([*plan["outputs"], *([] if plan["decision"] is None else [plan["decision"]])]))
        read: dict[int, bytes] = {}
        for dispatches in stage["submissions"]:
            encoder = self._device.create_command_encoder(label=plan["name"])
            for dispatch in dispatches:
                encoding.dispatch(dispatch, encoder)
            if dispatches is not stage["submissions"][-1]:
                self._finish(encoder, {})
                continue
            for part in stage["deliveries"]:
                source, target = slots[part["output"]], results[part["result"]]
                encoder.copy_buffer_to_buffer(source, part["source"], target, part["target"], part["bytes"])
            read = self._finish(encoder, {output: slots[output] for output in wanted})
        slices.destroy()
        return read, len(stage["submissions"])

    def _finish(self, encoder: wgpu.GPUCommandEncoder, wanted: dict[int, wgpu.GPUBuffer]) -> dict[int, bytes]:
        """Submits, waits, and reads small buffers back. Where there are none, a word that it clears is waited for."""
        places, end = {}, 8
        for output, buffer in wanted.items():
            places[output] = end, buffer.size
            end += -(-buffer.size // 8) * 8
        usage = wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.MAP_READ
        back = self._device.create_buffer(label="read back", size=end, usage=usage)
        encoder.clear_buffer(back, 0, 8)
        for output, (offset, size) in places.items():
            encoder.copy_buffer_to_buffer(wanted[output], 0, back, offset, size)
        self._device.queue.submit([encoder.finish()])
        # The copies stand in this submission: wgpu-py need not submit another to see them.
        back.map_sync("READ_NOSYNC")
        read = {output: bytes(back.read_mapped(*place, copy=False)) for output, place in places.items()}
        back.destroy()
        return read


@contextmanager
def refusals(device: wgpu.GPUDevice, stage: str, pool: Pool | None = None) -> Iterator[None]:
    """Errors of the device as ours. Whatever a failed call left behind is not trusted again."""
    try:
        yield
    except BaseException as error:
        if pool is not None:
            pool.clear()
        if isinstance(error, wgpu.GPUOutOfMemoryError):
            raise GpuOutOfMemory(f"the device is out of memory while running '{stage}': {error}") from error
        # A buffer that could not be mapped is a RuntimeError to wgpu-py.
        if not isinstance(error, (wgpu.GPUError, RuntimeError)) or isinstance(error, GpuError):
            raise
        what = "was lost while running" if _is_lost(device) else "refuses"
        raise GpuError(f"the device {what} '{stage}': {error}") from error


def _is_lost(device: wgpu.GPUDevice) -> bool:
    """Whether the device refuses even nothing."""
    try:
        device.create_command_encoder().finish()
    except wgpu.GPUError:
        return True
    return False
