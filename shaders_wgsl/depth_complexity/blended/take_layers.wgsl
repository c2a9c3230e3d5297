// Takes the layers of shadow volumes for the depth of the reference point. Where that is hidden, all samples are, until an edge says
// otherwise.
//#import shared/slice.wgsl
//#import depth_complexity/frame.wgsl
//#import depth_complexity/tiles.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<storage, read> layers: array<i32>;
@group(0) @binding(3) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(4) var<storage, read_write> blocked: array<u32>;

@compute @workgroup_size(64)
fn take_layers(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let at = slice.first + invocation.x;
    let slot = slots[at];
    if (slot.depth == NO_VIEW) {
        return;
    }
    let depth = layers[slot.receiver];
    slots[at].depth = depth;
    let words = (light_frame.sample_count + 31u) / 32u;
    for (var word = 0u; word < select(0u, words, depth != 0); word++) {
        blocked[slot.receiver * words + word] = 0xffffffffu;
    }
}
