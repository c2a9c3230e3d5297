//! The twin of `depth_complexity/sample_bins.wgsl`: which samples lie in a part of the light, for eight parts. What bounds images there
//! is in `beam.rs`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use glam::Vec2;

use super::edge::Vec2x8;
use crate::kernels::lanes::LANES;

const BINS: usize = 63;

/// For either axis, the samples before each of 63 strips, one bit a sample.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SampleBins {
    low: Vec2,
    /// Strips in one unit.
    scale: Vec2,
    /// Samples before strip i along x, and along y; the last row are all.
    before: [[u32; 4]; BINS + 1],
}

/// Samples before strips along either axis, 64 bits each.
pub(super) struct Bins {
    low: Vec2,
    scale: Vec2,
    before: [[u64; BINS + 1]; 2],
}

impl Bins {
    pub(super) fn new(record: &SampleBins) -> Self {
        let half = |k: usize| record.before.map(|row| u64::from(row[2 * k]) | u64::from(row[2 * k + 1]) << 32);
        Self { low: record.low, scale: record.scale, before: [half(0), half(1)] }
    }

    /// All samples.
    pub(super) fn all(&self) -> u64 {
        self.before[0][BINS]
    }

    /// The samples between two corners on the light, lane by lane.
    #[inline(always)]
    pub(super) fn between<S: Simd>(&self, simd: S, low: Vec2x8<S>, high: Vec2x8<S>) -> [u64; LANES] {
        let first = |axis: usize| strip(simd, (low[axis] - self.low[axis]) * self.scale[axis], 0.0);
        let end = |axis: usize| strip(simd, (high[axis] - self.low[axis]) * self.scale[axis], 1.0);
        let [x, y] = &self.before;
        let (x0, y0, x1, y1) = (first(0), first(1), end(0), end(1));
        std::array::from_fn(|k| (x[x1[k]] & !x[x0[k]]) & (y[y1[k]] & !y[y0[k]]))
    }
}

/// Which strip a place lies in, or so many after it.
#[inline(always)]
fn strip<S: Simd>(simd: S, at: f32x8<S>, after: f32) -> [usize; LANES] {
    let (zero, end) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, BINS as f32));
    let strip = (at.floor() + after).max(zero).min(end).to_int::<i32x8<S>>().to_array();
    // Six bits, so that no index needs a check.
    strip.map(|strip| strip as usize & BINS)
}
