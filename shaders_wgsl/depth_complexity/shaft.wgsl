// The shaft that holds every way from some receivers to the light, or to a part of it.
//#import depth_complexity/frame.wgsl

// A side that would need more than this slope bounds nothing worth while.
const STEEPEST: f32 = 1e4;

struct Axes {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
    origin: vec3<f32>,
}

// The axes along which the shaft's sides lie; those of a ball look at the receivers' centre.
fn axes_of(frame: LightFrame, center: vec3<f32>) -> Axes {
    if (frame.kind != FRAME_SPHERE) {
        return Axes(frame.x_row, frame.y_row, frame.z_row, frame.origin);
    }
    let way = center - frame.origin;
    let z = way / max(length(way), 1e-30);
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    let x = vec3<f32>(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
    let y = vec3<f32>(b, s + z.y * z.y * a, -z.y);
    return Axes(x, y, z, frame.origin);
}

// What the ways lead to: right, left, top and bottom of it, each outwards.
fn whole_light(frame: LightFrame) -> vec4<f32> {
    let low = frame.low + frame.reference;
    let high = frame.high + frame.reference;
    return select(vec4<f32>(high.x, -low.x, high.y, -low.y), vec4<f32>(frame.size), frame.kind == FRAME_SPHERE);
}

// A ball's reference point moves with the receiver; the ball holds it.
fn reference_point(frame: LightFrame) -> vec4<f32> {
    let c = frame.reference;
    return select(vec4<f32>(c.x, -c.x, c.y, -c.y), vec4<f32>(frame.size), frame.kind == FRAME_SPHERE);
}

// How far the receivers seen so far reach: slopes of the four sides, or on a sun their distances, and the back.
struct Reach {
    sides: vec4<f32>,
    back: f32,
}

fn no_reach() -> Reach {
    return Reach(vec4<f32>(-1e30), -1e30);
}

// Slope of the side through a point at `across` and `depth` and the light's border at `target_at`.
fn slope_of(across: f32, depth: f32, target_at: f32) -> f32 {
    return select(STEEPEST * 2.0, (across - target_at) / max(depth, 1e-37), depth > 0.0);
}

// Normals of a sun's sides.
fn sun_side(frame: LightFrame, axes: Axes, target_at: vec4<f32>, side: u32) -> vec3<f32> {
    let across = select(axes.x, axes.y, side > 1u);
    return select(across, -across, (side & 1u) != 0u) - axes.z * (target_at[side] * frame.size);
}

fn reach_with(frame: LightFrame, axes: Axes, target_at: vec4<f32>, before: Reach, p: vec3<f32>) -> Reach {
    if (frame.kind == FRAME_SUN) {
        let sides = vec4<f32>(
            dot(sun_side(frame, axes, target_at, 0u), p),
            dot(sun_side(frame, axes, target_at, 1u), p),
            dot(sun_side(frame, axes, target_at, 2u), p),
            dot(sun_side(frame, axes, target_at, 3u), p),
        );
        return Reach(max(before.sides, sides), max(before.back, -dot(axes.z, p)));
    }
    let way = p - axes.origin;
    let x = dot(axes.x, way);
    let y = dot(axes.y, way);
    let z = dot(axes.z, way);
    let slopes = vec4<f32>(
        slope_of(x, z, target_at.x), slope_of(-x, z, target_at.y), slope_of(y, z, target_at.z), slope_of(-y, z, target_at.w),
    );
    return Reach(max(before.sides, slopes), max(before.back, z));
}

fn widened(plane: vec3<f32>, bound: f32, size: f32) -> vec4<f32> {
    return vec4<f32>(plane, bound + 4e-6 * (abs(bound) + dot(abs(plane), vec3<f32>(1.0)) * size));
}

// The four sides and the back, outside of which dot(plane.xyz, v) > plane.w. `extent` is how far receivers lie from the origin.
fn shaft_planes(frame: LightFrame, axes: Axes, target_at: vec4<f32>, reach: Reach, extent: vec3<f32>) -> array<vec4<f32>, 5> {
    let size = 1.0 + max(extent.x, max(extent.y, extent.z)) + dot(abs(axes.origin), vec3<f32>(1.0));
    var planes: array<vec4<f32>, 5>;
    if (frame.kind == FRAME_SUN) {
        for (var side = 0u; side < 4u; side++) {
            planes[side] = widened(sun_side(frame, axes, target_at, side), reach.sides[side], size);
        }
        planes[4] = widened(-axes.z, reach.back, size);
        return planes;
    }
    let is_sphere = frame.kind == FRAME_SPHERE;
    let r = frame.size;
    // A ball reaches beyond its centre's plane: to r·sqrt(1 + slope²) across a sloping side.
    let bounds = select(target_at, r * sqrt(1.0 + reach.sides * reach.sides), is_sphere);
    let across = array<vec3<f32>, 4>(axes.x, -axes.x, axes.y, -axes.y);
    for (var side = 0u; side < 4u; side++) {
        let plane = across[side] - axes.z * reach.sides[side];
        let usable = reach.sides[side] < STEEPEST;
        planes[side] = select(
            vec4<f32>(0.0, 0.0, 0.0, 1.0),
            widened(plane, bounds[side] + dot(plane, axes.origin), size),
            usable,
        );
    }
    // Receivers around a ball do not reach as far as the ball itself.
    let farthest = select(reach.back, max(reach.back, r), is_sphere);
    planes[4] = widened(axes.z, farthest + dot(axes.z, axes.origin), size);
    return planes;
}
