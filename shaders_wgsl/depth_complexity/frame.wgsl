// A light's frame and one receiver's projection on to it. The twin of `light_frame.rs` and `depth_complexity/view.rs`.

const FRAME_FLAT: u32 = 0u;
const FRAME_SPHERE: u32 = 1u;
const FRAME_SUN: u32 = 2u;

struct LightFrame {
    origin: vec3<f32>,       // centre of a flat light's frame, or of a sphere
    kind: u32,
    x_row: vec3<f32>,        // frame coordinates of a way from the centre; unit axes on a sun
    size: f32,               // tangent of a sun's half angle; radius of a sphere
    y_row: vec3<f32>,
    area: f32,               // of the outline; 0 where area is no visibility
    z_row: vec3<f32>,        // direction of emission; on a sun, towards it
    outline_count: u32,      // corners of the outline; 0 for a disc
    x_way: vec3<f32>,        // from the centre of a flat light's frame to (1, 0) and (0, 1)
    sample_count: u32,
    y_way: vec3<f32>,
    weighs_from_light: u32,  // standard silhouettes: the reference point says on which side of a face an edge is
    reference: vec2<f32>,
    low: vec2<f32>,          // bounds of light and reference point, relative to the latter
    high: vec2<f32>,
    reserved1: vec2<f32>,
}

// Samples relative to the reference point; on a sphere, points of the unit disc.
struct FrameSamples {
    at: array<vec4<f32>, 256>,
}

// How one receiver sees the light: an image is `rows·(v - p)`, relative to the reference point, homogeneous.
struct FrameView {
    position: vec3<f32>,
    exists: bool,            // false behind a flat light, and inside a sphere
    x_row: vec3<f32>,
    limited: bool,           // a sphere: geometry counts where dot(towards, v - p) < limit
    y_row: vec3<f32>,
    limit: f32,
    z_row: vec3<f32>,
    cap: f32,                // a sphere: 1 - cosine and tangent of its half angle
    x_way: vec3<f32>,
    tangent: f32,
    y_way: vec3<f32>,
    inside: bool,
    way: vec3<f32>,          // to the reference point; on sun and sphere its direction
    towards: vec3<f32>,
}

// How far a point of the unit disc, at squared radius `share`, is moved off the axis at distance 1, so that equal areas become
// equal solid angles.
fn cap_reach(cap: f32, share: f32) -> f32 {
    return sqrt(cap * (2.0 - share * cap)) / (1.0 - share * cap);
}

fn angular_view(position: vec3<f32>, x: vec3<f32>, y: vec3<f32>, towards: vec3<f32>, tangent: f32, c: vec2<f32>) -> FrameView {
    var view: FrameView;
    let depth = towards * tangent;
    view.position = position;
    view.exists = true;
    view.inside = false;
    view.limited = false;
    view.x_row = x - depth * c.x;
    view.y_row = y - depth * c.y;
    view.z_row = depth;
    view.x_way = x * tangent;
    view.y_way = y * tangent;
    view.way = towards + (x * c.x + y * c.y) * tangent;
    view.towards = towards;
    return view;
}

fn frame_view(frame: LightFrame, position: vec3<f32>) -> FrameView {
    let c = frame.reference;
    var view: FrameView;
    if (frame.kind == FRAME_FLAT) {
        let from_light = position - frame.origin;
        let height = dot(frame.z_row, from_light);
        view.position = position;
        view.exists = height > 0.0;
        view.inside = false;
        view.limited = false;
        view.x_row = frame.x_row * height - frame.z_row * (dot(frame.x_row, from_light) - c.x);
        view.y_row = frame.y_row * height - frame.z_row * (dot(frame.y_row, from_light) - c.y);
        view.z_row = -frame.z_row;
        view.x_way = frame.x_way;
        view.y_way = frame.y_way;
        view.way = frame.x_way * c.x + frame.y_way * c.y - from_light;
        view.towards = -frame.z_row;
        return view;
    }
    if (frame.kind == FRAME_SUN) {
        return angular_view(position, frame.x_row, frame.y_row, frame.z_row, frame.size, c);
    }
    let way = frame.origin - position;
    let squared = max(dot(way, way), 1e-37);
    let sine_squared = frame.size * frame.size / squared;
    let distance = sqrt(squared);
    let towards = way / distance;
    let outside = max(1.0 - sine_squared, 0.0);
    let cap = min(sine_squared / (1.0 + sqrt(outside)), 0.999);
    let reach = cap_reach(cap, 1.0);
    let tangent = select(1.0, reach, reach > 0.0);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    let s = select(-1.0, 1.0, towards.z >= 0.0);
    let a = -1.0 / (s + towards.z);
    let b = towards.x * towards.y * a;
    let x = vec3<f32>(1.0 + s * towards.x * towards.x * a, s * b, -s * towards.x);
    let y = vec3<f32>(b, s + towards.y * towards.y * a, -towards.y);
    view = angular_view(position, x, -y, towards, tangent, c);
    view.inside = sine_squared >= 1.0;
    view.exists = !view.inside;
    view.limited = true;
    view.limit = distance * outside;
    view.cap = cap;
    view.tangent = reach;
    return view;
}

fn project(view: FrameView, way: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(view.x_row, way), dot(view.y_row, way), dot(view.z_row, way));
}

// Where a sample lies relative to the reference point. Those of a sphere are points of the unit disc that move with the receiver.
fn placed_sample(frame: LightFrame, view: FrameView, sample: vec2<f32>) -> vec2<f32> {
    if (frame.kind != FRAME_SPHERE) {
        return sample;
    }
    let stretch = select(0.0, cap_reach(view.cap, dot(sample, sample)) / view.tangent, view.tangent > 0.0);
    return sample * stretch - frame.reference;
}
