//! The twin of `occlusion_layers/build_levels.wgsl`.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::layers::LayerFrame;
use super::levels::{FILTER_NBUFFER, levels, pack, unpack};
use crate::engine::Call;
use crate::kernels::RUN;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LevelRange {
    level: u32,
    reserved: [u32; 3],
}

/// Level 0: bits as shares.
pub(super) fn expand(call: &mut Call) {
    let items = call.item_range();
    let frame: LayerFrame = call.uniform("layer_frame");
    let [bits, tables] = call.buffers(["slice_bits", "layer_tables"]);
    let (bits, resolution, slices) = (&*bits, frame.resolution as usize, frame.slices as usize);
    let first = items.start;
    tables[items].par_chunks_mut(RUN).enumerate().for_each(|(run, words)| {
        for (at, word) in words.iter_mut().enumerate() {
            let item = first + run * RUN + at;
            let (group, texel) = (item / (resolution * resolution), item % (resolution * resolution));
            *word = pack(std::array::from_fn(|k| {
                let bit = (4 * group + k).min(slices - 1) * resolution * resolution + texel;
                (bits[bit / 32] >> (bit % 32) & 1) as f32
            }));
        }
    });
}

/// A level from the one below, by four of its entries.
pub(super) fn build_level(call: &mut Call) {
    let items = call.item_range();
    let (frame, range): (LayerFrame, LevelRange) = (call.uniform("layer_frame"), call.uniform("level_range"));
    let [tables] = call.buffers(["layer_tables"]);
    let all = levels(&frame);
    let (here, below) = (all[range.level as usize], all[range.level as usize - 1]);
    let (lower, words) = tables.split_at_mut(here.begin);
    let lower = &lower[below.begin..];
    let is_nbuffer = frame.filter_kind == FILTER_NBUFFER;
    let half_size = 1_isize << (range.level - 1);
    let step = if is_nbuffer { half_size } else { 1 };
    // An N-buffer's entry k begins at texel k + 1 - 2^l, the one below at k + 1 - 2^(l - 1).
    let begin = |at: usize| if is_nbuffer { at.cast_signed() - half_size } else { 2 * at.cast_signed() };
    let inside = |at: isize| usize::try_from(at).ok().filter(|at| *at < below.side);
    let first = items.start;
    words[items].par_chunks_mut(RUN).enumerate().for_each(|(run, words)| {
        for (at, word) in words.iter_mut().enumerate() {
            let item = first + run * RUN + at;
            let (row, x) = (item / here.side, begin(item % here.side));
            let (group, y) = (row / here.side, begin(row % here.side));
            let entries = &lower[group * below.side * below.side..][..below.side * below.side];
            let entry = |x: isize, y: isize| match (inside(x), inside(y)) {
                (Some(x), Some(y)) => unpack(entries[y * below.side + x]),
                _ => [0.0; 4],
            };
            let four = [entry(x, y), entry(x + step, y), entry(x, y + step), entry(x + step, y + step)];
            *word = pack(std::array::from_fn(|k| (four[0][k] + four[1][k] + four[2][k] + four[3][k]) * 0.25));
        }
    });
}
