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
@group(0) @binding(8) var<storage, read> sample_transmittance: array<f32>;

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

// Mean and standard error of samples between 0 and 1, from their weighted moments about one of them: of samples that are 0 or 1 that is
// the binomial estimate.
struct Moments {
    whole: vec3<f32>,
    first: vec3<f32>,
    second: vec3<f32>,
}

fn moments_with(before: Moments, weight: vec3<f32>, difference: f32) -> Moments {
    let first = weight * difference;
    return Moments(before.whole + weight, before.first + first, before.second + first * difference);
}

fn mean_of(moments: Moments) -> vec3<f32> {
    return moments.first / max(moments.whole, vec3<f32>(1e-37));
}

fn error_of(moments: Moments, known: u32) -> vec3<f32> {
    let mean = mean_of(moments);
    let squares = max(moments.second / max(moments.whole, vec3<f32>(1e-37)) - mean * mean, vec3<f32>(0.0));
    return select(sqrt(squares / f32(max(known, 2u) - 1u)), vec3<f32>(0.5), known < 2u);
}

// The mean of what passes to the samples.
@compute @workgroup_size(64)
fn resolve_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let known = known_samples(index);
    let at = index * sampling.count;
    let about = sample_transmittance[at];
    var moments = Moments(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    for (var sample = 0u; sample < known; sample++) {
        moments = moments_with(moments, vec3<f32>(1.0), sample_transmittance[at + sample] - about);
    }
    accumulate_with_error(index, about + mean_of(moments).x, error_of(moments, known).x);
}

// Textured light: V = Σ L·passes / Σ L by channel; a channel without light returns the mean of what passes.
@compute @workgroup_size(64)
fn resolve_attenuated_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let known = known_samples(index);
    let at = index * sampling.count;
    let about = sample_transmittance[at];
    var plain = Moments(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    var weighted = plain;
    for (var sample = 0u; sample < known; sample++) {
        let difference = sample_transmittance[at + sample] - about;
        plain = moments_with(plain, vec3<f32>(1.0), difference);
        weighted = moments_with(weighted, sample_radiance[sample].xyz, difference);
    }
    let has_light = weighted.whole > vec3<f32>(0.0);
    let value = about + select(mean_of(plain), mean_of(weighted), has_light);
    let error = select(error_of(plain, known), error_of(weighted, known), has_light);
    accumulate_with_error(3u * index, value.x, error.x);
    accumulate_with_error(3u * index + 1u, value.y, error.y);
    accumulate_with_error(3u * index + 2u, value.z, error.z);
}
