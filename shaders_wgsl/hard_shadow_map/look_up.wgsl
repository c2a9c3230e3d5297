// Whether something lies between a receiver and the light's centre, by the depth map.
//
// The receiver's plane is evaluated at the texel's centre, where the map was sampled, so a flat receiver needs no bias at any
// slope; what remains is a slack of half a texel and the slope within it, for surfaces that are not flat.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import hard_shadow_map/view.wgsl

struct ShadowViews {
    views: array<ShadowView, 6>,
    count: u32,
    channels: u32,
    reserved0: u32,
    reserved1: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> shadow_views: ShadowViews;
@group(0) @binding(3) var depth_map: texture_2d_array<f32>;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read_write> visibility: array<f32>;

// At a steeper slope the plane says nothing about the surface a texel further on.
const LARGEST_SLOPE: f32 = 16.0;

fn lit_in_view(view: ShadowView, layer: u32, receiver: Receiver) -> f32 {
    let p = receiver.position - view.eye;
    let depth = dot(view.forward, p);
    let is_face = view.perspective > 0.0;
    let scale = select(1.0, depth, is_face);
    let ndc = vec2<f32>(dot(view.clip_x, p), dot(view.clip_y, p)) / scale;
    let texel_position = (ndc * vec2<f32>(0.5, -0.5) + 0.5) * view.resolution;
    let texel = clamp(floor(texel_position), vec2<f32>(0.0), vec2<f32>(view.resolution - 1.0));
    let stored = textureLoad(depth_map, vec2<u32>(texel), layer, 0).x;
    if (stored <= 0.0) {
        return 1.0;
    }
    let occluder = select((1.0 - stored) * view.near, view.near / stored, is_face);
    let center_ndc = ((texel + 0.5) / view.resolution - 0.5) * vec2<f32>(2.0, -2.0);
    // World offset of a step in clip space, at distance 1 for a face.
    let x_axis = view.clip_x / dot(view.clip_x, view.clip_x);
    let y_axis = view.clip_y / dot(view.clip_y, view.clip_y);
    let half_texel = view.texel * scale;
    var at_center = depth;
    var slope = 1.0;
    if (receiver.kind == RECEIVER_SURFACE) {
        let offset = (x_axis * (center_ndc.x - ndc.x) + y_axis * (center_ndc.y - ndc.y)) * scale;
        let toward = select(view.forward, p / depth, is_face);
        let cosine = dot(receiver.normal, toward);
        // Moving sideways by `offset`, the plane's depth changes by this much.
        let change = -dot(receiver.normal, offset) / select(cosine, select(1e-6, -1e-6, cosine < 0.0), abs(cosine) < 1e-6);
        let limit = LARGEST_SLOPE * half_texel;
        at_center = depth + clamp(change, -limit, limit);
        slope = min(sqrt(max(1.0 - cosine * cosine, 0.0)) / max(abs(cosine), 1e-6), LARGEST_SLOPE);
    }
    let rounding = 32.0 * 5.9604645e-8 * (abs(depth) + largest_component(view.eye));
    let slack = half_texel * (1.0 + 0.5 * slope) + rounding;
    return select(1.0, 0.0, occluder < at_center - slack);
}

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    var value = 0.0;
    let way = select(light.center - receiver.position, -light.emission, light.kind == LIGHT_SUN);
    let view = light_view(light, receiver.position);
    if (receiver.kind != RECEIVER_NONE && view.exists && !below_horizon(receiver, way)) {
        value = 1.0;
        // Faces cover the directions without overlap but for their borders: the first that holds the receiver answers.
        var found = false;
        for (var layer = 0u; layer < 6u; layer++) {
            let face = shadow_views.views[layer];
            let p = receiver.position - face.eye;
            let scale = select(1.0, dot(face.forward, p), face.perspective > 0.0);
            let inside = scale > 0.0 && abs(dot(face.clip_x, p)) <= scale * 1.000001 && abs(dot(face.clip_y, p)) <= scale * 1.000001;
            if (layer < shadow_views.count && inside && !found) {
                value = lit_in_view(face, layer, receiver);
                found = true;
            }
        }
    }
    value = select(value, 1.0, view.inside && receiver.kind != RECEIVER_NONE);
    for (var channel = 0u; channel < shadow_views.channels; channel++) {
        visibility[index * shadow_views.channels + channel] = value;
    }
}
