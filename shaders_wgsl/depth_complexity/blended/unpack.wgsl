// Turns counters into masks: a sample is blocked where its count is not 0, or where it lies below the receiver's horizon.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/horizon.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/blended/packing.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> frame_samples: FrameSamples;
@group(0) @binding(3) var<uniform> packing: Packing;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> slots: array<Slot>;
@group(0) @binding(6) var<storage, read> changes: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(8) var<storage, read> words: array<u32>;
@group(0) @binding(9) var targets: texture_2d_array<f32>;

// The samples of one receiver that are looked at, word by word of its mask.
struct Masking {
    receiver: u32,
    depth: u32,             // with the bias, in every digit
    mask: u32,
    exists: bool,
}

fn masking_of(at: u32) -> Masking {
    let slot = slots[at];
    let change = changes[slot.receiver];
    // Where no edge changes anything, the masks stand already.
    let exists = slot.depth != NO_VIEW && change.x + change.y > 0u;
    var ones = 0u;
    for (var k = 0u; k < packing.fields; k++) {
        ones |= 1u << (k * packing.bits);
    }
    return Masking(slot.receiver, (u32(slot.depth) + packing.bias) * ones, 0u, exists);
}

// The digits of a word whose count is not 0, as bits of the mask, from the lowest sample of the word on. What begins a new word of the
// mask has written the one before.
fn masked(before: Masking, view: FrameView, slope: vec3<f32>, crosses_horizon: bool, word: u32, value: u32) -> Masking {
    var masking = before;
    let sum = value + masking.depth;
    let first = lowest_sample(packing, word);
    let largest = 0xffffffffu >> (32u - packing.bits);
    for (var k = 0u; k < packing.fields; k++) {
        let within = first + k;
        let sample = packing.first_sample + within;
        if (within < packing.sample_count) {
            let digit = (sum >> (k * packing.bits)) & largest;
            let s = placed_sample(light_frame, view, frame_samples.at[sample].xy);
            let below = crosses_horizon && slope.z + slope.x * s.x + slope.y * s.y <= 0.0;
            masking.mask |= select(0u, 1u << (sample & 31u), digit != packing.bias || below);
            let is_last = within + 1u == packing.sample_count;
            if ((sample & 31u) == 31u || is_last) {
                let mask_words = (light_frame.sample_count + 31u) / 32u;
                let at = masking.receiver * mask_words + (sample >> 5u);
                // Samples of the same word that an earlier draw counted.
                let earlier = (1u << (max(packing.first_sample, sample & ~31u) & 31u)) - 1u;
                blocked[at] = (blocked[at] & earlier) | masking.mask;
                masking.mask = 0u;
            }
        }
    }
    return masking;
}

@compute @workgroup_size(64)
fn unpack_words(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    var masking = masking_of(slice.first + invocation.x);
    let receiver = receivers[masking.receiver];
    let view = frame_view(light_frame, receiver.position);
    let slope = horizon_slope(view, receiver);
    let crosses_horizon = !is_above_horizon(light_frame, receiver, slope);
    for (var word = 0u; word < select(0u, packing.words, masking.exists); word++) {
        masking = masked(masking, view, slope, crosses_horizon, word, words[masking.receiver * packing.words + word]);
    }
}

@compute @workgroup_size(64)
fn unpack_targets(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    var masking = masking_of(slice.first + invocation.x);
    let receiver = receivers[masking.receiver];
    let view = frame_view(light_frame, receiver.position);
    let slope = horizon_slope(view, receiver);
    let crosses_horizon = !is_above_horizon(light_frame, receiver, slope);
    let width = textureDimensions(targets).x;
    let pixel = vec2<u32>(masking.receiver % width, masking.receiver / width);
    for (var target_layer = 0u; target_layer < select(0u, packing.words / 4u, masking.exists); target_layer++) {
        let texel = textureLoad(targets, pixel, target_layer, 0);
        for (var k = 0u; k < 4u; k++) {
            masking = masked(masking, view, slope, crosses_horizon, 4u * target_layer + k, u32(i32(texel[k])));
        }
    }
}
