// Whether something lies between a receiver and the light's centre, by the depth map.
//
// The receiver's plane is evaluated at the texel's centre, where the map was sampled, so a flat receiver needs no bias at any
// slope; what remains is a slack of half a texel and the slope within it, for surfaces that are not flat.
//#import shared/receiver.wgsl
//#import shared/shadow_view.wgsl

// At a steeper slope the plane says nothing about the surface a texel further on.
const LARGEST_SLOPE: f32 = 16.0;

// Distance of the nearest occluder, along the view's axis, in a texel's stored depth; the texel is not empty (0).
fn occluder_depth(view: ShadowView, stored: f32) -> f32 {
    return select((1.0 - stored) * view.near, view.near / stored, view.perspective > 0.0);
}

fn lit_in_view(depth_map: texture_2d_array<f32>, view: ShadowView, layer: u32, receiver: Receiver) -> f32 {
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
    let occluder = occluder_depth(view, stored);
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

// Whether a view shows a point. Faces of a cube cover the directions without overlap but for their borders: the first that holds the
// receiver answers.
fn is_in_view(view: ShadowView, position: vec3<f32>) -> bool {
    let p = position - view.eye;
    let scale = select(1.0, dot(view.forward, p), view.perspective > 0.0);
    return scale > 0.0 && abs(dot(view.clip_x, p)) <= scale * 1.000001 && abs(dot(view.clip_y, p)) <= scale * 1.000001;
}
