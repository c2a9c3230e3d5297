// The summed-area tables: entry (i, j) of a slice is the number of bits set in the first i columns of the first j rows.
//
// In integers, so every sum and every difference is exact.
//#import shared/slice.wgsl
//#import occlusion_layers/layers.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(2) var<storage, read> slice_bits: array<u32>;
@group(0) @binding(3) var<storage, read_write> words_before: array<u32>;
@group(0) @binding(4) var<storage, read_write> layer_tables: array<u32>;

// Bits of a row before each of its words.
@compute @workgroup_size(64)
fn count_words(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let words = layer_frame.resolution / 32u;
    let base = (slice.first + invocation.x) * words;
    var sum = 0u;
    for (var word = 0u; word < words; word++) {
        words_before[base + word] = sum;
        sum += countOneBits(slice_bits[base + word]);
    }
}

// A column of a table, from the first row to the last.
@compute @workgroup_size(64)
fn sum_columns(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let resolution = layer_frame.resolution;
    let words = resolution / 32u;
    let stride = resolution + 1u;
    let item = slice.first + invocation.x;
    let layer = item / stride;
    let column = item % stride;
    let word = min(column / 32u, words - 1u);
    let bits = column - word * 32u;
    let mask = select((1u << (bits % 32u)) - 1u, 0xffffffffu, bits == 32u);
    var at = layer * stride * stride + column;
    var sum = 0u;
    layer_tables[at] = 0u;
    for (var row = 0u; row < resolution; row++) {
        let at_word = (layer * resolution + row) * words + word;
        sum += words_before[at_word] + countOneBits(slice_bits[at_word] & mask);
        at += stride;
        layer_tables[at] = sum;
    }
}
