// Direct light on Lambert and Blinn surfaces: the sum over the light's samples, each with its own visibility (`integrated`),
// or without, times the visibility (`modulated`). Forest et al., equations 6 and 3, with the visibility's sign put right.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/samples.wgsl

struct Material {
    base_color: vec3<f32>,
    specular: f32,
    exponent: f32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

struct Shading {
    eye: vec3<f32>,
    adds: u32,          // 0 for the first light and pass: replaces what is there
    weight: f32,        // 1 / progressive passes
    channels: u32,      // of the visibility that modulates
    reserved0: u32,
    reserved1: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var<uniform> shading: Shading;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> light_samples: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> sample_radiance: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> triangle_materials: array<u32>;
@group(0) @binding(8) var<storage, read> materials: array<Material>;
@group(0) @binding(9) var<storage, read_write> color: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read> decided: array<u32>;
@group(0) @binding(11) var<storage, read> blocked: array<u32>;
@group(0) @binding(12) var<storage, read> visibility: array<f32>;
@group(0) @binding(13) var<storage, read> sample_transmittance: array<f32>;

const INVERSE_PI: f32 = 0.31830987;

// Radiance that one unblocked sample sends from the receiver to the eye.
fn sample_contribution(receiver: Receiver, view: LightView, sample: u32, material: Material) -> vec3<f32> {
    if (view.inside) {
        // Light from everywhere: a Lambert surface returns its share of it.
        return light.radiance * material.base_color / f32(sampling.count);
    }
    let s = light_sample(light, view, light_samples[sample], receiver.position);
    let way = light_way(s, receiver.position);
    let squared = max(dot(way, way), 1e-30);
    let direction = way * inverseSqrt(squared);
    let cosine = max(dot(receiver.normal, direction), 0.0);
    var solid_angle = light.measure;
    if (light.kind == LIGHT_FLAT) {
        solid_angle = light.measure * max(-dot(light.emission, direction), 0.0) / squared;
    } else if (light.kind == LIGHT_SPHERE) {
        solid_angle = 6.2831853 * view.cap;
    }
    let to_eye = shading.eye - receiver.position;
    let halfway = direction + to_eye * inverseSqrt(max(dot(to_eye, to_eye), 1e-30));
    let lobe = max(dot(receiver.normal, halfway) * inverseSqrt(max(dot(halfway, halfway), 1e-30)), 0.0);
    // Blinn's lobe scaled to reflect its share whatever the exponent.
    let specular = material.specular * (material.exponent + 8.0) * 0.125 * INVERSE_PI * pow(max(lobe, 1e-6), material.exponent);
    let reflected = material.base_color * INVERSE_PI + vec3<f32>(specular);
    return light.radiance * sample_radiance[sample].xyz * reflected * cosine * solid_angle / f32(sampling.count);
}

fn add_color(index: u32, value: vec3<f32>) {
    let before = select(vec3<f32>(0.0), color[index].xyz, shading.adds != 0u);
    color[index] = vec4<f32>(before + value * shading.weight, 1.0);
}

@compute @workgroup_size(64)
fn integrated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    if (receiver.kind == RECEIVER_NONE) {
        color[index] = vec4<f32>(0.0);
        return;
    }
    let material = materials[triangle_materials[receiver.triangle]];
    let view = light_view(light, receiver.position);
    let known = decided[index];
    // Where only probes were traced they agree, and speak for all samples.
    let all_dark = known < sampling.count && known > 0u && (blocked[index * sampling.words] & 1u) != 0u;
    let first = first_sample(sampling, index);
    var sum = vec3<f32>(0.0);
    for (var sample = 0u; sample < select(sampling.count, 0u, all_dark); sample++) {
        let mask = blocked[index * sampling.words + sample / 32u];
        let hidden = (mask & (1u << (sample % 32u))) != 0u;
        sum += select(sample_contribution(receiver, view, first + sample, material), vec3<f32>(0.0), hidden);
    }
    add_color(index, sum);
}

// As `integrated`, of samples to which a part of the light may pass.
@compute @workgroup_size(64)
fn integrated_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    if (receiver.kind == RECEIVER_NONE) {
        color[index] = vec4<f32>(0.0);
        return;
    }
    let material = materials[triangle_materials[receiver.triangle]];
    let view = light_view(light, receiver.position);
    let known = decided[index];
    // Where only probes were traced they agree, and speak for all samples.
    let only_probes = known < sampling.count && known > 0u;
    let at = index * sampling.count;
    let first = first_sample(sampling, index);
    var sum = vec3<f32>(0.0);
    for (var sample = 0u; sample < sampling.count; sample++) {
        let passes = sample_transmittance[at + select(sample, 0u, only_probes)];
        if (passes > 0.0) {
            sum += sample_contribution(receiver, view, first + sample, material) * passes;
        }
    }
    add_color(index, sum);
}

@compute @workgroup_size(64)
fn modulated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    if (receiver.kind == RECEIVER_NONE) {
        color[index] = vec4<f32>(0.0);
        return;
    }
    let material = materials[triangle_materials[receiver.triangle]];
    let view = light_view(light, receiver.position);
    // Without shadow there is nothing to decorrelate: the first set serves all.
    var sum = vec3<f32>(0.0);
    for (var sample = 0u; sample < select(0u, sampling.count, view.exists); sample++) {
        sum += sample_contribution(receiver, view, sample, material);
    }
    let last = shading.channels - 1u;
    let at = index * shading.channels;
    let seen = vec3<f32>(visibility[at], visibility[at + min(1u, last)], visibility[at + min(2u, last)]);
    add_color(index, sum * seen);
}
