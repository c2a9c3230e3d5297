//! The twin of `occlusion_layers/levels.wgsl`.

use super::layers::LayerFrame;

pub(super) const FILTER_SUMMED_AREA: u32 = 0;
pub(super) const FILTER_NBUFFER: u32 = 1;

/// Levels of the largest slices, of 2,048 texels a side.
pub(super) const MOST_LEVELS: usize = 12;

/// Where the entries of a level lie.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Level {
    /// Words before it.
    pub(super) begin: usize,
    /// Entries a side. An N-buffer has one for every box that holds any texel; what juts out holds nothing there.
    pub(super) side: usize,
}

/// All levels; the places of those that a summed-area table lacks mean nothing.
pub(super) fn levels(frame: &LayerFrame) -> [Level; MOST_LEVELS] {
    let (groups, resolution) = (frame.slices.div_ceil(4) as usize, frame.resolution as usize);
    let mut begin = 0;
    std::array::from_fn(|level| {
        let is_nbuffer = frame.filter_kind == FILTER_NBUFFER;
        let side = if is_nbuffer { resolution + (1 << level) - 1 } else { resolution >> level };
        let here = Level { begin, side };
        begin += groups * side * side;
        here
    })
}

/// Four shares of eight bits each.
pub(super) fn unpack(word: u32) -> [f32; 4] {
    word.to_le_bytes().map(|byte| f32::from(byte) / 255.0)
}

pub(super) fn pack(shares: [f32; 4]) -> u32 {
    u32::from_le_bytes(shares.map(|share| (share.clamp(0.0, 1.0) * 255.0).round_ties_even() as u8))
}
