// From masks to visibility: the share of samples that are not blocked, averaged over progressive passes, and its standard
// error. One pass gives the binomial estimate, which overstates the error of stratified samples; several give the measured one.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import shared/samples.wgsl
//#import shared/continuity.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> sampling: Sampling;
@group(0) @binding(2) var<storage, read> decided: array<u32>;
@group(0) @binding(3) var<storage, read> blocked: array<u32>;
@group(0) @binding(4) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(5) var<storage, read_write> standard_error: array<f32>;
@group(0) @binding(6) var<storage, read> sample_radiance: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> areas: array<u32>;   // a float, with its sign set where it answers
@group(0) @binding(8) var<uniform> interleaving: Interleaving;
@group(0) @binding(9) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(10) var<storage, read_write> pass_values: array<vec4<f32>>;
@group(0) @binding(11) var<storage, read> sample_transmittance: array<f32>;

// What one pass says of one receiver.
struct Answer {
    value: vec3<f32>,    // by channel; the first one alone without textures
    known: f32,          // samples that are 0 or 1 and say as much; 0 where an area answered
    error: vec3<f32>,    // of this pass alone
}

fn binomial_error(value: vec3<f32>, known: f32) -> vec3<f32> {
    // One sample says nothing about its own error, which is at most a half.
    return select(sqrt(max(value * (1.0 - value), vec3<f32>(0.0)) / (max(known, 2.0) - 1.0)), vec3<f32>(0.5), known < 2.0);
}

// Of samples that are 0 or 1; an area has no error.
fn binomial_answer(value: vec3<f32>, known: f32) -> Answer {
    return Answer(value, known, select(binomial_error(value, known), vec3<f32>(0.0), known == 0.0));
}

// Welford's update of mean and standard error with the value of one more pass. The standard error's slot holds the sum of
// squared deviations until the last pass.
fn accumulate(slot: u32, value: f32, error: f32) {
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
        standard_error[slot] = error;
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

fn hidden_samples(index: u32, known: u32) -> u32 {
    var hidden = 0u;
    for (var word = 0u; 32u * word < known; word++) {
        hidden += countOneBits(mask_word(index, word, known));
    }
    return hidden;
}

fn answer_of_samples(index: u32) -> Answer {
    let known = known_samples(index);
    return binomial_answer(vec3<f32>(1.0 - f32(hidden_samples(index, known)) / f32(known)), f32(known));
}

// Where the visible area of the light is known it answers, without noise; elsewhere samples do.
fn answer_of_area(index: u32) -> Answer {
    let sampled = 1.0 - f32(hidden_samples(index, sampling.count)) / f32(sampling.count);
    // Twice the largest error seen for stratified samples of a half plane.
    let bound = 2.0 * pow(f32(sampling.count), -0.75);
    let area = bitcast<f32>(areas[index] & 0x7fffffffu);
    let by_area = (areas[index] >> 31u) != 0u && abs(area - sampled) <= bound;
    return binomial_answer(vec3<f32>(select(sampled, area, by_area)), select(f32(sampling.count), 0.0, by_area));
}

// Textured light: V = Σ L·visible / Σ L by channel; a channel without light returns the share of area.
fn answer_of_texture(index: u32) -> Answer {
    let known = known_samples(index);
    let first = first_sample(sampling, index);
    var seen = vec3<f32>(0.0);
    var whole = vec3<f32>(0.0);
    var hidden = 0u;
    for (var word = 0u; 32u * word < known; word++) {
        let mask = mask_word(index, word, known);
        hidden += countOneBits(mask);
        for (var bit = 0u; bit < min(32u, known - 32u * word); bit++) {
            let radiance = sample_radiance[first + 32u * word + bit].xyz;
            whole += radiance;
            seen += select(radiance, vec3<f32>(0.0), (mask & (1u << bit)) != 0u);
        }
    }
    let by_area = vec3<f32>(1.0 - f32(hidden) / f32(known));
    return binomial_answer(select(by_area, seen / max(whole, vec3<f32>(1e-37)), whole > vec3<f32>(0.0)), f32(known));
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

// As many samples of 0 and 1 as would have such an error of such a mean: by the channel that is known least.
fn equal_samples(value: vec3<f32>, error: vec3<f32>, known: u32) -> f32 {
    let spread = max(value * (1.0 - value), vec3<f32>(0.0)) / max(error * error, vec3<f32>(1e-12)) + 1.0;
    let least = max(min(min(spread.x, spread.y), spread.z), f32(known));
    return select(least, f32(known), known < 2u);
}

// The mean of what passes to the samples.
fn answer_of_transmittance(index: u32) -> Answer {
    let known = known_samples(index);
    let at = index * sampling.count;
    let about = sample_transmittance[at];
    var moments = Moments(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    for (var sample = 0u; sample < known; sample++) {
        moments = moments_with(moments, vec3<f32>(1.0), sample_transmittance[at + sample] - about);
    }
    let value = about + mean_of(moments);
    let error = error_of(moments, known);
    return Answer(value, equal_samples(value, error, known), error);
}

// Textured light: V = Σ L·passes / Σ L by channel; a channel without light returns the mean of what passes.
fn answer_of_textured_transmittance(index: u32) -> Answer {
    let known = known_samples(index);
    let first = first_sample(sampling, index);
    let at = index * sampling.count;
    let about = sample_transmittance[at];
    var plain = Moments(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    var weighted = plain;
    for (var sample = 0u; sample < known; sample++) {
        let difference = sample_transmittance[at + sample] - about;
        plain = moments_with(plain, vec3<f32>(1.0), difference);
        weighted = moments_with(weighted, sample_radiance[first + sample].xyz, difference);
    }
    let has_light = weighted.whole > vec3<f32>(0.0);
    let value = about + select(mean_of(plain), mean_of(weighted), has_light);
    let error = select(error_of(plain, known), error_of(weighted, known), has_light);
    return Answer(value, equal_samples(value, error, known), error);
}

fn accumulate_channels(index: u32, answer: Answer) {
    accumulate(3u * index, answer.value.x, answer.error.x);
    accumulate(3u * index + 1u, answer.value.y, answer.error.y);
    accumulate(3u * index + 2u, answer.value.z, answer.error.z);
}

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let answer = answer_of_samples(slice.first + invocation.x);
        accumulate(slice.first + invocation.x, answer.value.x, answer.error.x);
    }
}

@compute @workgroup_size(64)
fn resolve_areas(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let answer = answer_of_area(slice.first + invocation.x);
        accumulate(slice.first + invocation.x, answer.value.x, answer.error.x);
    }
}

@compute @workgroup_size(64)
fn resolve_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        accumulate_channels(slice.first + invocation.x, answer_of_texture(slice.first + invocation.x));
    }
}

