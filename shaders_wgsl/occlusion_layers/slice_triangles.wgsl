// Cuts triangles into slices: one bit a texel, set where something of the slice lies before the texel's centre. Rows of words, slice after slice.
//
// A triangle of few rows is filled by one invocation. The others are listed, and every row of theirs has an invocation of its own, so that
// none takes long: software drivers end loops.
//#import shared/slice.wgsl
//#import occlusion_layers/casters.wgsl

// Triangles of many rows, in any order: bits are OR-ed.
struct TallTriangles {
    count: atomic<u32>,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
    triangles: array<u32>,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(2) var<uniform> caster_range: CasterRange;
@group(0) @binding(3) var<storage, read> corners: array<Corner>;
@group(0) @binding(4) var<storage, read> layer_places: LayerPlaces;
@group(0) @binding(5) var<storage, read_write> slice_bits: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> tall: TallTriangles;
@group(0) @binding(7) var<storage, read_write> dispatch_size: array<u32, 3>;

const MOST_ROWS: u32 = 64u;
const GROUP: u32 = 64u;
const LARGEST_DISPATCH: u32 = 65535u;

// A triangle over texels: its outline, and its depth, which is linear over them.
struct Sliced {
    outline: Outline,
    depth: f32,        // at the origin of the texels
    slope: vec2<f32>,  // a texel further on
    first_row: u32,
    end_row: u32,
    first_slice: u32,
    last_slice: u32,
}

// The slice that holds a depth: the first whose far plane is not before it. All of them where it lies behind the last.
fn slice_of(depth: f32, slices: u32) -> u32 {
    var low = 0u;
    var high = slices;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (layer_places.planes[middle] < depth) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

fn sliced(frame: LayerFrame, range: CasterRange, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>) -> Sliced {
    var result: Sliced;
    let slices = layer_places.window.slices;
    var outline = outline_of(frame, range.inverse_distance, p0, p1, p2);
    let is_there = slices > 0u && outline.exists && outline.low.z < range.farthest;
    if (!is_there || !can_hide(range, p0, cross(p1 - p0, p2 - p0))) {
        return result;
    }
    let low = outline.low.z;
    let high = outline.high.z;
    let scale = vec3<f32>(layer_places.window.texels, 1.0);
    let begin = vec3<f32>(layer_places.window.low, 0.0);
    for (var k = 0u; k < 4u; k++) {
        outline.sides[k].a = (outline.sides[k].a - begin) * scale;
        outline.sides[k].b = (outline.sides[k].b - begin) * scale;
    }
    result.outline = outline;
    let resolution = f32(layer_places.window.resolution);
    let top = (outline.low.y - begin.y) * scale.y;
    let bottom = (outline.high.y - begin.y) * scale.y;
    result.first_row = u32(clamp(ceil(top - 0.5), 0.0, resolution));
    result.end_row = u32(clamp(ceil(bottom - 0.5), 0.0, resolution));
    result.first_slice = slice_of(low, slices);
    result.last_slice = slice_of(high, slices);
    // The plane n·q = c becomes n.x u + n.y v + (n.z + c / d) t = c.
    let q0 = in_light_frame(frame, p0);
    let edge1 = in_light_frame(frame, p1) - q0;
    let edge2 = in_light_frame(frame, p2) - q0;
    let n = cross(edge1, edge2);
    let steep = n.z + dot(n, q0) * range.inverse_distance;
    // A corner before the light: every side that exists begins at one.
    var corner = outline.sides[0].a;
    if (!outline.sides[0].exists) {
        corner = outline.sides[1].a;
    }
    let is_seen = abs(steep) > 1e-6 * length(n);
    result.slope = select(vec2<f32>(0.0), -n.xy / (select(1.0, steep, is_seen) * scale.xy), is_seen);
    result.depth = corner.z - dot(result.slope, corner.xy);
    return result;
}

// Where the row through the texels' centres at `y` enters and leaves. A side that ends there belongs to the row below.
fn span(triangle: Sliced, y: f32) -> vec2<f32> {
    var ends = vec2<f32>(1e30, -1e30);
    for (var k = 0u; k < 4u; k++) {
        let side = triangle.outline.sides[k];
        if (side.exists && (side.a.y <= y) != (side.b.y <= y)) {
            let x = side.a.x + (y - side.a.y) * ((side.b.x - side.a.x) / (side.b.y - side.a.y));
            ends = vec2<f32>(min(ends.x, x), max(ends.y, x));
        }
    }
    return ends;
}

fn fill(slice_index: u32, row: u32, first: u32, end: u32) {
    let words = layer_places.window.resolution / 32u;
    let base = (slice_index * layer_places.window.resolution + row) * words;
    if (first < end && slice_index < layer_places.window.slices) {
        for (var word = first / 32u; word <= (end - 1u) / 32u; word++) {
            let from_bit = max(first, word * 32u) - word * 32u;
            let bits = min(end, word * 32u + 32u) - word * 32u - from_bit;
            let mask = select((1u << bits) - 1u, 0xffffffffu, bits == 32u) << from_bit;
            atomicOr(&slice_bits[base + word], mask);
        }
    }
}

// Sets the bits of one row, in every slice that the triangle passes there.
fn fill_row(triangle: Sliced, row: u32) {
    let y = f32(row) + 0.5;
    let ends = span(triangle, y);
    let resolution = f32(layer_places.window.resolution);
    let first = u32(clamp(ceil(ends.x - 0.5), 0.0, resolution));
    let end = u32(clamp(ceil(ends.y - 0.5), 0.0, resolution));
    let at_row = triangle.depth + triangle.slope.y * y;
    let slope = triangle.slope.x;
    let rises = slope >= 0.0;
    var begin = first;
    // Slices in the order in which the row meets them: between two of them it crosses one plane.
    let count = triangle.last_slice - triangle.first_slice + 1u;
    for (var k = 0u; k < count && begin < end; k++) {
        let index = select(triangle.last_slice - k, triangle.first_slice + k, rises);
        var until = end;
        if (k + 1u < count) {
            let depth = layer_places.planes[select(index - 1u, index, rises)];
            let crossing = (depth - at_row) / select(slope, select(-1e-20, 1e-20, rises), abs(slope) < 1e-20);
            until = u32(clamp(ceil(crossing - 0.5), f32(begin), f32(end)));
        }
        fill(index, row, begin, until);
        if (layer_frame.successors != 0u) {
            fill(index + 1u, row, begin, until);
        }
        begin = until;
    }
}

fn sliced_triangle(index: u32) -> Sliced {
    let k = 3u * index;
    return sliced(layer_frame, caster_range, corners[k].position, corners[k + 1u].position, corners[k + 2u].position);
}

@compute @workgroup_size(64)
fn slice_triangles(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let triangle = sliced_triangle(index);
    let rows = triangle.end_row - min(triangle.first_row, triangle.end_row);
    if (rows > MOST_ROWS) {
        tall.triangles[atomicAdd(&tall.count, 1u)] = index;
    }
    for (var k = 0u; k < select(rows, 0u, rows > MOST_ROWS); k++) {
        fill_row(triangle, triangle.first_row + k);
    }
}

fn groups_of_rows() -> u32 {
    return (layer_places.window.resolution + GROUP - 1u) / GROUP;
}

@compute @workgroup_size(1)
fn size_rows() {
    let groups = atomicLoad(&tall.count) * groups_of_rows() * slice.count;
    dispatch_size[0] = min(groups, LARGEST_DISPATCH);
    dispatch_size[1] = (groups + LARGEST_DISPATCH - 1u) / LARGEST_DISPATCH;
    dispatch_size[2] = 1u;
}

@compute @workgroup_size(64)  // GROUP
fn slice_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let position = group.y * groups.x + group.x;
    let item = position / groups_of_rows();
    if (item >= atomicLoad(&tall.count)) {
        return;
    }
    let triangle = sliced_triangle(tall.triangles[item]);
    let row = triangle.first_row + position % groups_of_rows() * GROUP + lane;
    if (row < triangle.end_row) {
        fill_row(triangle, row);
    }
}
