//! The twin of `resolve/open_samples.wgsl`.

use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records_mut};

pub(super) fn open_samples(call: &mut Call) {
    let items = call.item_range();
    let sampling: Sampling = call.uniform("sampling");
    let (count, words) = (sampling.count as usize, sampling.words as usize);
    let [blocked, transmittance] = call.buffers(["blocked", "sample_transmittance"]);
    let blocked = &blocked[items.start * words..items.end * words];
    let transmittance = &mut records_mut::<f32>(transmittance)[items.start * count..items.end * count];
    let samples = transmittance.par_chunks_exact_mut(count).zip(blocked.par_chunks_exact(words)).with_min_len(RUN);
    samples.for_each(|(samples, blocked)| {
        for (samples, mask) in samples.chunks_mut(32).zip(blocked) {
            for (bit, passes) in samples.iter_mut().enumerate() {
                *passes = if mask >> bit & 1 == 0 { 1.0 } else { 0.0 };
            }
        }
    });
}
