//! The shafts between the receivers of each bundle that belong to a part, and the light or its reference point.

use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

use super::super::clusters::ClusterRange;
use super::super::frame::LightFrame;
use super::super::positions::Positions;
use super::super::shaft::{Reach, Shafts, Target};
use super::super::tiles::{BUNDLE, BUNDLES, Slot, TILE};
use super::entries::Shaft;
use crate::kernels::lanes::Vec3x8;
use crate::kernels::shared::receiver::Receiver;

/// What bundles are bounded by.
pub(super) struct Tiles<'a> {
    pub(super) frame: LightFrame,
    pub(super) range: ClusterRange,
    pub(super) receivers: &'a [Receiver],
    pub(super) slots: &'a [Slot],
}

pub(super) struct Bundle {
    pub(super) shaft: Shaft,
    pub(super) receiver_count: u32,
}

impl Tiles<'_> {
    /// The bundles of a part.
    #[inline(always)]
    pub(super) fn bundles<S: Simd>(&self, simd: S, part: usize, target: Target) -> [Bundle; BUNDLES] {
        let first = part / 2 * TILE;
        let end = (self.range.receiver_count as usize).min(first + TILE);
        let positions = Positions::new(simd, &self.slots[first..end], self.receivers);
        let mut low = Vec3x8::splat(simd, Vec3::splat(1e30));
        let mut high = Vec3x8::splat(simd, Vec3::splat(-1e30));
        let mut counts = [0; BUNDLES];
        for (k, p) in positions.at.iter().enumerate() {
            let here = positions.is_in(k, part as u32 & 1);
            low = Vec3x8::select(here, low.min(*p), low);
            high = Vec3x8::select(here, high.max(*p), high);
            let bits = here.to_bitmask();
            for (lane, count) in counts.iter_mut().enumerate() {
                *count += (bits >> lane) as u32 & 1;
            }
        }
        let share = f32x8::splat(simd, 0.5);
        let (middle, half) = ((low + high).scale(share), (high - low).scale(share));
        let shafts = Shafts::new(simd, &self.frame, target, middle);
        let mut reach = Reach::none(simd);
        for k in 0..BUNDLE {
            shafts.reach_with(simd, &mut reach, positions.at[k], positions.is_in(k, part as u32 & 1));
        }
        let planes = shafts.planes(simd, &reach, low.abs().max(high.abs()));
        std::array::from_fn(|lane| Bundle {
            shaft: Shaft { planes: planes[lane], middle: middle.lane(lane), half: half.lane(lane) },
            receiver_count: counts[lane],
        })
    }
}
