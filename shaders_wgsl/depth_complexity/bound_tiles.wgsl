// Bounds the receivers of a tile, and the shaft between them and the light. A tile across an edge of the scene is cut in two along its
// longest axis: what lies between two far surfaces would count for both.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/frame.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/tiles.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(5) var<storage, read_write> parts: array<TilePart>;
@group(0) @binding(6) var<storage, read_write> areas: array<f32>;

// A part is split when its halves are smaller than this share of it; flat halves are 0.8 of the whole.
const SPLIT_BELOW: f32 = 0.6;

// Where a tile is cut: receivers beyond `middle` on `axis` are in the second part; on axis 3 none is.
struct Split {
    axis: u32,
    middle: f32,
}

fn part_of(split: Split, position: vec3<f32>) -> u32 {
    if (split.axis > 2u) {
        return 0u;
    }
    return select(0u, 1u, position[split.axis] > split.middle);
}

struct Box {
    low: vec3<f32>,
    high: vec3<f32>,
    count: u32,
}

fn around(first: u32, end: u32, split: Split, part: u32) -> Box {
    var box = Box(vec3<f32>(1e30), vec3<f32>(-1e30), 0u);
    for (var at = first; at < end; at++) {
        let position = receivers[slots[at].receiver].position;
        if (slots[at].depth != NO_VIEW && part_of(split, position) == part) {
            box.low = min(box.low, position);
            box.high = max(box.high, position);
            box.count++;
        }
    }
    return box;
}

// The four sides of the shaft and its back. A plane that would need more than this slope bounds nothing worth while.
const STEEPEST: f32 = 1e4;

struct Axes {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
    origin: vec3<f32>,
}

