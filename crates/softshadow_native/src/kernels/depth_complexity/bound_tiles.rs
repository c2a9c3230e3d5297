//! The twin of `depth_complexity/bound_tiles.wgsl`.

use fearless_simd::{Simd, dispatch, mask32x8, prelude::*};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::clusters::ClusterRange;
use super::frame::LightFrame;
use super::positions::Positions;
use super::shaft::{Planes, Reach, Shafts};
use super::tiles::{BUNDLE, Slot, TILE, TilePart};
use crate::engine::Call;
use crate::kernels::lanes::Vec3x8;
use crate::kernels::shared::receiver::Receiver;
use crate::kernels::{records, records_mut};

/// Tiles that a thread takes at once.
const TILES: usize = 16;

/// A part is split when its halves are smaller than this share of it; flat halves are 0.8 of the whole.
const SPLIT_BELOW: f32 = 0.6;

pub(super) fn bound_tiles(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (frame, range): (LightFrame, ClusterRange) = (call.uniform("light_frame"), call.uniform("cluster_range"));
    let [receivers, slots, parts] = call.buffers(["receivers", "slots", "parts"]);
    let receivers = records::<Receiver>(receivers);
    let slots = &mut records_mut::<Slot>(slots)[..range.receiver_count as usize][items.start * TILE..];
    let parts = &mut records_mut::<TilePart>(parts)[2 * items.start..2 * items.end];
    slots.par_chunks_mut(TILES * TILE).zip(parts.par_chunks_mut(TILES * 2)).for_each(|(slots, parts)| {
        dispatch!(level, simd => {
            for (slots, parts) in slots.chunks_mut(TILE).zip(parts.chunks_mut(2)) {
                bound_tile(simd, &frame, receivers, slots, parts);
            }
        });
    });
}

/// Where a tile is cut: receivers beyond `middle` on `axis` are in the second part.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    middle: f32,
}

#[derive(Clone, Copy)]
struct Box {
    low: Vec3,
    high: Vec3,
    count: u32,
}

const NOTHING: Box = Box { low: Vec3::splat(1e30), high: Vec3::splat(-1e30), count: 0 };

impl Box {
    fn size(&self) -> Vec3 {
        self.high - self.low
    }
}

/// Who is in which part of the tile; without a split everyone is in the first.
#[inline(always)]
fn members<S: Simd>(positions: &Positions<S>, split: Option<Split>, part: u32, k: usize) -> mask32x8<S> {
    let Some(Split { axis, middle }) = split else { return positions.sees(k) };
    let p = positions.at[k];
    let is_beyond = [p.x, p.y, p.z][axis].simd_gt(middle);
    positions.sees(k) & if part == 1 { is_beyond } else { !is_beyond }
}

#[inline(always)]
fn around<S: Simd>(simd: S, positions: &Positions<S>, split: Option<Split>, part: u32) -> Box {
    let mut low = Vec3x8::splat(simd, NOTHING.low);
    let mut high = Vec3x8::splat(simd, NOTHING.high);
    let mut count = 0;
    for (k, p) in positions.at.iter().enumerate() {
        let counts = members(positions, split, part, k);
        low = Vec3x8::select(counts, low.min(*p), low);
        high = Vec3x8::select(counts, high.max(*p), high);
        count += counts.to_bitmask().count_ones();
    }
    Box { low: low.reduce_min(), high: high.reduce_max(), count }
}

#[inline(always)]
fn shaft<S: Simd>(
    simd: S,
    frame: &LightFrame,
    positions: &Positions<S>,
    bounds: &Box,
    split: Option<Split>,
    part: u32,
) -> Planes {
    let center = (bounds.low + bounds.high) * 0.5;
    let shafts = Shafts::new(simd, frame, frame.whole_light(), Vec3x8::splat(simd, center));
    let mut reach = Reach::none(simd);
    for k in 0..BUNDLE {
        shafts.reach_with(simd, &mut reach, positions.at[k], members(positions, split, part, k));
    }
    let extent = Vec3x8::splat(simd, bounds.low.abs().max(bounds.high.abs()));
    shafts.planes(simd, &reach.reduced(simd), extent)[0]
}

#[inline(always)]
fn bound_tile<S: Simd>(
    simd: S,
    frame: &LightFrame,
    receivers: &[Receiver],
    slots: &mut [Slot],
    parts: &mut [TilePart],
) {
    let positions = Positions::new(simd, slots, receivers);
    let whole = around(simd, &positions, None, 0);
    let size = whole.size();
    let axis = match size {
        Vec3 { x, y, z } if x > y.max(z) => 0,
        Vec3 { y, z, .. } if y > z => 1,
        _ => 2,
    };
    let mut split = Some(Split { axis, middle: (whole.low[axis] + whole.high[axis]) * 0.5 });
    let mut halves = [around(simd, &positions, split, 0), around(simd, &positions, split, 1)];
    let larger = halves[0].size().length().max(halves[1].size().length());
    if halves[0].count == 0 || halves[1].count == 0 || larger > SPLIT_BELOW * size.length() {
        split = None;
        halves = [whole, NOTHING];
    }
    for slot in slots.iter_mut() {
        let is_beyond = |s: Split| receivers[slot.receiver as usize].position[s.axis] > s.middle;
        slot.part = u32::from(split.is_some_and(is_beyond));
    }
    for (part, bounded) in parts.iter_mut().enumerate() {
        let half = &halves[part];
        let planes =
            if half.count > 0 { shaft(simd, frame, &positions, half, split, part as u32) } else { [Vec4::ZERO; 5] };
        *bounded = TilePart { planes, low: half.low, receiver_count: half.count, high: half.high, has_faces: 0 };
    }
}
