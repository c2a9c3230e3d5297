//! The twin of `depth_complexity/sums.wgsl`: what the edges of one receiver add up to.

use fearless_simd::{Simd, f32x8, i32x8, prelude::*};

use super::counters::{Counters, LARGEST_COUNT};

/// Digits of a change that counters take.
const SIZE: u32 = 7;

#[derive(Clone, Copy)]
pub(super) struct Sums {
    pub(super) counters: Counters,
    /// By how much D can have changed at most.
    pub(super) changes: u32,
    /// Change of any edge.
    pub(super) smallest: u32,
}

/// The samples of a group of 64 that exist.
pub(super) fn existing(samples: u32) -> u64 {
    u64::MAX >> (64 - samples.clamp(1, 64))
}

impl Sums {
    #[inline(always)]
    pub(super) fn begin(depth: i32) -> Self {
        Self { counters: Counters::at(depth), changes: depth.unsigned_abs(), smallest: 0xffff }
    }

    /// Adds what changes at one edge for the samples of `mask`. D grows where the reference point lies right of an edge of positive weight.
    #[inline(always)]
    pub(super) fn fold(&mut self, weight: i32, left: bool, mask: u64) {
        let all = weight.unsigned_abs();
        let size = all & SIZE;
        if mask != 0 {
            self.counters.change(mask, size, (weight < 0) != left);
        }
        // More faces than that at one edge: counted as more than any counter holds.
        self.changes = self.changes.wrapping_add(if all > SIZE { LARGEST_COUNT + 1 } else { size });
        self.smallest = self.smallest.min(size);
    }

    /// As `fold`, without a note of the smallest change.
    #[inline(always)]
    pub(super) fn with_layers(&mut self, change: i32, mask: u64) {
        let size = change.unsigned_abs();
        self.counters.change(mask, size & SIZE, change < 0);
        self.changes = self.changes.wrapping_add(if size > SIZE { LARGEST_COUNT + 1 } else { size });
    }
}

/// Areas are summed in this fixed point, so that the order of edges changes no bit.
pub(super) const AREA_UNITS: f32 = 4_194_304.0;

/// Areas in fixed point, with the sign of the change.
#[inline(always)]
pub(super) fn signed_area<S: Simd>(
    simd: S,
    area: f32x8<S>,
    weight: i32x8<S>,
    left: fearless_simd::mask32x8<S>,
) -> i32x8<S> {
    let units: i32x8<S> = (area * AREA_UNITS).round_ties_even().to_int();
    let zero = i32x8::splat(simd, 0);
    let minus = weight.simd_lt(zero);
    let size = minus.select(zero - weight, weight) & i32x8::splat(simd, SIZE as i32);
    units * (minus ^ left).select(zero - size, size)
}
