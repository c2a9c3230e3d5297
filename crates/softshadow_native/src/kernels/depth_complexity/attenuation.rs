//! The twin of `depth_complexity/attenuation.wgsl`: what semi-opaque layers take away from 64 samples at a time, in units.
//!
//! Sums are two's complement of 28 bits. In between they may leave that range, in any order of the edges; that the final value fits, who
//! folds must see.

use bytemuck::{Pod, Zeroable};

use super::counters::plane_of;

/// What no sum exceeds of which every change is at most that in all.
pub(super) const LARGEST_ATTENUATION: u32 = 134_217_727;

/// Units of a triangle that lets nothing through.
pub(super) const OPAQUE: u32 = u32::MAX;

/// At more faces than that an edge counts as more than any sum holds.
const MOST_ATTENUATING_FACES: u32 = 1024;

const PLANES: usize = 28;

/// What one unit takes away.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct AttenuationScale {
    /// Of the light: layers multiply.
    pub(super) halvings: f32,
    /// Of all light: layers add.
    pub(super) shares: f32,
}

impl AttenuationScale {
    /// What passes a sum. Within rounding of an edge a sample may count a face as taken away: nothing passes more than all.
    pub(super) fn passed(&self, units: i32) -> f32 {
        let layers = units.max(0) as f32;
        ((-layers * self.halvings).exp2() - layers * self.shares).max(0.0)
    }
}

/// What semi-opaque layers add up to beside the counters of a fold.
#[derive(Clone, Copy)]
pub(super) struct Attenuated {
    planes: [u64; PLANES],
    /// By how much it can have changed at most.
    pub(super) most: u32,
}

impl Attenuated {
    pub(super) fn begin(units: i32) -> Self {
        Self { planes: std::array::from_fn(|bit| plane_of(units as u32, bit)), most: units.unsigned_abs() }
    }

    /// Adds an amount, which may be negative, to the samples of a mask.
    pub(super) fn add(&mut self, amount: i32, faces: u32, mask: u64) {
        if mask == 0 || amount == 0 {
            self.most = self.most.min(LARGEST_ATTENUATION + 1);
            return;
        }
        let mut carry = 0;
        for (bit, plane) in self.planes.iter_mut().enumerate() {
            let addend = mask & plane_of(amount as u32, bit);
            let half = *plane ^ addend;
            let next = (*plane & addend) | (half & carry);
            *plane = half ^ carry;
            carry = next;
        }
        let size = if faces > MOST_ATTENUATING_FACES { LARGEST_ATTENUATION + 1 } else { amount.unsigned_abs() };
        self.most = self.most.min(LARGEST_ATTENUATION + 1).wrapping_add(size);
    }

    /// The sum of one sample of the 64.
    pub(super) fn of_sample(&self, sample: usize) -> i32 {
        let digit = |(bit, plane): (usize, &u64)| ((plane >> sample & 1) as u32) << bit;
        let digits = self.planes.iter().enumerate().fold(0, |sum, plane| sum | digit(plane));
        ((digits << 4) as i32) >> 4
    }
}
