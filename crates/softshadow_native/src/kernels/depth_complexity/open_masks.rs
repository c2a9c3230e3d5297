//! The twin of `depth_complexity/open_masks.wgsl`: eight receivers at a time.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*, u32x8};
use glam::{Vec2, Vec4};
use rayon::prelude::*;

use super::frame::{FrameView, LightFrame};
use super::horizon::{horizon_slope, is_above_horizon};
use super::sample_sets::of_sets;
use super::tiles::{NO_VIEW, Slot};
use crate::engine::{Call, atomic_words};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::receiver::{RECEIVER_NONE, RECEIVER_SURFACE, Receiver};
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records, records_mut};

/// Where the samples of a receiver stand.
enum Samples<'a> {
    /// One set for all.
    Shared(&'a [Vec4]),
    /// One of several sets.
    Own(&'a [Vec2], Sampling),
}

struct Masks<'a> {
    frame: LightFrame,
    samples: Samples<'a>,
    receivers: &'a [Receiver],
    blocked: &'a [AtomicU32],
}

pub(super) fn open_masks(call: &mut Call) {
    let [samples] = call.buffers(["frame_samples"]);
    let samples = samples.to_vec();
    open(call, Samples::Shared(records(&samples)));
}

/// The same where every receiver has its own set of samples.
pub(super) fn open_masks_of_sets(call: &mut Call) {
    let sampling = call.uniform("sampling");
    let [sets] = call.buffers(["sample_sets"]);
    let sets = sets.to_vec();
    open(call, Samples::Own(of_sets(&sets), sampling));
}

fn open(call: &mut Call, samples: Samples<'_>) {
    let (items, level) = (call.item_range(), call.level);
    let frame = call.uniform("light_frame");
    let [receivers, order, slots, blocked] = call.buffers(["receivers", "order", "slots", "blocked"]);
    let masks = Masks { frame, samples, receivers: records(receivers), blocked: atomic_words(blocked) };
    let slots = &mut records_mut::<Slot>(slots)[items.clone()];
    slots.par_chunks_mut(RUN).zip(order[items].par_chunks(RUN)).for_each(|(slots, order)| {
        dispatch!(level, simd => {
            for (slots, order) in slots.chunks_mut(LANES).zip(order.chunks(LANES)) {
                masks.open_eight(simd, slots, order);
            }
        });
    });
}

impl Masks<'_> {
    #[inline(always)]
    fn open_eight<S: Simd>(&self, simd: S, slots: &mut [Slot], order: &[u32]) {
        let index: [u32; LANES] = std::array::from_fn(|k| order[k.min(order.len() - 1)]);
        let receiver = |k: usize| &self.receivers[index[k] as usize];
        let kind = u32x8::from_fn(simd, |k| receiver(k).kind);
        let view = self.frame.view(simd, Vec3x8::from_fn(simd, |k| receiver(k).position));
        let slope = horizon_slope(&view, Vec3x8::from_fn(simd, |k| receiver(k).normal));
        let is_receiver = kind.simd_ne(RECEIVER_NONE);
        let sees = is_receiver & view.exists;
        let is_open = sees | (is_receiver & view.inside);
        let crosses = sees & kind.simd_eq(RECEIVER_SURFACE) & !is_above_horizon(&self.frame, slope);
        let words = self.frame.sample_count.div_ceil(32);
        let unseen = is_open.select(u32x8::splat(simd, 0), u32x8::splat(simd, u32::MAX));
        let mut visible = [0; LANES];
        for word in 0..words {
            let here = (self.frame.sample_count - 32 * word).min(32);
            let mask = if crosses.any_true() {
                unseen | self.hidden(simd, &view, slope, crosses, &index, word)
            } else {
                unseen
            };
            let mask = mask.to_array();
            for k in 0..order.len() {
                self.blocked[(index[k] * words + word) as usize].store(mask[k], Relaxed);
                visible[k] += here - (mask[k] & (u32::MAX >> (32 - here))).count_ones();
            }
        }
        let sees = sees.to_bitmask();
        for (k, slot) in slots.iter_mut().enumerate() {
            let looks = sees >> k & 1 != 0 && visible[k] > 0;
            *slot = Slot { receiver: index[k], part: 0, depth: if looks { 0 } else { NO_VIEW }, attenuation: 0 };
        }
    }

    /// The samples of one word that lie below the horizon.
    #[inline(always)]
    fn hidden<S: Simd>(
        &self,
        simd: S,
        view: &FrameView<S>,
        slope: Vec3x8<S>,
        crosses: mask32x8<S>,
        index: &[u32; LANES],
        word: u32,
    ) -> u32x8<S> {
        let zero = u32x8::splat(simd, 0);
        let mut mask = zero;
        let first = match &self.samples {
            Samples::Shared(_) => [0; LANES],
            Samples::Own(_, sampling) => index.map(|index| sampling.first_sample(index) as usize),
        };
        for bit in 0..(self.frame.sample_count - 32 * word).min(32) {
            let at = (32 * word + bit) as usize;
            let sample = match &self.samples {
                Samples::Shared(samples) => [samples[at].x, samples[at].y].map(|c| f32x8::splat(simd, c)),
                Samples::Own(sets, _) => {
                    let own = |k: usize| sets[first[k] + at];
                    [f32x8::from_fn(simd, |k| own(k).x), f32x8::from_fn(simd, |k| own(k).y)]
                }
            };
            let [x, y] = self.frame.placed_sample(simd, view, sample);
            let below = (slope.z + slope.x * x + slope.y * y).simd_le(0.0);
            mask |= (crosses & below).select(u32x8::splat(simd, 1 << bit), zero);
        }
        mask
    }
}