fn axes_of(center: vec3<f32>) -> Axes {
    if (light_frame.kind != FRAME_SPHERE) {
        return Axes(light_frame.x_row, light_frame.y_row, light_frame.z_row, light_frame.origin);
    }
    let way = center - light_frame.origin;
    let z = way / max(length(way), 1e-30);
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    let x = vec3<f32>(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
    let y = vec3<f32>(b, s + z.y * z.y * a, -z.y);
    return Axes(x, y, z, light_frame.origin);
}

// One side of the shaft: `across` grows outwards, the light reaches to `reach` on it, receivers lie at p with dot(z, p - origin) > 0.
struct Side {
    across: vec3<f32>,
    reach: f32,
    slope: f32,
}

fn slope_of(across: f32, depth: f32, reach: f32) -> f32 {
    return select(STEEPEST * 2.0, (across - reach) / depth, depth > 0.0);
}

fn widened(plane: vec3<f32>, bound: f32, size: f32) -> vec4<f32> {
    return vec4<f32>(plane, bound + 4e-6 * (abs(bound) + dot(abs(plane), vec3<f32>(1.0)) * size));
}

fn shaft(box: Box, first: u32, end: u32, split: Split, part: u32) -> array<vec4<f32>, 5> {
    let axes = axes_of((box.low + box.high) * 0.5);
    let low = light_frame.low + light_frame.reference;
    let high = light_frame.high + light_frame.reference;
    let largest = max(abs(box.low), abs(box.high));
    let size = 1.0 + max(largest.x, max(largest.y, largest.z)) + dot(abs(axes.origin), vec3<f32>(1.0));
    var planes: array<vec4<f32>, 5>;
    if (light_frame.kind == FRAME_SUN) {
        let t = light_frame.size;
        let right = axes.x - axes.z * (high.x * t);
        let left = axes.z * (low.x * t) - axes.x;
        let top = axes.y - axes.z * (high.y * t);
        let bottom = axes.z * (low.y * t) - axes.y;
        var reach = array<f32, 5>(-1e30, -1e30, -1e30, -1e30, -1e30);
        for (var at = first; at < end; at++) {
            let p = receivers[slots[at].receiver].position;
            if (slots[at].depth != NO_VIEW && part_of(split, p) == part) {
                reach[0] = max(reach[0], dot(right, p));
                reach[1] = max(reach[1], dot(left, p));
                reach[2] = max(reach[2], dot(top, p));
                reach[3] = max(reach[3], dot(bottom, p));
                reach[4] = max(reach[4], -dot(axes.z, p));
            }
        }
        planes[0] = widened(right, reach[0], size);
        planes[1] = widened(left, reach[1], size);
        planes[2] = widened(top, reach[2], size);
        planes[3] = widened(bottom, reach[3], size);
        planes[4] = widened(-axes.z, reach[4], size);
        return planes;
    }
    let is_sphere = light_frame.kind == FRAME_SPHERE;
    let r = light_frame.size;
    let reach = select(vec4<f32>(high.x, -low.x, high.y, -low.y), vec4<f32>(r), is_sphere);
    var slopes = vec4<f32>(-1e30);
    var back = -1e30;
    for (var at = first; at < end; at++) {
        let p = receivers[slots[at].receiver].position;
        if (slots[at].depth != NO_VIEW && part_of(split, p) == part) {
            let way = p - axes.origin;
            let x = dot(axes.x, way);
            let y = dot(axes.y, way);
            let z = dot(axes.z, way);
            slopes.x = max(slopes.x, slope_of(x, z, reach.x));
            slopes.y = max(slopes.y, slope_of(-x, z, reach.y));
            slopes.z = max(slopes.z, slope_of(y, z, reach.z));
            slopes.w = max(slopes.w, slope_of(-y, z, reach.w));
            back = max(back, z);
        }
    }
    // A ball reaches beyond its centre's plane: to r·sqrt(1 + slope²) across a sloping side.
    let bounds = select(reach, r * sqrt(1.0 + slopes * slopes), is_sphere);
    let across = array<vec3<f32>, 4>(axes.x, -axes.x, axes.y, -axes.y);
    for (var side = 0u; side < 4u; side++) {
        let plane = across[side] - axes.z * slopes[side];
        let usable = slopes[side] < STEEPEST;
        planes[side] = select(
            vec4<f32>(0.0, 0.0, 0.0, 1.0),
            widened(plane, bounds[side] + dot(plane, axes.origin), size),
            usable,
        );
    }
    // Receivers around a ball do not reach as far as the ball itself.
    let farthest = select(back, max(back, r), is_sphere);
    planes[4] = widened(axes.z, farthest + dot(axes.z, axes.origin), size);
    return planes;
}

@compute @workgroup_size(64)
fn bound_tiles(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let tile = slice.first + invocation.x;
    let first = tile * TILE;
    let end = min(first + TILE, cluster_range.receiver_count);
    var split = Split(3u, 0.0);
    let whole = around(first, end, split, 0u);
    let size = whole.high - whole.low;
    let axis = select(select(2u, 1u, size.y > size.z), 0u, size.x > max(size.y, size.z));
    split = Split(axis, (whole.low[axis] + whole.high[axis]) * 0.5);
    var halves = array<Box, 2>(around(first, end, split, 0u), around(first, end, split, 1u));
    let larger = max(length(halves[0].high - halves[0].low), length(halves[1].high - halves[1].low));
    if (whole.count == 0u || halves[0].count == 0u || halves[1].count == 0u || larger > SPLIT_BELOW * length(size)) {
        split.axis = 3u;
        halves = array<Box, 2>(whole, Box(vec3<f32>(1e30), vec3<f32>(-1e30), 0u));
    }
    for (var at = first; at < end; at++) {
        slots[at].part = part_of(split, receivers[slots[at].receiver].position);
        // Samples answer, unless a fold finds an area.
        areas[slots[at].receiver] = -1.0;
    }
    for (var part = 0u; part < 2u; part++) {
        var bounded: TilePart;
        bounded.low = halves[part].low;
        bounded.high = halves[part].high;
        bounded.receiver_count = halves[part].count;
        bounded.has_faces = 0u;
        if (bounded.receiver_count > 0u) {
            bounded.planes = shaft(halves[part], first, end, split, part);
        }
        parts[2u * tile + part] = bounded;
    }
}
