//! What samples say to which a part of the light may pass: a part of `resolve/resolve.wgsl`.

use fearless_simd::{Simd, f32x8, prelude::*, u32x8};

use super::answers::{Radiance, first_samples, known_samples, most};
use super::passes::{Answering, Answers, Eight};
use crate::kernels::lanes::LANES;
use crate::kernels::shared::samples::Sampling;

/// What passes to each sample.
pub(super) struct Transmittance<'a> {
    pub(super) sampling: Sampling,
    /// How many samples speak for all; 0 for all of them.
    pub(super) decided: &'a [u32],
    pub(super) samples: &'a [f32],
}

/// What passes to each sample of a textured light.
pub(super) struct TexturedTransmittance<'a> {
    pub(super) transmittance: Transmittance<'a>,
    pub(super) radiance: Radiance<'a>,
}

/// Mean and standard error of samples between 0 and 1, from their weighted moments about one of them: of samples that are 0 or 1 that is
/// the binomial estimate.
#[derive(Clone, Copy)]
struct Moments<S: Simd> {
    whole: f32x8<S>,
    first: f32x8<S>,
    second: f32x8<S>,
}

impl<S: Simd> Moments<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        Self { whole: zero, first: zero, second: zero }
    }

    #[inline(always)]
    fn add(&mut self, weight: f32x8<S>, difference: f32x8<S>) {
        let first = weight * difference;
        self.whole += weight;
        self.first += first;
        self.second += first * difference;
    }

    #[inline(always)]
    fn mean(&self, simd: S) -> f32x8<S> {
        self.first / self.whole.max(f32x8::splat(simd, 1e-37))
    }

    #[inline(always)]
    fn error(&self, simd: S, known: f32x8<S>) -> f32x8<S> {
        let two = f32x8::splat(simd, 2.0);
        let mean = self.mean(simd);
        let squares = self.second / self.whole.max(f32x8::splat(simd, 1e-37)) - mean * mean;
        let error = (squares.max(f32x8::splat(simd, 0.0)) / (known.max(two) - 1.0)).sqrt();
        known.simd_lt(two).select(f32x8::splat(simd, 0.5), error)
    }
}

/// As many samples of 0 and 1 as would have such an error of such a mean.
#[inline(always)]
fn spread<S: Simd>(simd: S, value: f32x8<S>, error: f32x8<S>) -> f32x8<S> {
    let variance = (value * (1.0 - value)).max(f32x8::splat(simd, 0.0));
    variance / (error * error).max(f32x8::splat(simd, 1e-12)) + 1.0
}

/// The same by the channel that is known least.
#[inline(always)]
fn equal_samples<S: Simd, const CHANNELS: usize>(
    simd: S,
    value: [f32x8<S>; CHANNELS],
    error: [f32x8<S>; CHANNELS],
    known: f32x8<S>,
) -> f32x8<S> {
    let least = (1..CHANNELS).fold(spread(simd, value[0], error[0]), |least, channel| {
        least.min(spread(simd, value[channel], error[channel]))
    });
    known.simd_lt(2.0).select(known, least.max(known))
}

impl Transmittance<'_> {
    #[inline(always)]
    fn known<S: Simd>(&self, simd: S, receivers: Eight) -> u32x8<S> {
        known_samples(simd, &self.sampling, self.decided, receivers)
    }

    /// The first samples of each receiver.
    #[inline(always)]
    fn samples(&self, receivers: Eight, most: u32) -> [&[f32]; LANES] {
        let first = |k: usize| receivers.receiver(k) * self.sampling.count as usize;
        std::array::from_fn(|k| &self.samples[first(k)..first(k) + most as usize])
    }
}

impl Answering<1> for Transmittance<'_> {
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, 1> {
        let known = self.known(simd, receivers);
        let most = most(known);
        let samples = self.samples(receivers, most);
        let about = f32x8::from_fn(simd, |k| samples[k][0]);
        let mut moments = Moments::new(simd);
        for sample in 0..most {
            let difference = f32x8::from_fn(simd, |k| samples[k][sample as usize]) - about;
            moments.add(known.simd_gt(sample).select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0)), difference);
        }
        let known = f32x8::float_from(known);
        let value = about + moments.mean(simd);
        let error = moments.error(simd, known);
        Answers { value: [value], known: equal_samples(simd, [value], [error], known), error: [error] }
    }
}

impl Answering<3> for TexturedTransmittance<'_> {
    /// V = Σ L·passes / Σ L by channel; a channel without light returns the mean of what passes.
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, receivers: Eight) -> Answers<S, 3> {
        let Self { transmittance, radiance } = self;
        let known = transmittance.known(simd, receivers);
        let most = most(known);
        let samples = transmittance.samples(receivers, most);
        let sets = first_samples(&transmittance.sampling, receivers);
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let about = f32x8::from_fn(simd, |k| samples[k][0]);
        let (mut plain, mut weighted) = (Moments::new(simd), [Moments::new(simd); 3]);
        for sample in 0..most {
            let difference = f32x8::from_fn(simd, |k| samples[k][sample as usize]) - about;
            let exists = known.simd_gt(sample);
            plain.add(exists.select(one, zero), difference);
            let radiance = radiance.of_each(simd, &sets, sample);
            for (weighted, radiance) in weighted.iter_mut().zip(radiance) {
                weighted.add(exists.select(radiance, zero), difference);
            }
        }
        let known = f32x8::float_from(known);
        let (plain_mean, plain_error) = (plain.mean(simd), plain.error(simd, known));
        let has_light = weighted.map(|weighted| weighted.whole.simd_gt(zero));
        let value = std::array::from_fn(|c| about + has_light[c].select(weighted[c].mean(simd), plain_mean));
        let error = std::array::from_fn(|c| has_light[c].select(weighted[c].error(simd, known), plain_error));
        Answers { value, known: equal_samples(simd, value, error, known), error }
    }
}
