// The occlusion camera: its image plane, the light's outline as half planes cut it, and what a distortion map holds.
//
// An image point is (x, y) at distance 1 from a light's centre, or for a sun (x, y) across its rays. A plane through a receiver and a
// silhouette cuts the light: what lies beyond is visible. Points of the light are offsets from its centre, x * x_way + y * y_way.
//#import shared/shadow_view.wgsl

const OUTLINE_RECTANGLE: u32 = 0u;
const OUTLINE_DISC: u32 = 1u;
const OUTLINE_BALL: u32 = 2u;
const OUTLINE_POLYGON: u32 = 3u;

const RAMP_OUTLINE: u32 = 0u;

// Receivers beyond the surface that the light's centre sees past an edge by so much of its distance still belong to the edge's range:
// surfaces lean away from the light.
const RANGE: f32 = 1.5;

// Texels of the depth map across one of the distortion map: that knows where a silhouette lies exactly, and need not be fine.
const COARSER: f32 = 4.0;

// How far a texel of the distortion map can speak for, in halves of the depth map's texels: half its own diagonal, and some.
const MARGIN: f32 = 6.0;

struct CameraLight {
    x_way: vec3<f32>,
    outline: u32,
    y_way: vec3<f32>,
    corner_count: u32,
    low: vec3<f32>,        // of a box around all casters and receivers
    half_size: f32,        // no point of the light lies farther from its centre; the tangent of the angle for a sun
    high: vec3<f32>,
    ramp: u32,
    steps: u32,
    bias: f32,             // share of the distance from occluder to receiver
    twice_area: f32,       // of a polygon
    reserved: u32,
    corners: array<vec4<f32>, 32>,  // of a polygon, two each
}

struct ImageAxes {
    x: vec3<f32>,
    y: vec3<f32>,
    tangents: vec2<f32>,   // half the image
}

fn image_axes(view: ShadowView) -> ImageAxes {
    let tangents = 1.0 / vec2<f32>(length(view.clip_x), length(view.clip_y));
    return ImageAxes(view.clip_x * tangents.x, view.clip_y * tangents.y, tangents);
}

// Where a point appears, and its depth; `p` is relative to the eye.
fn image_of(view: ShadowView, axes: ImageAxes, p: vec3<f32>) -> vec3<f32> {
    let depth = dot(view.forward, p);
    let scale = select(1.0, max(depth, 1e-30), view.perspective > 0.0);
    return vec3<f32>(dot(axes.x, p) / scale, dot(axes.y, p) / scale, depth);
}

// The point that appears there, relative to the eye.
fn point_at(view: ShadowView, axes: ImageAxes, image: vec2<f32>, depth: f32) -> vec3<f32> {
    let across = axes.x * image.x + axes.y * image.y;
    return across * select(1.0, depth, view.perspective > 0.0) + view.forward * depth;
}

fn texel_of(view: ShadowView, axes: ImageAxes, image: vec2<f32>) -> vec2<f32> {
    return (image / axes.tangents * vec2<f32>(0.5, -0.5) + 0.5) * view.resolution;
}

fn image_of_texel(view: ShadowView, axes: ImageAxes, texel: vec2<f32>) -> vec2<f32> {
    return (texel / view.resolution - 0.5) * vec2<f32>(2.0, -2.0) * axes.tangents;
}

// By how much a point of the light, a unit away from its centre, moves the shadow of what lies at `near` on what lies at `far`.
fn separation(view: ShadowView, near: f32, far: f32) -> f32 {
    return select(far - near, 1.0 / max(near, 1e-30) - 1.0 / max(far, 1e-30), view.perspective > 0.0);
}

// Where the way through an image point leaves the box around casters and receivers.
fn exit_depth(view: ShadowView, axes: ImageAxes, light: CameraLight, image: vec2<f32>) -> f32 {
    let across = axes.x * image.x + axes.y * image.y;
    let is_face = view.perspective > 0.0;
    let start = view.eye + select(across, vec3<f32>(0.0), is_face);
    let way = view.forward + select(vec3<f32>(0.0), across, is_face);
    let guarded = select(way, select(vec3<f32>(1e-20), vec3<f32>(-1e-20), way < vec3<f32>(0.0)), abs(way) < vec3<f32>(1e-20));
    let exits = (select(light.low, light.high, guarded > vec3<f32>(0.0)) - start) / guarded;
    return min(exits.x, min(exits.y, exits.z));
}

