// The largest counters that any receiver can get: by them the next stage chooses how wide digits are.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/blended/hull.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> wedge_view: WedgeView;
@group(0) @binding(2) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(3) var<storage, read> slots: array<Slot>;
@group(0) @binding(4) var<storage, read> changes: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> largest: Largest;

struct Largest {
    count: atomic<u32>,     // at the reference point, and all that can be added
    fall: atomic<u32>,      // all that can be taken away
    initial: atomic<u32>,   // at the reference point alone
    astray: atomic<u32>,    // receivers that stand farther from the middle of their pixel than wedges are widened
}

// How many pixels a receiver stands from the middle of its own.
fn off_pixel(index: u32, position: vec3<f32>) -> f32 {
    let p = position - wedge_view.eye;
    let w = dot(wedge_view.forward, p);
    let ndc = vec2<f32>(dot(wedge_view.clip_x, p), dot(wedge_view.clip_y, p)) / max(w, 1e-30);
    let size = vec2<f32>(vec2<u32>(wedge_view.width, wedge_view.receiver_count / wedge_view.width));
    let seen = (vec2<f32>(ndc.x, -ndc.y) * 0.5 + 0.5) * size;
    let pixel = vec2<f32>(vec2<u32>(index % wedge_view.width, index / wedge_view.width)) + 0.5;
    let off = abs(seen - pixel);
    return max(off.x, off.y);
}

@compute @workgroup_size(64)
fn find_largest(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let slot = slots[slice.first + invocation.x];
    if (slot.depth == NO_VIEW) {
        return;
    }
    let change = changes[slot.receiver];
    let initial = u32(abs(slot.depth));
    // Where nothing changes nothing is counted.
    if (change.x + change.y > 0u) {
        atomicMax(&largest.count, initial + change.x);
        atomicMax(&largest.fall, change.y);
        atomicMax(&largest.initial, initial);
    }
    if (off_pixel(slot.receiver, receivers[slot.receiver].position) > 0.5 * PIXEL_MARGIN) {
        atomicAdd(&largest.astray, 1u);
    }
}
