// From masks to visibility: the share of samples that are not blocked, averaged over progressive passes, and its standard
// error. One pass gives the binomial estimate, which overstates the error of stratified samples; several give the measured one.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import shared/samples.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> sampling: Sampling;
@group(0) @binding(2) var<storage, read> decided: array<u32>;
@group(0) @binding(3) var<storage, read> blocked: array<u32>;
@group(0) @binding(4) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(5) var<storage, read_write> standard_error: array<f32>;
@group(0) @binding(6) var<storage, read> sample_radiance: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> areas: array<u32>;   // a float, with its sign set where it answers

// Welford's update of mean and standard error with the value of one more pass. The standard error's slot holds the sum of
// squared deviations until the last pass.
fn accumulate(slot: u32, value: f32, known: u32) {
    accumulate_with_error(slot, value, binomial_error(value, known));
}

fn binomial_error(value: f32, known: u32) -> f32 {
    // One sample says nothing about its own error, which is at most a half.
    return select(sqrt(max(value * (1.0 - value), 0.0) / f32(max(known, 2u) - 1u)), 0.5, known < 2u);
}

// `single` is the error of one pass alone.
fn accumulate_with_error(slot: u32, value: f32, single: f32) {
    var mean = value;
    var deviations = 0.0;
    if (sampling.pass_index > 0u) {
        let step = value - visibility[slot];
        mean = visibility[slot] + step / f32(sampling.pass_index + 1u);
        deviations = standard_error[slot] + step * (value - mean);
    }
    visibility[slot] = mean;
    if (sampling.pass_index + 1u < sampling.passes) {
        standard_error[slot] = deviations;
    } else if (sampling.passes > 1u) {
        standard_error[slot] = sqrt(max(deviations, 0.0) / f32(sampling.passes - 1u) / f32(sampling.passes));
    } else {
        standard_error[slot] = single;
    }
}

// How many samples the receiver's mask speaks for.
fn known_samples(index: u32) -> u32 {
    return select(decided[index], sampling.count, decided[index] == 0u);
}

fn mask_word(index: u32, word: u32, known: u32) -> u32 {
    let bits = min(32u, known - 32u * word);
    return blocked[index * sampling.words + word] & (0xffffffffu >> (32u - bits));
}

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let known = known_samples(index);
    var hidden = 0u;
    for (var word = 0u; 32u * word < known; word++) {
        hidden += countOneBits(mask_word(index, word, known));
    }
    accumulate(index, 1.0 - f32(hidden) / f32(known), known);
}

// Where the visible area of the light is known it answers, without noise; elsewhere samples do.
@compute @workgroup_size(64)
fn resolve_areas(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    var hidden = 0u;
    for (var word = 0u; 32u * word < sampling.count; word++) {
        hidden += countOneBits(mask_word(index, word, sampling.count));
    }
    let sampled = 1.0 - f32(hidden) / f32(sampling.count);
    // Twice the largest error seen for stratified samples of a half plane.
    let bound = 2.0 * pow(f32(sampling.count), -0.75);
    let area = bitcast<f32>(areas[index] & 0x7fffffffu);
    let by_area = (areas[index] >> 31u) != 0u && abs(area - sampled) <= bound;
    accumulate_with_error(
        index,
        select(sampled, area, by_area),
        select(binomial_error(sampled, sampling.count), 0.0, by_area),
    );
}

// Textured light: V = Σ L·visible / Σ L by channel; a channel without light returns the share of area.
@compute @workgroup_size(64)
fn resolve_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let known = known_samples(index);
    var seen = vec3<f32>(0.0);
    var whole = vec3<f32>(0.0);
    var hidden = 0u;
    for (var word = 0u; 32u * word < known; word++) {
        let mask = mask_word(index, word, known);
        hidden += countOneBits(mask);
        for (var bit = 0u; bit < min(32u, known - 32u * word); bit++) {
            let radiance = sample_radiance[32u * word + bit].xyz;
            whole += radiance;
            seen += select(radiance, vec3<f32>(0.0), (mask & (1u << bit)) != 0u);
        }
    }
    let by_area = vec3<f32>(1.0 - f32(hidden) / f32(known));
    let value = select(by_area, seen / max(whole, vec3<f32>(1e-37)), whole > vec3<f32>(0.0));
    accumulate(3u * index, value.x, known);
    accumulate(3u * index + 1u, value.y, known);
    accumulate(3u * index + 2u, value.z, known);
}
