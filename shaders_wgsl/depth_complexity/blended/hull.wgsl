// A wedge: a convex, closed hull of every place from which an edge can be seen before some part of the light.
//
// It is [a, b] + R: the edge, and four ways R that hold every way from the light through the edge, extruded to infinity. Ten triangles
// close it, whichever way rounding turns a comparison: for each side of R one at the end that lies farther out, for each way of R one that joins
// the ends of its two sides (flat where they agree), and two at infinity. A hull that is too large costs fragments and changes no result.
//#import depth_complexity/frame.wgsl

struct WedgeView {
    eye: vec3<f32>,
    width: u32,              // pixels of a row
    clip_x: vec3<f32>,       // clip coordinates of p are dot(clip_x, p - eye) ...
    pixel: f32,              // size of a pixel at distance 1
    clip_y: vec3<f32>,
    receiver_count: u32,
    forward: vec3<f32>,
    reserved: u32,
}

struct Hull {
    bounded: bool,                // false where nothing smaller than the whole image is known to hold it
    ends: array<vec3<f32>, 2>,
    ways: array<vec3<f32>, 4>,    // clockwise, seen along them
    far: array<u32, 4>,           // the end that side `i`, between ways i and i + 1, stands at
}

const WEDGE_TRIANGLES: u32 = 10u;

// By so many pixels a hull is widened. A receiver may stand half as far from the middle of its pixel: on a thin triangle that corners
// rounded to a part of a pixel make cover it.
const PIXEL_MARGIN: f32 = 1.0;

// And by so much for rounding, in local units and in radians.
const ROUNDING_MARGIN: f32 = 2e-5;

// Ways steeper than this against the light's axis have no hull: the edge lies in the light's plane, or next to it.
const STEEPEST_WAY: f32 = 100.0;

// The ways from the light through a point: slopes along x and y over a unit of z.
struct Ways {
    low: vec2<f32>,
    high: vec2<f32>,
    bounded: bool,
}

struct WedgeAxes {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
}

fn hull_axes(frame: LightFrame, middle: vec3<f32>) -> WedgeAxes {
    if (frame.kind == FRAME_FLAT) {
        return WedgeAxes(normalize(frame.x_way), normalize(frame.y_way), frame.z_row);
    }
    if (frame.kind == FRAME_SUN) {
        return WedgeAxes(frame.x_row, frame.y_row, -frame.z_row);
    }
    let way = middle - frame.origin;
    let z = way / max(length(way), 1e-30);
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    return WedgeAxes(vec3<f32>(1.0 + s * z.x * z.x * a, s * b, -s * z.x), vec3<f32>(b, s + z.y * z.y * a, -z.y), z);
}

// Slopes of the two tangents from a point to a circle of radius `r` around the origin.
fn tangents(across: f32, along: f32, r: f32) -> vec3<f32> {
    let squared = across * across + along * along - r * r;
    let lean = r / sqrt(max(squared, 1e-30));
    let slope = across / max(along, 1e-30);
    let under = 1.0 - slope * lean;
    let over = 1.0 + slope * lean;
    let bounded = squared > 0.0 && along > 0.0 && min(under, over) > 0.0;
    let slopes = vec2<f32>((slope - lean) / max(over, 1e-30), (slope + lean) / max(under, 1e-30));
    return vec3<f32>(slopes, select(0.0, 1.0, bounded));
}

fn ways_through(frame: LightFrame, axes: WedgeAxes, p: vec3<f32>) -> Ways {
    let low = frame.low + frame.reference;
    let high = frame.high + frame.reference;
    if (frame.kind == FRAME_SUN) {
        let t = frame.size;
        return Ways(-high * t, -low * t, true);
    }
    let way = p - frame.origin;
    let at = vec3<f32>(dot(axes.x, way), dot(axes.y, way), dot(axes.z, way));
    if (frame.kind == FRAME_SPHERE) {
        let x = tangents(at.x, at.z, frame.size);
        let y = tangents(at.y, at.z, frame.size);
        return Ways(vec2<f32>(x.x, y.x), vec2<f32>(x.y, y.y), x.z * y.z > 0.0);
    }
    let size = vec2<f32>(length(frame.x_way), length(frame.y_way));
    let depth = max(at.z, 1e-30);
    return Ways((at.xy - high * size) / depth, (at.xy - low * size) / depth, at.z > 0.0);
}

