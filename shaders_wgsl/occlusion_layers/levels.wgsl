// Where the entries of a level lie.

const FILTER_SUMMED_AREA: u32 = 0u;
const FILTER_NBUFFER: u32 = 1u;
const FILTER_MIPMAP: u32 = 2u;

// Entries a side. An N-buffer has one for every box that holds any texel; what juts out holds nothing there.
fn level_side(is_nbuffer: bool, resolution: u32, level: u32) -> u32 {
    return select(resolution >> level, resolution + (1u << level) - 1u, is_nbuffer);
}

// Words before a level.
fn level_begin(is_nbuffer: bool, resolution: u32, groups: u32, level: u32) -> u32 {
    var words = 0u;
    for (var k = 0u; k < level; k++) {
        let side = level_side(is_nbuffer, resolution, k);
        words += groups * side * side;
    }
    return words;
}