// A half plane of the light: { o : height + dot(ways, o) > 0 }, as seen past an edge whose plane has this normal.
struct HalfPlane {
    height: f32,
    ways: vec2<f32>,
    size: f32,      // of a ball across the plane
}

fn half_plane(light: CameraLight, normal: vec3<f32>, height: f32) -> HalfPlane {
    return HalfPlane(height, vec2<f32>(dot(light.x_way, normal), dot(light.y_way, normal)), light.half_size * length(normal));
}

fn corner_of(light: CameraLight, index: u32) -> vec2<f32> {
    let pair = light.corners[index >> 1u];
    return select(pair.xy, pair.zw, (index & 1u) == 1u);
}

// The largest |dot(ways, o)| of the light.
fn reach_of(light: CameraLight, half: HalfPlane) -> f32 {
    let ways = abs(half.ways);
    var reach = select(half.size, length(half.ways), light.outline == OUTLINE_DISC);
    reach = select(reach, ways.x + ways.y, light.outline == OUTLINE_RECTANGLE);
    for (var i = 0u; i < light.corner_count; i++) {
        let far = abs(dot(half.ways, corner_of(light, i)));
        reach = max(select(reach, 0.0, i == 0u), far);
    }
    return reach;
}

// Where the plane lies between the far end of the light (-1: nothing is visible) and the near one.
fn place_of(half: HalfPlane, reach: f32) -> f32 {
    return clamp(half.height / max(reach, 1e-30), -1.0, 1.0);
}

fn rectangle_share(half: HalfPlane) -> f32 {
    let ways = abs(half.ways);
    let long = max(ways.x, ways.y);
    let short = min(ways.x, ways.y);
    let height = abs(half.height);
    let left = max(long + short - height, 0.0);
    let tail = left * left / max(8.0 * long * short, 1e-37);
    let beyond = select(tail, 0.5 - 0.5 * height / max(long, 1e-30), height <= long - short);
    return select(clamp(beyond, 0.0, 0.5), 1.0 - clamp(beyond, 0.0, 0.5), half.height > 0.0);
}

// Twice the area of the part beyond the line is a sum over the parts of the border beyond it, about a point on the line.
fn polygon_share(light: CameraLight, half: HalfPlane) -> f32 {
    let middle = -half.ways * (half.height / max(dot(half.ways, half.ways), 1e-30));
    var sum = 0.0;
    var from_corner = corner_of(light, light.corner_count - 1u);
    for (var i = 0u; i < light.corner_count; i++) {
        let to = corner_of(light, i);
        let heights = vec2<f32>(half.height + dot(half.ways, from_corner), half.height + dot(half.ways, to));
        let step = to - from_corner;
        let change = heights.y - heights.x;
        let meets = clamp(-heights.x / select(change, 1e-30, abs(change) < 1e-30), 0.0, 1.0);
        let crosses = (heights.x > 0.0) != (heights.y > 0.0);
        let a = from_corner + step * select(0.0, meets, crosses && heights.x <= 0.0);
        let b = from_corner + step * select(1.0, meets, crosses && heights.x > 0.0);
        let area = (a.x - middle.x) * (b.y - middle.y) - (a.y - middle.y) * (b.x - middle.x);
        sum += select(0.0, area, max(heights.x, heights.y) > 0.0);
        from_corner = to;
    }
    return clamp(sum / max(light.twice_area, 1e-30), 0.0, 1.0);
}

// The share of the light in a half plane.
fn visible_share(light: CameraLight, half: HalfPlane) -> f32 {
    let reach = reach_of(light, half);
    let t = place_of(half, reach);
    if (light.ramp != RAMP_OUTLINE || abs(t) >= 1.0) {
        let x = 0.5 + 0.5 * t;
        return x * x * (3.0 - 2.0 * x);
    }
    if (light.outline == OUTLINE_RECTANGLE) {
        return rectangle_share(half);
    }
    if (light.outline == OUTLINE_POLYGON) {
        return polygon_share(light, half);
    }
    return clamp(0.5 + (t * sqrt(1.0 - t * t) + asin(t)) * 0.31830989, 0.0, 1.0);
}

// What a texel of the distortion map holds of the nearest silhouette: the six numbers of the paper, and which edge it is.
struct Distortion {
    point: vec2<f32>,
    normal: vec2<f32>,   // away from the occluder
    near: f32,           // depth of the silhouette
    far: f32,            // of what the light's centre sees past it
    edge: u32,           // index + 1; 0 where no silhouette is near
}
