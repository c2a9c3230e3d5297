//! The twin of `occlusion_layers/sum_areas.wgsl`.

use rayon::prelude::*;

use super::layers::LayerFrame;
use crate::engine::{Call, atomic_words, shared};

pub(super) fn count_words(call: &mut Call) {
    let items = call.item_range();
    let frame: LayerFrame = call.uniform("layer_frame");
    let [bits, before] = call.buffers(["slice_bits", "words_before"]);
    let words = frame.resolution as usize / 32;
    let rows = items.start * words..items.end * words;
    let pairs = bits[rows.clone()].par_chunks_exact(words).zip(before[rows].par_chunks_exact_mut(words));
    pairs.for_each(|(bits, before)| {
        let mut sum = 0;
        for (bits, before) in bits.iter().zip(before) {
            *before = sum;
            sum += bits.count_ones();
        }
    });
}

/// Row after row, and so a column at a time only by name: memory lies in rows.
pub(super) fn sum_columns(call: &mut Call) {
    let items = call.item_range();
    let frame: LayerFrame = call.uniform("layer_frame");
    let [bits, before, sums] = call.buffers(["slice_bits", "words_before", "layer_tables"]);
    let (bits, before) = (&*bits, &*before);
    let (resolution, words) = (frame.resolution as usize, frame.resolution as usize / 32);
    let stride = resolution + 1;
    let sums = atomic_words(sums);
    let layers = items.start / stride..items.end.div_ceil(stride);
    let first_column = |layer: usize| items.start.saturating_sub(layer * stride);
    let end_column = |layer: usize| (items.end - layer * stride).min(stride);
    layers.into_par_iter().for_each(|layer| {
        use std::sync::atomic::Ordering::Relaxed;
        let base = layer * stride * stride;
        let columns = first_column(layer)..end_column(layer);
        columns.clone().for_each(|column| sums[base + column].store(0, Relaxed));
        for row in 0..resolution {
            let from = (layer * resolution + row) * words;
            let (bits, before) = (&bits[from..from + words], &before[from..from + words]);
            let at = base + (row + 1) * stride;
            for column in columns.clone() {
                let word = (column / 32).min(words - 1);
                let here = column - word * 32;
                let mask = if here == 32 { u32::MAX } else { (1 << here) - 1 };
                let sum = before[word] + (bits[word] & mask).count_ones();
                sums[at + column].store(shared(&sums[at + column - stride]) + sum, Relaxed);
            }
        }
    });
}
