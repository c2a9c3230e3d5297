// What each receiver sees of the light, by the occlusion camera.
//
// The receiver is moved across the image, away from the nearest silhouette: not at all at the outer border of the penumbra, by all of its
// half width at the inner one. How far says how much of the light is visible. Where it arrives, another silhouette may lie: then the
// receiver itself is distorted anew, by that one, a few times at most. What is hidden wherever it is moved to lies in the umbra.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/shadow_test.wgsl
//#import occlusion_camera/camera.wgsl

// What a call reports.
struct CameraCounts {
    receivers: atomic<u32>,   // near a silhouette
    colliding: atomic<u32>,   // with more silhouettes before them than were found
    steps: atomic<u32>,       // most steps of any receiver
    bias: atomic<u32>,        // the largest, as bits of a float
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> shadow_views: ShadowViews;
@group(0) @binding(3) var<uniform> camera_light: CameraLight;
@group(0) @binding(4) var depth_map: texture_2d_array<f32>;
@group(0) @binding(5) var distortion_map: texture_2d_array<f32>;
@group(0) @binding(6) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(8) var<storage, read_write> counts: CameraCounts;

const MOST_STEPS: u32 = 3u;

// Silhouettes whose normals differ by less than this angle (45 degrees) can belong to one penumbra.
const AGREEING: f32 = 0.70710678;

// And their lines lie no farther apart than this share of the penumbra's half width.
const ONE_LINE: f32 = 0.25;

// A receiver in one view.
struct Seen {
    view: ShadowView,
    layer: u32,
    axes: ImageAxes,
    position: vec3<f32>,   // relative to the eye
    image: vec2<f32>,
    depth: f32,
    slack: f32,
}

fn distortion_at(seen: Seen, is_inside: bool, at: vec2<f32>) -> Distortion {
    let texel = floor(at);
    let last = seen.view.resolution - 1.0;
    let layer = 4u * seen.layer + select(0u, 2u, is_inside);
    let place = vec2<u32>(clamp(texel, vec2<f32>(0.0), vec2<f32>(last)) / COARSER);
    let first = textureLoad(distortion_map, place, layer, 0);
    let second = textureLoad(distortion_map, place, layer + 1u, 0);
    let is_within = all(texel >= vec2<f32>(0.0)) && all(texel <= vec2<f32>(last));
    return Distortion(first.xy, first.zw, second.x, second.y, select(0u, u32(second.z), is_within));
}

// What one silhouette does to a receiver.
struct Distorted {
    share: f32,        // of the light that lies beyond it
    place: vec2<f32>,  // the image to which the receiver is moved
    width: f32,        // half of the penumbra's, in the image
    is_in_range: bool, // the receiver can lie in its shadow
}

fn distort(seen: Seen, silhouette: Distortion) -> Distorted {
    let view = seen.view;
    let is_face = view.perspective > 0.0;
    let normal = seen.axes.x * silhouette.normal.x + seen.axes.y * silhouette.normal.y;
    let gap = seen.depth - silhouette.near;
    let rounding = 32.0 * 5.9604645e-8 * (abs(seen.depth) + largest_component(view.eye));
    // The plane through the receiver and the silhouette, which runs across the view there.
    let offset = seen.position - point_at(view, seen.axes, silhouette.point, silhouette.near);
    let lean = dot(offset, normal) / max(gap, rounding);
    let plane = normal - view.forward * lean;
    let height = select(lean, -dot(plane, seen.position), is_face);
    let half = half_plane(camera_light, plane, height);
    let reach = reach_of(camera_light, half);
    let width = reach * max(separation(view, silhouette.near, seen.depth), 0.0);
    let outward = dot(silhouette.normal, seen.image - silhouette.point);
    // A texel past the silhouette at least: what is stored next to it is either side's.
    let move_by = max(0.5 * width * (1.0 - place_of(half, reach)), 3.0 * view.texel - outward);
    let range = RANGE * reach * max(separation(view, silhouette.near, silhouette.far), 0.0) + 2.0 * view.texel;
    var result: Distorted;
    result.share = visible_share(camera_light, half);
    result.place = seen.image + silhouette.normal * move_by;
    result.width = width;
    result.is_in_range = gap > rounding && width <= range;
    return result;
}

// Depth of the receiver's plane at another image point, as far as it can be trusted.
fn plane_depth(seen: Seen, receiver: Receiver, image: vec2<f32>, near: f32) -> f32 {
    let across = seen.axes.x * image.x + seen.axes.y * image.y;
    let is_face = seen.view.perspective > 0.0;
    let height = dot(receiver.normal, seen.position) - select(dot(receiver.normal, across), 0.0, is_face);
    let along = dot(receiver.normal, select(seen.view.forward, across + seen.view.forward, is_face));
    let depth = height / select(along, 1e-30, abs(along) < 1e-30);
    let gap = max(seen.depth - near, 0.0);
    let is_known = receiver.kind == RECEIVER_SURFACE && depth > 0.0;
    return select(seen.depth, clamp(depth, seen.depth - gap, seen.depth + gap), is_known);
}

// Whether the receiver would be in the hard shadow where it is moved to. Surfaces that change their depth on the way there look like
// occluders: what is no nearer to the light than by a share of the distance to the silhouette does not count.
fn hidden_at(seen: Seen, receiver: Receiver, image: vec2<f32>, near: f32, bias: f32) -> bool {
    let texel = floor(texel_of(seen.view, seen.axes, image));
    let last = seen.view.resolution - 1.0;
    let is_within = all(texel >= vec2<f32>(0.0)) && all(texel <= vec2<f32>(last));
    let place = vec2<u32>(clamp(texel, vec2<f32>(0.0), vec2<f32>(last)));
    let stored = textureLoad(depth_map, place, seen.layer, 0).x;
    let occluder = occluder_depth(seen.view, max(stored, 1e-30));
    let depth = plane_depth(seen, receiver, image, near);
    return is_within && stored > 0.0 && occluder < depth - 2.0 * seen.slack - bias;
}

fn is_one_penumbra(a: Distortion, b: Distortion, width: f32, texel: f32) -> bool {
    let apart = min(abs(dot(a.normal, b.point - a.point)), abs(dot(b.normal, b.point - a.point)));
    return dot(a.normal, b.normal) >= AGREEING && apart <= max(ONE_LINE * width, 3.0 * texel);
}

struct Answer {
    share: f32,
    steps: u32,
    bias: f32,
    width: f32,          // of the penumbra past the first silhouette that counts; 0 without
    normal: vec2<f32>,   // of that silhouette
    visited: array<Distortion, MOST_STEPS>,
    counted: array<bool, MOST_STEPS>,
}

// Whether a silhouette belongs to a penumbra that counts already.
fn is_known(answer: Answer, steps: u32, found: Distortion, width: f32, texel: f32) -> bool {
    var known = false;
    for (var k = 0u; k < min(steps, MOST_STEPS); k++) {
        let visited = answer.visited[k];
        known = known || (answer.counted[k] && (visited.edge == found.edge || is_one_penumbra(visited, found, width, texel)));
    }
    return known;
}

// The decision tree for the receiver as one texel has it.
fn answer_in(seen: Seen, receiver: Receiver, texel: vec2<f32>) -> Answer {
    let is_hidden = lit_in_texel(depth_map, seen.view, seen.layer, receiver, texel) == 0.0;
    var answer: Answer;
    answer.share = 1.0;
    var place = texel;
    var in_shadow = is_hidden;
    var is_dark = is_hidden;
    for (var step = 0u; step < camera_light.steps; step++) {
        let found = distortion_at(seen, in_shadow, place);
        var is_new = found.edge != 0u && answer.share > 0.0;
        for (var k = 0u; k < min(step, MOST_STEPS); k++) {
            is_new = is_new && answer.visited[k].edge != found.edge;
        }
        if (!is_new) {
            break;
        }
        let distorted = distort(seen, found);
        let counts_too = distorted.is_in_range && !is_known(answer, step, found, distorted.width, seen.view.texel);
        answer.visited[step] = found;
        answer.counted[step] = counts_too;
        answer.steps = step + 1u;
        answer.share *= select(1.0, distorted.share, counts_too);
        let is_first = counts_too && answer.width == 0.0;
        answer.normal = select(answer.normal, found.normal, is_first);
        answer.width = select(answer.width, distorted.width, is_first);
        let bias = camera_light.bias * max(seen.depth - found.near, 0.0);
        answer.bias = max(answer.bias, bias);
        place = texel_of(seen.view, seen.axes, distorted.place);
        in_shadow = hidden_at(seen, receiver, distorted.place, found.near, bias);
        is_dark = is_dark && in_shadow;
    }
    // What the light's centre sees is in no umbra; what it does not see has to arrive in the light, past a silhouette that shades it.
    is_dark = is_dark || (is_hidden && answer.width == 0.0);
    answer.share = select(answer.share, 0.0, is_dark);
    return answer;
}

// Whether a silhouette shades the receiver that was not found, by a look at four places across the penumbra.
fn collides(seen: Seen, answer: Answer) -> bool {
    var is_missed = false;
    for (var i = 0u; i < 8u; i++) {
        let far = array<f32, 4>(-1.0, -0.5, 0.5, 1.0)[i >> 1u];
        let image = seen.image + answer.normal * (far * answer.width);
        let found = distortion_at(seen, (i & 1u) == 1u, texel_of(seen.view, seen.axes, image));
        if (found.edge != 0u) {
            let distorted = distort(seen, found);
            let shades = distorted.is_in_range && distorted.share > 0.0 && distorted.share < 1.0;
            is_missed = is_missed || (shades && !is_known(answer, answer.steps, found, distorted.width, seen.view.texel));
        }
    }
    return is_missed;
}

// The light above the receiver's own plane.
fn above_horizon(receiver: Receiver, to_center: vec3<f32>) -> f32 {
    if (receiver.kind != RECEIVER_SURFACE) {
        return 1.0;
    }
    return visible_share(camera_light, half_plane(camera_light, receiver.normal, dot(receiver.normal, to_center)));
}

fn way_to_center(receiver: Receiver) -> vec3<f32> {
    return select(light.center - receiver.position, -light.emission, light.kind == LIGHT_SUN);
}

fn write(index: u32, value: f32, channels: u32) {
    for (var channel = 0u; channel < channels; channel++) {
        visibility[index * channels + channel] = value;
    }
}

// Maps are not filtered: the light seen in four texels is.
fn shadowed(receiver: Receiver, horizon: f32) -> f32 {
    var seen: Seen;
    var found = false;
    for (var layer = 0u; layer < 6u; layer++) {
        let view = shadow_views.views[layer];
        if (layer < shadow_views.count && !found && is_in_view(view, receiver.position)) {
            seen.view = view;
            seen.layer = layer;
            found = true;
        }
    }
    if (!found) {
        return horizon;
    }
    seen.axes = image_axes(seen.view);
    seen.position = receiver.position - seen.view.eye;
    let image = image_of(seen.view, seen.axes, seen.position);
    seen.image = image.xy;
    seen.depth = image.z;
    seen.slack = depth_slack(seen.view, receiver, place_in_view(seen.view, receiver.position));
    let upward = vec2<f32>(dot(seen.axes.x, receiver.normal), dot(seen.axes.y, receiver.normal));
    let corner = texel_of(seen.view, seen.axes, seen.image) - 0.5;
    let part = fract(corner);
    var sum = 0.0;
    var steps = 0u;
    var is_colliding = false;
    var bias = 0.0;
    let nearest = select(0u, 1u, part.x >= 0.5) + select(0u, 2u, part.y >= 0.5);
    var answer: Answer;
    // The nearest texel comes last, and its answer stays.
    for (var turn = 0u; turn < 4u; turn++) {
        let i = (3u - turn) ^ nearest;
        let step = vec2<f32>(f32(i & 1u), f32(i >> 1u));
        let weight = mix(1.0 - part, part, step);
        answer = answer_in(seen, receiver, floor(corner) + step);
        // A silhouette that is turned as the horizon is hides what the horizon hides.
        let is_one = dot(upward, answer.normal) >= AGREEING * length(upward);
        sum += weight.x * weight.y * select(answer.share * horizon, min(answer.share, horizon), is_one);
        steps = max(steps, answer.steps);
        bias = max(bias, answer.bias);
    }
    // A loop of one step: software drivers run both sides of a branch, and skip a loop that no lane needs.
    for (var k = 0u; k < select(0u, 1u, answer.width > 0.0); k++) {
        is_colliding = collides(seen, answer);
    }
    if (steps > 0u) {
        atomicAdd(&counts.receivers, 1u);
        atomicAdd(&counts.colliding, select(0u, 1u, is_colliding));
        atomicMax(&counts.steps, steps);
        atomicMax(&counts.bias, bitcast<u32>(bias));
    }
    return clamp(sum, 0.0, 1.0);
}

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    var value = 0.0;
    if (receiver.kind != RECEIVER_NONE && view.exists) {
        let horizon = above_horizon(receiver, way_to_center(receiver));
        value = select(1.0, 0.0, horizon <= 0.0);
        if (horizon > 0.0 && !view.inside) {
            value = shadowed(receiver, horizon);
        }
    }
    write(index, value, shadow_views.channels);
}

// Where nothing hides the light.
@compute @workgroup_size(64)
fn look_up_open(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let horizon = select(above_horizon(receiver, way_to_center(receiver)), 1.0, view.inside);
    write(index, select(0.0, horizon, receiver.kind != RECEIVER_NONE && view.exists), shadow_views.channels);
}
