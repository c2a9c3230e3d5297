//! The twin of `resolve/mask_samples.wgsl`.

use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records};

pub(super) fn mask_samples(call: &mut Call) {
    let items = call.item_range();
    let sampling: Sampling = call.uniform("sampling");
    let (count, words) = (sampling.count as usize, sampling.words as usize);
    let [transmittance, blocked] = call.buffers(["sample_transmittance", "blocked"]);
    let transmittance = &records::<f32>(transmittance)[items.start * count..items.end * count];
    let blocked = &mut blocked[items.start * words..items.end * words];
    let mask = |samples: &[f32]| {
        samples.iter().enumerate().fold(0, |mask, (bit, passes)| mask | u32::from(*passes <= 0.0) << bit)
    };
    let masks = blocked.par_chunks_exact_mut(words).zip(transmittance.par_chunks_exact(count)).with_min_len(RUN);
    masks.for_each(|(blocked, samples)| {
        for (word, samples) in blocked.iter_mut().zip(samples.chunks(32)) {
            *word = mask(samples);
        }
    });
}
