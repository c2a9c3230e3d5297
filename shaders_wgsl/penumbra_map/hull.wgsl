// Where a silhouette edge can have a penumbra in a map: a hexagon on the outer side of the edge, half of an octagon around the light's
// outline at either end.
//
// From the light's centre, a place x on the cone behind an end v has the image m(v) - s (1/z(v) - 1/z(x)), with s on the light: the cone's
// section is the light's outline, reflected in the end, and grows in 1/z. The sheet between two cones is the hull of both sections. So
// what can be in a penumbra before the farthest receiver lies within the support lines of the larger section, at either end.
//#import shared/shadow_view.wgsl
//#import penumbra_map/light.wgsl

const HULL_TRIANGLES: u32 = 4u;

// Slopes and sizes beyond this against the way of the light have no hull, and the whole map is drawn: the edge lies in the light's plane, or
// next to it.
const STEEPEST: f32 = 100.0;

// By so many texels the hull reaches over the edge: corners are drawn to a sixteenth of a texel, or finer. No farther, as the occluder itself
// is there, in one plane with its edge.
const TEXEL_MARGIN: f32 = 0.0625;

// One end of an edge in the image plane at distance 1 (of a sun: in any plane across its way).
struct EndImage {
    at: vec2<f32>,
    reach: f32,     // scale of the outline's section, before the farthest receiver
    bounded: bool,
}

fn flat_end(light: PenumbraLight, v: vec3<f32>) -> EndImage {
    let z = max(v.z, 1e-30);
    let bounded = v.z > 0.0 && max(abs(v.x), abs(v.y)) < STEEPEST * v.z;
    let reach = max(1.0 / z - 1.0 / light.far, 0.0);
    return EndImage(select(vec2<f32>(0.0), v.xy / z, bounded), select(0.0, reach, bounded), bounded);
}

fn sun_end(light: PenumbraLight, v: vec3<f32>) -> EndImage {
    return EndImage(v.xy, max(light.far - v.z, 0.0), true);
}

// A cone of directions: the angle of a cone around a ball ends, at the farthest receiver, by what the ball spans from there.
fn sphere_end(light: PenumbraLight, v: vec3<f32>) -> EndImage {
    let z = max(v.z, 1e-30);
    let near = min(light.radius / max(length(v), 1e-30), 0.999);
    let angle = asin(near) - asin(min(light.radius / max(light.far, 1e-30), near));
    // A fiftieth more than the angle: drivers' own arcs are not exact.
    let t = tan(min(angle * 1.02, 1.4));
    let slope = length(v.xy) / z;
    let under = 1.0 - slope * t;
    let bounded = v.z > 0.0 && slope < 8.0 && under > 0.1;
    // In units of the light's radius, like the others.
    let reach = t * (1.0 + slope * slope) / max(under, 0.1) / light.radius;
    return EndImage(select(vec2<f32>(0.0), v.xy / z, bounded), select(0.0, reach, bounded), bounded);
}

// How far the outline, reflected in its centre, reaches along a direction.
fn support_of_disc(light: PenumbraLight) -> f32 {
    return light.radius;
}

fn support_of_rectangle(light: PenumbraLight, way: vec2<f32>) -> f32 {
    return dot(abs(way), light.half_size);
}

// Reach along -d, halfway, n, halfway and d.
struct Support {
    back: f32,
    back_out: f32,
    out: f32,
    ahead_out: f32,
    ahead: f32,
}

const DIAGONAL: f32 = 0.70710677;

// A corner of the hexagon, along d and n, and the end that it belongs to.
fn hexagon_corner(index: u32, s: Support, margin: f32) -> vec3<f32> {
    let root = 2.0 * DIAGONAL;
    let corners = array<vec3<f32>, 6>(
        vec3<f32>(-max(s.back, margin), -margin, 0.0),
        vec3<f32>(-max(s.back, margin), root * s.back_out - s.back, 0.0),
        vec3<f32>(s.out - root * s.back_out, s.out, 0.0),
        vec3<f32>(root * s.ahead_out - s.out, s.out, 1.0),
        vec3<f32>(max(s.ahead, margin), root * s.ahead_out - s.ahead, 1.0),
        vec3<f32>(max(s.ahead, margin), -margin, 1.0),
    );
    return corners[index];
}

// A fan around the first corner.
fn hull_index(triangle: u32, corner: u32) -> u32 {
    return select(triangle + corner, 0u, corner == 0u);
}
