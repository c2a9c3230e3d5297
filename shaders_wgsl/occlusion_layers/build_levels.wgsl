// The levels of the published filters: N-buffers, whose level l holds the mean over 2^l by 2^l texels at every texel, and mipmaps, which hold
// it at every 2^l-th. Four slices a word, of eight bits each, as in the colour channels of the paper.
//#import shared/slice.wgsl
//#import occlusion_layers/layers.wgsl
//#import occlusion_layers/levels.wgsl

struct LevelRange {
    level: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(2) var<uniform> level_range: LevelRange;
@group(0) @binding(3) var<storage, read> slice_bits: array<u32>;
@group(0) @binding(4) var<storage, read_write> layer_tables: array<u32>;

// Level 0: bits as shares.
@compute @workgroup_size(64)
fn expand(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let resolution = layer_frame.resolution;
    let item = slice.first + invocation.x;
    let texels = resolution * resolution;
    let group = item / texels;
    let row = item % texels / resolution;
    let column = item % resolution;
    var shares = vec4<f32>(0.0);
    for (var k = 0u; k < 4u; k++) {
        let layer = min(4u * group + k, layer_frame.slices - 1u);
        let word = slice_bits[((layer * resolution + row) * resolution + column) / 32u];
        shares[k] = f32((word >> (column % 32u)) & 1u);
    }
    layer_tables[item] = pack4x8unorm(shares);
}

fn entry(base: u32, side: u32, x: i32, y: i32) -> vec4<f32> {
    let is_there = x >= 0 && y >= 0 && u32(x) < side && u32(y) < side;
    let at = base + select(0u, u32(y) * side + u32(x), is_there);
    return select(vec4<f32>(0.0), unpack4x8unorm(layer_tables[at]), is_there);
}

// A level from the one below, by four of its entries.
@compute @workgroup_size(64)
fn build_level(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let resolution = layer_frame.resolution;
    let groups = (layer_frame.slices + 3u) / 4u;
    let level = level_range.level;
    let is_nbuffer = layer_frame.filter_kind == FILTER_NBUFFER;
    let side = level_side(is_nbuffer, resolution, level);
    let below = level_side(is_nbuffer, resolution, level - 1u);
    let item = slice.first + invocation.x;
    let group = item / (side * side);
    let x = i32(item % side);
    let y = i32(item % (side * side) / side);
    let base = level_begin(is_nbuffer, resolution, groups, level - 1u) + group * below * below;
    // An N-buffer's entry k begins at texel k + 1 - 2^l, the one below at k + 1 - 2^(l - 1).
    let half_size = i32(1u << (level - 1u));
    let x0 = select(2 * x, x - half_size, is_nbuffer);
    let y0 = select(2 * y, y - half_size, is_nbuffer);
    let step = select(1, half_size, is_nbuffer);
    let sum = entry(base, below, x0, y0) + entry(base, below, x0 + step, y0)
        + entry(base, below, x0, y0 + step) + entry(base, below, x0 + step, y0 + step);
    layer_tables[level_begin(is_nbuffer, resolution, groups, level) + item] = pack4x8unorm(sum * 0.25);
}