@compute @workgroup_size(64)
fn resolve_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let answer = answer_of_transmittance(slice.first + invocation.x);
        accumulate(slice.first + invocation.x, answer.value.x, answer.error.x);
    }
}

@compute @workgroup_size(64)
fn resolve_attenuated_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        accumulate_channels(slice.first + invocation.x, answer_of_textured_transmittance(slice.first + invocation.x));
    }
}

// The same, kept for `interleave`.

fn keep(index: u32, answer: Answer) {
    pass_values[index] = vec4<f32>(answer.value, answer.known);
}

@compute @workgroup_size(64)
fn keep_samples(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        keep(slice.first + invocation.x, answer_of_samples(slice.first + invocation.x));
    }
}

@compute @workgroup_size(64)
fn keep_areas(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        keep(slice.first + invocation.x, answer_of_area(slice.first + invocation.x));
    }
}

@compute @workgroup_size(64)
fn keep_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        keep(slice.first + invocation.x, answer_of_texture(slice.first + invocation.x));
    }
}

@compute @workgroup_size(64)
fn keep_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        keep(slice.first + invocation.x, answer_of_transmittance(slice.first + invocation.x));
    }
}

@compute @workgroup_size(64)
fn keep_attenuated_textured(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        keep(slice.first + invocation.x, answer_of_textured_transmittance(slice.first + invocation.x));
    }
}

// Averages over the pixels side by side whose samples make up one set, where they see one surface. What an area answered stays.
@compute @workgroup_size(64)
fn interleave(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let own = pass_values[index];
    let size = vec2<i32>(vec2<u32>(interleaving.width, interleaving.height));
    let here = vec2<i32>(vec2<u32>(index % interleaving.width, index / interleaving.width));
    let reach = i32(interleaving.tile / 2u);
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    var squares = 0.0;
    for (var y = max(here.y - reach, 0); y <= min(here.y + reach, size.y - 1); y++) {
        for (var x = max(here.x - reach, 0); x <= min(here.x + reach, size.x - 1); x++) {
            let other = u32(y * size.x + x);
            let is_one = other == index || is_continuous(receiver, receivers[other], interleaving.eye);
            let box = share_of_box(x - here.x, interleaving.tile) * share_of_box(y - here.y, interleaving.tile);
            let weight = select(0.0, box, is_one);
            let answer = pass_values[other];
            sum += weight * answer.xyz;
            total += weight;
            squares += select(0.0, weight * weight / max(answer.w, 1.0), answer.w > 0.0);
        }
    }
    let by_area = own.w == 0.0;
    // As many independent samples as would vary as much as the average does.
    let known = select(total * total / max(squares, 1e-30), 0.0, by_area);
    let averaged = binomial_answer(select(sum / total, own.xyz, by_area), known);
    if (interleaving.channels == 3u) {
        accumulate_channels(index, averaged);
    } else {
        accumulate(index, averaged.value.x, averaged.error.x);
    }
}
