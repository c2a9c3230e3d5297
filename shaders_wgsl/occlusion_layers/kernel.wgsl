// Where a receiver's view of the light lies on a slice.
//#import shared/light.wgsl
//#import occlusion_layers/layers.wgsl

// The light as boxes of a rectangle's frame: centre and half sizes, and what share of the light each has in every channel.
struct LightParts {
    boxes: array<vec4<f32>, 64>,
    weights: array<vec4<f32>, 64>,
    whole: vec4<f32>,
    count: u32,
    channels: u32,
    combine: u32,
    reserved: u32,
}

const COMBINE_PRODUCT: u32 = 0u;
const COMBINE_MAXIMUM: u32 = 1u;
const COMBINE_SUM: u32 = 2u;

// A receiver in the projected frame, and what of the light's frame it sees.
struct LayerView {
    at: vec3<f32>,
    light_center: vec2<f32>,
    light_scale: vec2<f32>,
    is_sun: bool,
}

fn layer_view(frame: LayerFrame, inverse_distance: f32, receiver: vec3<f32>) -> LayerView {
    let q = in_light_frame(frame, receiver);
    var view: LayerView;
    view.at = projected(q, inverse_distance);
    view.is_sun = frame.kind == LAYERS_SUN;
    view.light_center = vec2<f32>(0.0);
    view.light_scale = vec2<f32>(select(1.0, frame.tangent, view.is_sun));
    if (frame.kind == LAYERS_SPHERE) {
        // A ball of radius 1 across, seen from here: its outline on the plane through its middle, axis by axis.
        let depth = q.z * frame.tangent;
        for (var axis = 0u; axis < 2u; axis++) {
            let squared = max(q[axis] * q[axis] + depth * depth, 1.0001);
            let sine = inverseSqrt(squared);
            let cosine = sqrt(max(1.0 - sine * sine, 0.0));
            // Tangents of the two angles, each to the depth: q - depth tan(a ± b), tan a = q / depth.
            let a = q[axis];
            let plus = (a * cosine + depth * sine) / max(depth * cosine - a * sine, 1e-6);
            let minus = (a * cosine - depth * sine) / max(depth * cosine + a * sine, 1e-6);
            view.light_center[axis] = a - depth * 0.5 * (plus + minus);
            view.light_scale[axis] = depth * 0.5 * (plus - minus);
        }
    }
    return view;
}

// Lowest and highest corner of the part's image on the plane at a depth before the receiver, in texels.
fn kernel_box(view: LayerView, window: LayerWindow, part: vec4<f32>, depth: f32) -> vec4<f32> {
    let reach = select(1.0 - depth / max(view.at.z, 1e-30), view.at.z - depth, view.is_sun);
    let base = select(view.at.xy * (depth / max(view.at.z, 1e-30)), view.at.xy, view.is_sun);
    let center = base + reach * (view.light_center + view.light_scale * part.xy);
    let half_size = reach * view.light_scale * part.zw;
    let middle = (center - window.low) * window.texels;
    // Less than a texel is not known: the share is that of a texel in the same place.
    let half_texels = max(half_size * window.texels, vec2<f32>(0.5));
    return vec4<f32>(middle - half_texels, middle + half_texels);
}

// The share of a box of the light that lies above a line: offset + slope·s >= 0 over [-half, half].
fn share_above(offset: f32, slope: vec2<f32>) -> f32 {
    let long = max(abs(slope.x), abs(slope.y));
    let short = min(abs(slope.x), abs(slope.y));
    if (offset >= long + short) {
        return 1.0;
    }
    if (offset <= -long - short) {
        return 0.0;
    }
    let to_corner = long + short - abs(offset);
    var smaller = 0.5 - abs(offset) / max(2.0 * long, 1e-30);
    if (to_corner < 2.0 * short) {
        smaller = to_corner * to_corner / max(8.0 * long * short, 1e-30);
    }
    return select(1.0 - smaller, smaller, offset < 0.0);
}

// The way from a receiver to a place on the light; towards a sun as long as it is for one unit of depth.
fn way_to(frame: LayerFrame, receiver: Receiver, view: LayerView, place: vec2<f32>) -> vec3<f32> {
    let begin = select(frame.origin - receiver.position, -frame.row_z, view.is_sun);
    let at = view.light_center + view.light_scale * place;
    return begin + frame.row_x * (at.x / dot(frame.row_x, frame.row_x)) + frame.row_y * (at.y / dot(frame.row_y, frame.row_y));
}

// The share of a part of the light that lies above the receiver's own plane.
fn horizon_share(frame: LayerFrame, receiver: Receiver, view: LayerView, part: vec4<f32>) -> f32 {
    if (receiver.kind != RECEIVER_SURFACE) {
        return 1.0;
    }
    let way = select(frame.origin - receiver.position, -frame.row_z, view.is_sun);
    let slope = vec2<f32>(
        dot(receiver.normal, frame.row_x) / dot(frame.row_x, frame.row_x),
        dot(receiver.normal, frame.row_y) / dot(frame.row_y, frame.row_y),
    );
    let middle = view.light_center + view.light_scale * part.xy;
    return share_above(dot(receiver.normal, way) + dot(slope, middle), slope * view.light_scale * part.zw);
}
