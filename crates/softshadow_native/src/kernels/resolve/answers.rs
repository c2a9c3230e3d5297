//! What masks and areas say of receivers: a part of `resolve/resolve.wgsl`.

use fearless_simd::{Simd, f32x8, prelude::*, u32x8};

use super::passes::{Answering, Answers, Eight, binomial_answer};
use crate::kernels::lanes::LANES;
use crate::kernels::records;
use crate::kernels::shared::samples::Sampling;

/// Masks of blocked samples.
pub(super) struct Masks<'a> {
    pub(super) sampling: Sampling,
    /// For how many samples each mask speaks; 0 for all of them.
    pub(super) decided: &'a [u32],
    pub(super) blocked: &'a [u32],
}

/// Masks, and what exact areas answer without noise.
pub(super) struct Areas<'a> {
    masks: Masks<'a>,
    /// A float, with its sign set where it answers.
    areas: &'a [u32],
    /// How far an area may lie from its samples.
    bound: f32,
}

/// Masks of the samples of a textured light.
pub(super) struct Textured<'a> {
    pub(super) masks: Masks<'a>,
    pub(super) radiance: Radiance<'a>,
}

/// Of the samples of all sets.
pub(super) struct Radiance<'a> {
    samples: &'a [[f32; 4]],
    sets: u32,
}

/// How many samples speak for a receiver.
#[inline(always)]
pub(super) fn known_samples<S: Simd>(simd: S, sampling: &Sampling, decided: &[u32], receivers: Eight) -> u32x8<S> {
    let decided = receivers.word_of_each(simd, decided, 1, 0);
    decided.simd_eq(0).select(u32x8::splat(simd, sampling.count), decided)
}

/// The most samples that any receiver knows.
#[inline(always)]
pub(super) fn most<S: Simd>(known: u32x8<S>) -> u32 {
    known.to_array().into_iter().fold(0, u32::max)
}

/// The sets of eight receivers, among all samples.
#[inline(always)]
pub(super) fn first_samples(sampling: &Sampling, receivers: Eight) -> [usize; LANES] {
    std::array::from_fn(|k| sampling.first_sample(receivers.receiver(k) as u32) as usize)
}

impl<'a> Radiance<'a> {
    pub(super) fn new(sampling: &Sampling, samples: &'a [u32]) -> Self {
        Self { samples: records(samples), sets: sampling.sets }
    }

    /// Of one sample of each set.
    #[inline(always)]
    pub(super) fn of_each<S: Simd>(&self, simd: S, sets: &[usize; LANES], sample: u32) -> [f32x8<S>; 3] {
        if self.sets < 2 {
            let [red, green, blue, _] = self.samples[sample as usize];
            return [red, green, blue].map(|channel| f32x8::splat(simd, channel));
        }
        let each: [[f32; 4]; LANES] = std::array::from_fn(|k| self.samples[sets[k] + sample as usize]);
        std::array::from_fn(|channel| f32x8::from_fn(simd, |k| each[k][channel]))
    }
}

impl Masks<'_> {
    #[inline(always)]
    fn known<S: Simd>(&self, simd: S, receivers: Eight) -> u32x8<S> {
        known_samples(simd, &self.sampling, self.decided, receivers)
    }

    /// A word of each mask, without bits beyond what is known.
    #[inline(always)]
    fn mask_word<S: Simd>(&self, simd: S, receivers: Eight, word: u32, known: u32x8<S>) -> u32x8<S> {
        let mask = receivers.word_of_each(simd, self.blocked, self.sampling.words as usize, word as usize);
        let zero = u32x8::splat(simd, 0);
        let missing = u32x8::splat(simd, 32 * (word + 1));
        let missing = missing.simd_gt(known).select(missing - known, zero);
        let bits = u32x8::splat(simd, u32::MAX) >> (missing & 31);
        missing.simd_lt(32).select(mask & bits, zero)
    }

    /// The share of samples that is not blocked.
    #[inline(always)]
    fn share<S: Simd>(&self, simd: S, receivers: Eight, known: u32x8<S>) -> f32x8<S> {
        let mut hidden = u32x8::splat(simd, 0);
        for word in 0..most(known).div_ceil(32) {
            hidden += self.mask_word(simd, receivers, word, known).count_ones();
        }
        1.0 - f32x8::float_from(hidden) / f32x8::float_from(known)
    }
}

impl Answering<1> for Masks<'_> {
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, 1> {
        let known = self.known(simd, receivers);
        binomial_answer(simd, [self.share(simd, receivers, known)], f32x8::float_from(known))
    }
}

impl<'a> Areas<'a> {
    pub(super) fn new(sampling: Sampling, blocked: &'a [u32], areas: &'a [u32]) -> Self {
        // Twice the largest error seen for stratified samples of a half plane.
        let bound = 2.0 * (sampling.count as f32).powf(-0.75);
        Self { masks: Masks { sampling, decided: &[], blocked }, areas, bound }
    }
}

impl Answering<1> for Areas<'_> {
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, 1> {
        let known = u32x8::splat(simd, self.masks.sampling.count);
        let sampled = self.masks.share(simd, receivers, known);
        let words = receivers.word_of_each(simd, self.areas, 1, 0);
        let area = f32x8::from_bits(words & 0x7fff_ffff);
        let by_area = words.simd_gt(0x7fff_ffff) & (area - sampled).abs().simd_le(self.bound);
        let known = by_area.select(f32x8::splat(simd, 0.0), f32x8::float_from(known));
        binomial_answer(simd, [by_area.select(area, sampled)], known)
    }
}

impl Answering<3> for Textured<'_> {
    /// V = Σ L·visible / Σ L by channel; a channel without light returns the share of area.
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, 3> {
        let known = self.masks.known(simd, receivers);
        let sets = first_samples(&self.masks.sampling, receivers);
        let zero = f32x8::splat(simd, 0.0);
        let (mut seen, mut whole) = ([zero; 3], [zero; 3]);
        let most = most(known);
        for word in 0..most.div_ceil(32) {
            let mask = self.masks.mask_word(simd, receivers, word, known);
            for bit in 0..(most - 32 * word).min(32) {
                let sample = 32 * word + bit;
                let exists = known.simd_gt(sample);
                let is_seen = exists & (mask >> bit & 1).simd_eq(0);
                for (channel, radiance) in self.radiance.of_each(simd, &sets, sample).into_iter().enumerate() {
                    whole[channel] += exists.select(radiance, zero);
                    seen[channel] += is_seen.select(radiance, zero);
                }
            }
        }
        let by_area = self.masks.share(simd, receivers, known);
        let value = std::array::from_fn(|channel| {
            let [seen, whole] = [seen[channel], whole[channel]];
            whole.simd_gt(zero).select(seen / whole.max(f32x8::splat(simd, 1e-37)), by_area)
        });
        binomial_answer(simd, value, f32x8::float_from(known))
    }
}
