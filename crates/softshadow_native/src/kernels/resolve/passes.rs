//! What becomes of the answers of one pass: the part of `resolve/resolve.wgsl` that all its entries share.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*, u32x8};
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::lanes::LANES;
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records_mut};

/// What one pass says of eight receivers.
pub(super) struct Answers<S: Simd, const CHANNELS: usize> {
    pub(super) value: [f32x8<S>; CHANNELS],
    /// Samples that are 0 or 1 and say as much; 0 where an area answered.
    pub(super) known: f32x8<S>,
    /// Of this pass alone.
    pub(super) error: [f32x8<S>; CHANNELS],
}

/// Eight neighbours; where fewer are left, the last stands for the missing ones.
#[derive(Clone, Copy)]
pub(super) struct Eight {
    first: usize,
    count: usize,
}

impl Eight {
    #[inline(always)]
    pub(super) fn receiver(self, k: usize) -> usize {
        self.first + k.min(self.count - 1)
    }

    /// One of so many words that each receiver has.
    #[inline(always)]
    pub(super) fn word_of_each<S: Simd>(self, simd: S, words: &[u32], each: usize, at: usize) -> u32x8<S> {
        // One after the other they are loaded at once.
        if each == 1 && self.count == LANES {
            return u32x8::from_slice(simd, &words[self.first..self.first + LANES]);
        }
        u32x8::from_fn(simd, |k| words[self.receiver(k) * each + at])
    }
}

/// Something that has answers.
pub(super) trait Answering<const CHANNELS: usize>: Sync {
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, CHANNELS>;
}

#[inline(always)]
fn binomial_error<S: Simd>(simd: S, value: f32x8<S>, known: f32x8<S>) -> f32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let two = f32x8::splat(simd, 2.0);
    let error = ((value * (1.0 - value)).max(zero) / (known.max(two) - 1.0)).sqrt();
    // One sample says nothing about its own error, which is at most a half.
    known.simd_lt(two).select(f32x8::splat(simd, 0.5), error)
}

/// Of samples that are 0 or 1; an area has no error.
#[inline(always)]
pub(super) fn binomial_answer<S: Simd, const CHANNELS: usize>(
    simd: S,
    value: [f32x8<S>; CHANNELS],
    known: f32x8<S>,
) -> Answers<S, CHANNELS> {
    let zero = f32x8::splat(simd, 0.0);
    let error = value.map(|value| known.simd_eq(zero).select(zero, binomial_error(simd, value, known)));
    Answers { value, known, error }
}

/// A pass over receivers.
pub(super) struct Pass {
    items: Range<usize>,
    level: Level,
    pub(super) sampling: Sampling,
}

impl Pass {
    pub(super) fn of(call: &mut Call) -> Self {
        Self { items: call.item_range(), level: call.level, sampling: call.uniform("sampling") }
    }

    /// Adds the answers to those of the passes before.
    pub(super) fn accumulate<const CHANNELS: usize>(
        &self,
        answering: &impl Answering<CHANNELS>,
        [visibility, standard_error]: [&mut [u32]; 2],
    ) {
        let slots = CHANNELS * self.items.start..CHANNELS * self.items.end;
        let means = &mut records_mut::<f32>(visibility)[slots.clone()];
        let errors = &mut records_mut::<f32>(standard_error)[slots];
        let runs = means.par_chunks_mut(CHANNELS * RUN).zip(errors.par_chunks_mut(CHANNELS * RUN)).enumerate();
        runs.for_each(|(run, (means, errors))| {
            let first = self.items.start + run * RUN;
            dispatch!(self.level, simd => accumulate_run(simd, &self.sampling, answering, first, means, errors));
        });
    }

    /// Keeps the answers for `interleave`.
    pub(super) fn keep<const CHANNELS: usize>(&self, answering: &impl Answering<CHANNELS>, pass_values: &mut [u32]) {
        let values = &mut records_mut::<[f32; 4]>(pass_values)[self.items.clone()];
        values.par_chunks_mut(RUN).enumerate().for_each(|(run, values)| {
            let first = self.items.start + run * RUN;
            dispatch!(self.level, simd => keep_run(simd, answering, first, values));
        });
    }
}

#[inline(always)]
fn accumulate_run<S: Simd, const CHANNELS: usize>(
    simd: S,
    sampling: &Sampling,
    answering: &impl Answering<CHANNELS>,
    first: usize,
    means: &mut [f32],
    errors: &mut [f32],
) {
    let eights = means.chunks_mut(CHANNELS * LANES).zip(errors.chunks_mut(CHANNELS * LANES)).enumerate();
    for (at, (means, errors)) in eights {
        let receivers = Eight { first: first + at * LANES, count: means.len() / CHANNELS };
        let answers = answering.answer(simd, receivers);
        for channel in 0..CHANNELS {
            let (value, error) = (answers.value[channel], answers.error[channel]);
            if CHANNELS == 1 && receivers.count == LANES {
                let before = [f32x8::from_slice(simd, means), f32x8::from_slice(simd, errors)];
                let [mean, error] = updated(simd, sampling, before, value, error);
                mean.store_slice(means);
                error.store_slice(errors);
                continue;
            }
            let slot = |k: usize| CHANNELS * k.min(receivers.count - 1) + channel;
            let before = [&*means, &*errors].map(|slots| f32x8::from_fn(simd, |k| slots[slot(k)]));
            let [mean, error] = updated(simd, sampling, before, value, error);
            for k in 0..receivers.count {
                means[slot(k)] = mean.as_slice()[k];
                errors[slot(k)] = error.as_slice()[k];
            }
        }
    }
}

/// Welford's update of mean and standard error with the value of one more pass. The standard error's slot holds the sum of squared
/// deviations until the last pass.
#[inline(always)]
fn updated<S: Simd>(
    simd: S,
    sampling: &Sampling,
    [mean, deviations]: [f32x8<S>; 2],
    value: f32x8<S>,
    error: f32x8<S>,
) -> [f32x8<S>; 2] {
    let zero = f32x8::splat(simd, 0.0);
    let (index, passes) = (sampling.pass_index, sampling.passes);
    let [mean, deviations] = if index > 0 {
        let step = value - mean;
        let mean = mean + step / (index + 1) as f32;
        [mean, deviations + step * (value - mean)]
    } else {
        [value, zero]
    };
    if index + 1 < passes {
        [mean, deviations]
    } else if passes > 1 {
        [mean, (deviations.max(zero) / (passes - 1) as f32 / passes as f32).sqrt()]
    } else {
        [mean, error]
    }
}

#[inline(always)]
fn keep_run<S: Simd, const CHANNELS: usize>(
    simd: S,
    answering: &impl Answering<CHANNELS>,
    first: usize,
    values: &mut [[f32; 4]],
) {
    for (at, values) in values.chunks_mut(LANES).enumerate() {
        let answers = answering.answer(simd, Eight { first: first + at * LANES, count: values.len() });
        for (k, value) in values.iter_mut().enumerate() {
            // The first channel stands for all without textures.
            let channel = |c: usize| answers.value[c.min(CHANNELS - 1)].as_slice()[k];
            *value = [channel(0), channel(1), channel(2), answers.known.as_slice()[k]];
        }
    }
}
