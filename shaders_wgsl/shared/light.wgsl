// An area light and its samples. Samples of flat lights and of the sun are made on the CPU; those of a sphere turn with the
// receiver and are completed here, the same way as in `light_samples.rs`.
//#import shared/receiver.wgsl

const LIGHT_FLAT: u32 = 0u;
const LIGHT_SPHERE: u32 = 1u;
const LIGHT_SUN: u32 = 2u;

struct Light {
    center: vec3<f32>,
    kind: u32,
    emission: vec3<f32>,
    radius: f32,         // of a sphere
    radiance: vec3<f32>,
    measure: f32,        // area of a flat light, solid angle of the sun
    low: vec3<f32>,      // box around all samples of a flat light, or around the directions towards the sun
    reserved0: u32,
    high: vec3<f32>,
    reserved1: u32,
}

// What a receiver sees of the light: where its samples lie.
struct LightView {
    x_axis: vec3<f32>,
    y_axis: vec3<f32>,
    cap: f32,            // 1 - cosine of the half angle of a sphere
    sine_squared: f32,   // of that half angle
    distance: f32,
    exists: bool,        // false behind a flat light, where nothing is visible
    inside: bool,        // the receiver lies inside a sphere light: everything is visible
}

fn light_view(light: Light, receiver: vec3<f32>) -> LightView {
    var view: LightView;
    view.exists = light.kind != LIGHT_FLAT || dot(receiver - light.center, light.emission) > 0.0;
    view.inside = false;
    if (light.kind == LIGHT_SPHERE) {
        let axis = light.center - receiver;
        let squared = dot(axis, axis);
        view.distance = sqrt(squared);
        let sine_squared = light.radius * light.radius / max(squared, 1e-37);
        view.inside = sine_squared >= 1.0;
        view.sine_squared = min(sine_squared, 1.0);
        // On the surface and inside the light is everywhere; a cap just below a hemisphere keeps every number finite.
        view.cap = min(sine_squared / (1.0 + sqrt(max(1.0 - sine_squared, 0.0))), 0.999);
        // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
        let n = axis / max(view.distance, 1e-37);
        let s = select(-1.0, 1.0, n.z >= 0.0);
        let a = -1.0 / (s + n.z);
        let b = n.x * n.y * a;
        view.x_axis = vec3<f32>(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
        view.y_axis = vec3<f32>(b, s + n.y * n.y * a, -n.y);
    }
    return view;
}

// A point on the light and 1, or a direction towards the sun and 0.
fn light_sample(light: Light, view: LightView, record: vec4<f32>, receiver: vec3<f32>) -> vec4<f32> {
    if (light.kind != LIGHT_SPHERE) {
        return record;
    }
    // Uniform in solid angle: `share` of the cap lies inside this sample's cone.
    let share = record.x * record.x + record.y * record.y;
    let reach = sqrt(view.cap * (2.0 - share * view.cap)) / (1.0 - share * view.cap);
    let offset = (view.x_axis * record.x + view.y_axis * record.y) * (reach * view.distance);
    // From the disc through the centre back to the surface: what lies behind the front of the light hides nothing.
    let outside = 1.0 - view.sine_squared;
    let to_surface = outside / (1.0 + sqrt(max(1.0 - (1.0 + reach * reach * share) * outside, 0.0)));
    return vec4<f32>(receiver + (light.center - receiver + offset) * to_surface, 1.0);
}

// The way from a receiver to a sample: the whole segment, or a direction towards the sun.
fn light_way(target_and_kind: vec4<f32>, receiver: vec3<f32>) -> vec3<f32> {
    return target_and_kind.xyz - target_and_kind.w * receiver;
}

// Lowest and highest corner of a box around all ways to the light.
struct WayBounds {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn light_way_bounds(light: Light, view: LightView, receiver: vec3<f32>) -> WayBounds {
    if (light.kind == LIGHT_SUN) {
        return WayBounds(light.low, light.high);
    }
    if (light.kind == LIGHT_FLAT) {
        return WayBounds(light.low - receiver, light.high - receiver);
    }
    let reach = view.distance * sqrt(view.cap * (2.0 - view.cap)) / (1.0 - view.cap) * 1.00001;
    let axis = light.center - receiver;
    return WayBounds(axis - reach, axis + reach);
}

fn below_horizon(receiver: Receiver, way: vec3<f32>) -> bool {
    return receiver.kind == RECEIVER_SURFACE && dot(receiver.normal, way) <= 0.0;
}
