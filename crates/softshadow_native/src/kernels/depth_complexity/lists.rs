//! How twins read what tiles hold: bundles of eight receivers, and lists of chunks.

use std::sync::atomic::AtomicU32;

use fearless_simd::{Simd, u32x8};
use glam::Vec3;

use super::tiles::{BUNDLE, CHUNK, NO_VIEW, Slot};
use crate::engine::shared;
use crate::kernels::lanes::Vec3x8;
use crate::kernels::shared::receiver::{NO_TRIANGLE, RECEIVER_POINT, Receiver};

/// Words of a slot.
pub(super) const SLOT: usize = size_of::<Slot>() / 4;

/// Eight slots that lie side by side, and their receivers.
pub(super) struct Bundle {
    pub(super) slots: [Slot; BUNDLE],
    pub(super) receivers: [Receiver; BUNDLE],
    /// One bit a lane that looks at the light, of either part.
    pub(super) looking: u32,
}

impl Bundle {
    /// The slots from `first` on; there may be fewer than eight.
    #[inline(always)]
    pub(super) fn at(first: usize, slot_count: usize, slots: &[AtomicU32], receivers: &[Receiver]) -> Self {
        let count = slot_count.saturating_sub(first).min(BUNDLE);
        let slots = std::array::from_fn(|k| {
            let word = |i: usize| shared(&slots[SLOT * (first + k) + i]);
            let none = Slot { receiver: 0, part: 0, depth: NO_VIEW, attenuation: 0 };
            if k < count {
                Slot { receiver: word(0), part: word(1), depth: word(2) as i32, attenuation: word(3) as i32 }
            } else {
                none
            }
        });
        let nobody = Receiver { position: Vec3::ZERO, triangle: NO_TRIANGLE, normal: Vec3::ZERO, kind: RECEIVER_POINT };
        let looks = |slot: &Slot| slot.depth != NO_VIEW;
        let (mut looking, mut here) = (0, [nobody; BUNDLE]);
        // A loop: `map` over an array of this size is a call that moves it about in memory.
        for (k, slot) in slots.iter().enumerate().filter(|(_, slot)| looks(slot)) {
            here[k] = receivers[slot.receiver as usize];
            looking |= 1 << k;
        }
        Self { receivers: here, slots, looking }
    }

    /// The lanes of a part of the tile.
    #[inline(always)]
    pub(super) fn members(&self, part: u32) -> u32 {
        let here: u32 = self.slots.iter().enumerate().map(|(k, slot)| u32::from(slot.part == part) << k).sum();
        here & self.looking
    }

    #[inline(always)]
    pub(super) fn positions<S: Simd>(&self, simd: S) -> Vec3x8<S> {
        Vec3x8::from_fn(simd, |k| self.receivers[k].position)
    }

    #[inline(always)]
    pub(super) fn triangles<S: Simd>(&self, simd: S) -> u32x8<S> {
        use fearless_simd::prelude::*;
        u32x8::from_fn(simd, |k| self.receivers[k].triangle)
    }
}

/// The entries of a list whose chunks begin at `first_chunk`.
#[inline(always)]
pub(super) fn entries(chunks: &[u32], first: u32) -> impl Iterator<Item = u32> + '_ {
    let mut chunk = first as usize;
    let next = move || {
        if chunk == 0 {
            return None;
        }
        let here = &chunks[chunk * CHUNK..][..CHUNK];
        chunk = here[0] as usize;
        Some(&here[2..2 + here[1] as usize])
    };
    std::iter::from_fn(next).flatten().copied()
}

/// The samples of a mask, from the first on.
#[inline(always)]
pub(super) fn samples_of(mask: u64) -> impl Iterator<Item = usize> {
    let mut rest = mask;
    std::iter::from_fn(move || {
        let sample = rest.trailing_zeros() as usize;
        (rest != 0).then(|| {
            rest &= rest - 1;
            sample
        })
    })
}

/// The lanes of a mask, from the first on.
#[inline(always)]
pub(super) fn lanes_of(mask: u32) -> impl Iterator<Item = usize> {
    let mut rest = mask;
    std::iter::from_fn(move || {
        let lane = rest.trailing_zeros() as usize;
        (rest != 0).then(|| {
            rest &= rest - 1;
            lane
        })
    })
}
