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

// Where a point lies in a view.
struct PlaceInView {
    offset: vec3<f32>,   // from the eye
    depth: f32,
    texel: vec2<f32>,    // in texels, from the map's corner
    scale: f32,          // world lengths a length at distance 1
}

fn place_in_view(view: ShadowView, position: vec3<f32>) -> PlaceInView {
    let p = position - view.eye;
    let depth = dot(view.forward, p);
    let scale = select(1.0, depth, view.perspective > 0.0);
    let ndc = vec2<f32>(dot(view.clip_x, p), dot(view.clip_y, p)) / scale;
    return PlaceInView(p, depth, (ndc * vec2<f32>(0.5, -0.5) + 0.5) * view.resolution, scale);
}

fn texel_in_view(view: ShadowView, at: vec2<f32>) -> vec2<f32> {
    return clamp(floor(at), vec2<f32>(0.0), vec2<f32>(view.resolution - 1.0));
}

// Half a texel at the receiver and the slope of its plane within it.
fn depth_slack(view: ShadowView, receiver: Receiver, place: PlaceInView) -> f32 {
    let toward = select(view.forward, place.offset / place.depth, view.perspective > 0.0);
    let cosine = dot(receiver.normal, toward);
    let steep = min(sqrt(max(1.0 - cosine * cosine, 0.0)) / max(abs(cosine), 1e-6), LARGEST_SLOPE);
    let slope = select(1.0, steep, receiver.kind == RECEIVER_SURFACE);
    let rounding = 32.0 * 5.9604645e-8 * (abs(place.depth) + largest_component(view.eye));
    return view.texel * place.scale * (1.0 + 0.5 * slope) + rounding;
}

// How far what a texel shows lies before a receiver's plane, and what of that is the texel's own width.
struct TexelGap {
    gap: f32,
    slack: f32,
    exists: bool,   // false where the texel shows nothing
}

fn texel_gap(depth_map: texture_2d_array<f32>, view: ShadowView, layer: u32, receiver: Receiver, texel: vec2<f32>) -> TexelGap {
    let place = place_in_view(view, receiver.position);
    let is_face = view.perspective > 0.0;
    let stored = textureLoad(depth_map, vec2<u32>(texel), layer, 0).x;
    if (stored <= 0.0) {
        return TexelGap(0.0, 0.0, false);
    }
    let occluder = occluder_depth(view, stored);
    let step = (texel + 0.5 - place.texel) / view.resolution * vec2<f32>(2.0, -2.0);
    // World offset of a step in clip space, at distance 1 for a face.
    let x_axis = view.clip_x / dot(view.clip_x, view.clip_x);
    let y_axis = view.clip_y / dot(view.clip_y, view.clip_y);
    let half_texel = view.texel * place.scale;
    var at_center = place.depth;
    if (receiver.kind == RECEIVER_SURFACE) {
        let offset = (x_axis * step.x + y_axis * step.y) * place.scale;
        let toward = select(view.forward, place.offset / place.depth, is_face);
        let cosine = dot(receiver.normal, toward);
        // Moving sideways by `offset`, the plane's depth changes by this much.
        let change = -dot(receiver.normal, offset) / select(cosine, select(1e-6, -1e-6, cosine < 0.0), abs(cosine) < 1e-6);
        let limit = LARGEST_SLOPE * half_texel;
        at_center = place.depth + clamp(change, -limit, limit);
    }
    return TexelGap(at_center - occluder, depth_slack(view, receiver, place), true);
}

fn lit_in_view(depth_map: texture_2d_array<f32>, view: ShadowView, layer: u32, receiver: Receiver) -> f32 {
    return lit_in_texel(depth_map, view, layer, receiver, place_in_view(view, receiver.position).texel);
}

// The same by the texel at a place next to the receiver.
fn lit_in_texel(depth_map: texture_2d_array<f32>, view: ShadowView, layer: u32, receiver: Receiver, at: vec2<f32>) -> f32 {
    let gap = texel_gap(depth_map, view, layer, receiver, texel_in_view(view, at));
    return select(1.0, 0.0, gap.exists && gap.gap > gap.slack);
}

// Whether a view shows a point. Faces of a cube cover the directions without overlap but for their borders: the first that holds the
// receiver answers.
fn is_in_view(view: ShadowView, position: vec3<f32>) -> bool {
    let p = position - view.eye;
    let scale = select(1.0, dot(view.forward, p), view.perspective > 0.0);
    return scale > 0.0 && abs(dot(view.clip_x, p)) <= scale * 1.000001 && abs(dot(view.clip_y, p)) <= scale * 1.000001;
}
