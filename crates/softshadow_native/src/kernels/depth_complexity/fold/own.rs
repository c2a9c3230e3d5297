//! Samples that a receiver has for itself: those of its own set, or a sphere's, which move with it. All are tested, eight at a time.

use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

use super::super::coverage::Crossing;
use super::super::edge::Vec2x8;
use super::super::frame::{FRAME_SPHERE, FrameView};
use super::super::lists::lanes_of;
use super::{Eight, GROUP, Samples, Stock};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::records;
use crate::kernels::shared::samples::Sampling;

/// What own samples are taken from.
pub(super) struct Sets<'a> {
    sampling: Sampling,
    sets: &'a [[f32; 2]],
    group: u32,
}

impl<'a> Sets<'a> {
    /// From the words of `SampleSets`.
    pub(super) fn new(sampling: Sampling, sets: &'a [u32], stock: &Stock<'_>) -> Self {
        Self { sampling, sets: records(sets), group: stock.settings.group }
    }
}

/// The samples of the members of a bundle, eight a vector; behind the last one that again.
pub(super) struct Own<S: Simd> {
    samples: [[Vec2x8<S>; GROUP as usize / LANES]; LANES],
    vectors: usize,
}

impl<S: Simd> Own<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, sets: &Sets<'_>, stock: &Stock<'_>, eight: &Eight<S>) -> Self {
        let (frame, view, bundle, count) = (&stock.frame, &eight.view, &eight.bundle, stock.count());
        let zero = f32x8::splat(simd, 0.0);
        let vectors = (count as usize).div_ceil(LANES);
        let mut samples = [[[zero; 2]; GROUP as usize / LANES]; LANES];
        for k in lanes_of(eight.member_bits) {
            let first = (sets.sampling.first_sample(bundle.slots[k].receiver) + GROUP * sets.group) as usize;
            let set = &sets.sets[first..first + count as usize];
            let cap = f32x8::splat(simd, view.cap.as_slice()[k]);
            let tangent = f32x8::splat(simd, view.tangent.as_slice()[k]);
            // Eight samples of one receiver, where a view has eight receivers.
            let view = FrameView { cap, tangent, ..*view };
            for (vector, placed) in samples[k].iter_mut().enumerate().take(vectors) {
                let eight: [[f32; 2]; LANES] =
                    std::array::from_fn(|lane| set[(LANES * vector + lane).min(set.len() - 1)]);
                *placed = [f32x8::from_fn(simd, |lane| eight[lane][0]), f32x8::from_fn(simd, |lane| eight[lane][1])];
                if frame.kind == FRAME_SPHERE {
                    *placed = frame.placed_sample(simd, &view, *placed);
                }
            }
        }
        Self { samples, vectors }
    }
}

impl<S: Simd> Samples<S> for Own<S> {
    #[inline(always)]
    fn crossed(&self, simd: S, crossing: &Crossing<S>, lanes: u32, mut found: impl FnMut(usize, u64)) {
        for k in lanes_of(lanes) {
            let one = crossing.lane(k);
            let from_x = f32x8::splat(simd, one.from[0]);
            let from_y = f32x8::splat(simd, one.from[1]);
            let to_x = f32x8::splat(simd, one.to[0]);
            let to_y = f32x8::splat(simd, one.to[1]);
            let line = Vec3x8::splat(simd, Vec3::from_array(one.line));
            let mut mask = 0;
            for (vector, [x, y]) in self.samples[k][..self.vectors].iter().enumerate() {
                let in_sector = (from_x * *y - from_y * *x).simd_ge(0.0) & (to_x * *y - to_y * *x).simd_lt(0.0);
                let left = (line.x * *x + line.y * *y + line.z).simd_ge(0.0);
                let beyond = if one.beyond_left { !left } else { left };
                mask |= (in_sector & beyond).to_bitmask() << (LANES * vector);
            }
            found(k, mask);
        }
    }

    #[inline(always)]
    fn below(&self, simd: S, slope: Vec3x8<S>, lane: usize) -> u64 {
        let slope = Vec3x8::splat(simd, slope.lane(lane));
        let mut mask = 0;
        for (vector, [x, y]) in self.samples[lane][..self.vectors].iter().enumerate() {
            mask |= (slope.z + slope.x * *x + slope.y * *y).simd_le(0.0).to_bitmask() << (LANES * vector);
        }
        mask
    }
}
