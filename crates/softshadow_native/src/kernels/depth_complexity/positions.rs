//! The receivers of a tile as lanes hold them: a lane is a bundle, and step `k` its receiver `k`. What is bounded bundle by bundle then needs
//! no sum over lanes.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

use super::tiles::{BUNDLE, NO_VIEW, Slot};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::receiver::Receiver;

/// Part of who has no view of the light, or is not there.
const NO_PART: u32 = u32::MAX;

pub(super) struct Positions<S: Simd> {
    pub(super) at: [Vec3x8<S>; BUNDLE],
    part: [u32x8<S>; BUNDLE],
}

impl<S: Simd> Positions<S> {
    /// From the slots of one tile, of which the last may have fewer than others.
    #[inline(always)]
    pub(super) fn new(simd: S, slots: &[Slot], receivers: &[Receiver]) -> Self {
        let mut words = [[[0.0; LANES]; 3]; BUNDLE];
        let mut part = [[NO_PART; LANES]; BUNDLE];
        for (at, slot) in slots.iter().enumerate() {
            let (lane, k) = (at / BUNDLE, at % BUNDLE);
            let p = receivers[slot.receiver as usize].position;
            for (i, row) in words[k].iter_mut().enumerate() {
                row[lane] = p[i];
            }
            part[k][lane] = if slot.depth == NO_VIEW { NO_PART } else { slot.part };
        }
        let nothing = f32x8::splat(simd, 0.0);
        let mut found =
            Self { at: [Vec3x8::new(nothing, nothing, nothing); BUNDLE], part: [u32x8::splat(simd, NO_PART); BUNDLE] };
        for k in 0..BUNDLE {
            let [x, y, z] = words[k];
            found.at[k] =
                Vec3x8::new(f32x8::load_array(simd, x), f32x8::load_array(simd, y), f32x8::load_array(simd, z));
            found.part[k] = u32x8::load_array(simd, part[k]);
        }
        found
    }

    /// Who has a view of the light.
    #[inline(always)]
    pub(super) fn sees(&self, k: usize) -> mask32x8<S> {
        self.part[k].simd_ne(NO_PART)
    }

    /// Who of these belongs to a part.
    #[inline(always)]
    pub(super) fn is_in(&self, k: usize, part: u32) -> mask32x8<S> {
        self.part[k].simd_eq(part)
    }
}