// How far an end is drawn back against the middle way, so that a ball of the margin around the true end lies within.
fn drawn_back(view: WedgeView, p: vec3<f32>, reach: f32, narrowest: f32) -> f32 {
    let distance = max(dot(view.forward, p - view.eye), 0.0);
    let margin = PIXEL_MARGIN * view.pixel * distance + ROUNDING_MARGIN * (1.0 + dot(abs(p), vec3<f32>(1.0)));
    return margin * (1.0 + 2.0 * reach) / narrowest;
}

fn hull_of(frame: LightFrame, view: WedgeView, a: vec3<f32>, b: vec3<f32>) -> Hull {
    let axes = hull_axes(frame, (a + b) * 0.5);
    let from_a = ways_through(frame, axes, a);
    let from_b = ways_through(frame, axes, b);
    var low = min(from_a.low, from_b.low);
    var high = max(from_a.high, from_b.high);
    let angle = PIXEL_MARGIN * view.pixel + ROUNDING_MARGIN;
    low -= angle * (1.0 + low * low);
    high += angle * (1.0 + high * high);
    let steepest = max(abs(low), abs(high));
    let reach = max(steepest.x, steepest.y);
    let half = (high - low) * 0.5;
    let middle = (low + high) * 0.5;
    let narrowest = min(half.x, half.y);
    let way = axes.x * middle.x + axes.y * middle.y + axes.z;
    var hull: Hull;
    hull.bounded = from_a.bounded && from_b.bounded && reach < STEEPEST_WAY;
    hull.ends = array<vec3<f32>, 2>(
        a - way * drawn_back(view, a, reach, narrowest),
        b - way * drawn_back(view, b, reach, narrowest),
    );
    hull.ways = array<vec3<f32>, 4>(
        axes.x * low.x + axes.y * low.y + axes.z,
        axes.x * low.x + axes.y * high.y + axes.z,
        axes.x * high.x + axes.y * high.y + axes.z,
        axes.x * high.x + axes.y * low.y + axes.z,
    );
    let along = hull.ends[1] - hull.ends[0];
    for (var i = 0u; i < 4u; i++) {
        hull.far[i] = select(0u, 1u, dot(cross(hull.ways[i], hull.ways[(i + 1u) & 3u]), along) > 0.0);
    }
    return hull;
}

// A corner, or a way to infinity.
struct HullCorner {
    place: vec3<f32>,
    weight: f32,
}

fn hull_corner(hull: Hull, triangle: u32, corner: u32) -> HullCorner {
    let side = triangle & 3u;
    let before = (side + 3u) & 3u;
    if (triangle >= 8u) {
        return HullCorner(hull.ways[select(0u, 12u - triangle - corner, corner > 0u)], 0.0);
    }
    if (triangle >= 4u) {
        let end = hull.ends[select(hull.far[before], hull.far[side], corner == 2u)];
        return HullCorner(select(end, hull.ways[side], corner == 1u), select(1.0, 0.0, corner == 1u));
    }
    let way = hull.ways[(side + select(0u, 1u, corner == 2u)) & 3u];
    return HullCorner(select(way, hull.ends[hull.far[side]], corner == 0u), select(0.0, 1.0, corner == 0u));
}

// The plane of a triangle: dot(plane.xyz, p) < plane.w within the hull. At infinity everything is.
fn hull_plane(hull: Hull, triangle: u32) -> vec4<f32> {
    let side = triangle & 3u;
    if (triangle >= 8u) {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    let before = hull.ends[hull.far[(side + 3u) & 3u]];
    let end = hull.ends[hull.far[side]];
    let normal = select(cross(hull.ways[side], hull.ways[(side + 1u) & 3u]), cross(hull.ways[side], end - before), triangle >= 4u);
    return vec4<f32>(normal, dot(normal, select(end, before, triangle >= 4u)));
}
