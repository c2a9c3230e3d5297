// Opens the masks: samples below the receiver's horizon are blocked, and all are where there is no view of the light.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/horizon.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/sample_sets.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> frame_samples: FrameSamples;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> order: array<u32>;
@group(0) @binding(5) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(6) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(7) var<uniform> sampling: Sampling;
@group(0) @binding(8) var<uniform> sample_sets: SampleSets;

@compute @workgroup_size(64)
fn open_masks(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let at = slice.first + invocation.x;
    let index = order[at];
    let receiver = receivers[index];
    let view = frame_view(light_frame, receiver.position);
    let words = (light_frame.sample_count + 31u) / 32u;
    let sees = receiver.kind != RECEIVER_NONE && view.exists;
    let is_inside = receiver.kind != RECEIVER_NONE && view.inside;
    let slope = horizon_slope(view, receiver);
    let crosses = sees && !is_above_horizon(light_frame, receiver, slope);
    var visible = 0u;
    for (var word = 0u; word < words; word++) {
        var mask = select(0xffffffffu, 0u, sees || is_inside);
        let here = min(32u, light_frame.sample_count - 32u * word);
        for (var bit = 0u; bit < select(0u, here, crosses); bit++) {
            let s = placed_sample(light_frame, view, frame_samples.at[32u * word + bit].xy);
            mask |= select(0u, 1u << bit, slope.z + slope.x * s.x + slope.y * s.y <= 0.0);
        }
        blocked[index * words + word] = mask;
        visible += here - countOneBits(mask & (0xffffffffu >> (32u - here)));
    }
    slots[at] = Slot(index, 0u, select(NO_VIEW, 0, sees && visible > 0u), 0);
}

// The same where every receiver has its own set of samples.
@compute @workgroup_size(64)
fn open_masks_of_sets(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let at = slice.first + invocation.x;
    let index = order[at];
    let receiver = receivers[index];
    let view = frame_view(light_frame, receiver.position);
    let words = (light_frame.sample_count + 31u) / 32u;
    let sees = receiver.kind != RECEIVER_NONE && view.exists;
    let is_inside = receiver.kind != RECEIVER_NONE && view.inside;
    let slope = horizon_slope(view, receiver);
    let crosses = sees && !is_above_horizon(light_frame, receiver, slope);
    let first = first_sample(sampling, index);
    var visible = 0u;
    for (var word = 0u; word < words; word++) {
        var mask = select(0xffffffffu, 0u, sees || is_inside);
        let here = min(32u, light_frame.sample_count - 32u * word);
        for (var bit = 0u; bit < select(0u, here, crosses); bit++) {
            let sample = first + 32u * word + bit;
            let s = placed_sample(light_frame, view, of_pair(sample_sets.pairs[sample >> 1u], sample));
            mask |= select(0u, 1u << bit, slope.z + slope.x * s.x + slope.y * s.y <= 0.0);
        }
        blocked[index * words + word] = mask;
        visible += here - countOneBits(mask & (0xffffffffu >> (32u - here)));
    }
    slots[at] = Slot(index, 0u, select(NO_VIEW, 0, sees && visible > 0u), 0);
}
