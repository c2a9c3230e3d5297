//! Averages over the pixels side by side whose samples make up one set: the last part of `resolve/resolve.wgsl`.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

use super::passes::{Answering, Answers, Eight, binomial_answer};
use crate::kernels::lanes::LANES;
use crate::kernels::shared::continuity::Interleaving;
use crate::kernels::shared::receiver::Receiver;

/// The values of one pass, to average where pixels see one surface.
pub(super) struct Kept<'a> {
    pub(super) interleaving: Interleaving,
    pub(super) receivers: &'a [Receiver],
    pub(super) pass_values: &'a [[f32; 4]],
}

impl<const CHANNELS: usize> Answering<CHANNELS> for Kept<'_> {
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, pixels: Eight) -> Answers<S, CHANNELS> {
        let pixels: [usize; LANES] = std::array::from_fn(|k| pixels.receiver(k));
        let zero = f32x8::splat(simd, 0.0);
        let value_at = |at: &[usize; LANES], channel| f32x8::from_fn(simd, |k| self.pass_values[at[k]][channel]);
        let (mut sum, mut total, mut squares) = ([zero; CHANNELS], zero, zero);
        self.interleaving.around(simd, self.receivers, pixels, |there| {
            let is_one = there.exist & (there.continuous | mask32x8::splat(simd, there.own));
            let weight = is_one.select(f32x8::splat(simd, there.share), zero);
            for (channel, sum) in sum.iter_mut().enumerate() {
                *sum += weight * value_at(&there.at, channel);
            }
            total += weight;
            let known = value_at(&there.at, 3);
            let square = weight * weight / known.max(f32x8::splat(simd, 1.0));
            squares += known.simd_gt(zero).select(square, zero);
        });
        // What an area answered stays.
        let by_area = value_at(&pixels, 3).simd_eq(zero);
        // As many independent samples as would vary as much as the average does.
        let known = by_area.select(zero, total * total / squares.max(f32x8::splat(simd, 1e-30)));
        let value = std::array::from_fn(|channel| by_area.select(value_at(&pixels, channel), sum[channel] / total));
        binomial_answer(simd, value, known)
    }
}
