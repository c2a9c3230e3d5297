// Triangles that touch a ball of light, against every sample: where they dip into it, their shadow ends in a curve that is no edge.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/triangle.wgsl
//#import shared/samples.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var<uniform> touching_range: TouchingRange;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> light_samples: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> touching: array<Corner>;
@group(0) @binding(7) var<storage, read_write> blocked: array<u32>;

// Triangles of this pass.
struct TouchingRange {
    first: u32,
    end: u32,
    reserved0: u32,
    reserved1: u32,
}

fn is_blocked(receiver: Receiver, way: vec3<f32>) -> bool {
    var hit = false;
    for (var k = touching_range.first; k < touching_range.end && !hit; k++) {
        let a = touching[3u * k];
        let blocks = triangle_blocks(
            a.position, touching[3u * k + 1u].position, touching[3u * k + 2u].position, receiver.position, way, false,
        );
        hit = blocks && a.triangle != receiver.triangle;
    }
    return hit;
}

// One invocation a word of a receiver's mask.
@compute @workgroup_size(64)
fn try_touching(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let item = slice.first + invocation.x;
    let receiver = receivers[item / sampling.words];
    let view = light_view(light, receiver.position);
    if (receiver.kind == RECEIVER_NONE || view.inside) {
        return;
    }
    let first = 32u * (item % sampling.words);
    let own_set = first_sample(sampling, item / sampling.words);
    let count = min(32u, sampling.count - first);
    var waiting = ~blocked[item] & (0xffffffffu >> (32u - count));
    var hidden = 0u;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let way = light_way(light_sample(light, view, light_samples[own_set + first + k], receiver.position), receiver.position);
        hidden |= select(0u, 1u << k, is_blocked(receiver, way));
    }
    blocked[item] |= hidden;
}
