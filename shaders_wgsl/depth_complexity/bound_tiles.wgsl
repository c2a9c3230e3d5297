// Bounds the receivers of a tile, and the shaft between them and the light. A tile across an edge of the scene is cut in two along its
// longest axis: what lies between two far surfaces would count for both.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/shaft.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/tiles.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(5) var<storage, read_write> parts: array<TilePart>;

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

fn shaft(box: Box, first: u32, end: u32, split: Split, part: u32) -> array<vec4<f32>, 5> {
    let axes = axes_of(light_frame, (box.low + box.high) * 0.5);
    let target_at = whole_light(light_frame);
    var reach = no_reach();
    for (var at = first; at < end; at++) {
        let p = receivers[slots[at].receiver].position;
        if (slots[at].depth != NO_VIEW && part_of(split, p) == part) {
            reach = reach_with(light_frame, axes, target_at, reach, p);
        }
    }
    return shaft_planes(light_frame, axes, target_at, reach, max(abs(box.low), abs(box.high)));
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
