//! The twin of `occlusion_layers/look_up.wgsl`. The rays of a run are the lanes of a vector.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use glam::{UVec4, Vec2, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::kernel::{
    COMBINE_MAXIMUM, COMBINE_SUM, LayerView, LightParts, horizon_share, kernel_box, layer_view, way_to,
};
use super::layers::{LayerFrame, LayerPlaces};
use super::levels::{FILTER_NBUFFER, FILTER_SUMMED_AREA, Level, MOST_LEVELS, levels, unpack};
use crate::engine::{Call, atomic_words};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::hierarchy::{BvhNode, box_pad, eight_reciprocals};
use crate::kernels::shared::light::{Light, light_view};
use crate::kernels::shared::receiver::{RECEIVER_NONE, Receiver};
use crate::kernels::shared::triangle::{Corner, triangle_blocks};
use crate::kernels::{RUN, records};

/// Longer than any way through a scene, whose coordinates lie in [−1, 1].
const ACROSS: f32 = 4.0;

struct Layers<'a> {
    light: Light,
    frame: LayerFrame,
    parts: LightParts,
    places: LayerPlaces,
    levels: [Level; MOST_LEVELS],
    tables: &'a [u32],
}

/// Slices before a receiver, and the weight of the last of them.
#[derive(Clone, Copy)]
struct SlicesBefore {
    count: u32,
    last_weight: f32,
    is_behind_all: bool,
}

impl Layers<'_> {
    /// Share of the box that the slice hides: the exact mean of its texels, nothing being outside of them.
    fn exact_share(&self, layer: u32, [begin, end]: [Vec2; 2]) -> f32 {
        let resolution = self.places.window.resolution;
        let stride = resolution as usize + 1;
        let (size, most) = (Vec2::splat(resolution as f32), Vec2::splat(resolution as f32 - 1.0));
        let [low, high] = [begin, end].map(|corner| corner.clamp(Vec2::ZERO, size));
        let [low_texel, high_texel] = [low, high].map(|corner| corner.floor().min(most));
        let (low_share, high_share) = (low - low_texel, high - high_texel);
        let [c0, c1] = [low_texel, high_texel].map(|texel| texel.as_uvec2());
        let base = layer as usize * stride * stride;
        let row = |row: u32| {
            let sums = &self.tables[base + row as usize * stride..][..stride];
            let [x0, x1] = [c0.x, c1.x].map(|x| x as usize);
            UVec4::new(sums[x0], sums[x0 + 1], sums[x1], sums[x1 + 1])
        };
        let [r0, r1, r2, r3] = [c0.y, c0.y + 1, c1.y, c1.y + 1].map(row);
        // Between one column and the next, over the rows: the middle is negative where both ends lie in one texel.
        let weights = Vec3::new(1.0 - low_share.x, 1.0, high_share.x);
        let [top, middle, bottom] = [(r0, r1), (r1, r2), (r2, r3)].map(|(above, below)| row_cells(below, above));
        let sum = (1.0 - low_share.y) * weights.dot(top) + weights.dot(middle) + high_share.y * weights.dot(bottom);
        let size = end - begin;
        (sum / (size.x * size.y)).clamp(0.0, 1.0)
    }

    /// The mean over the 2^level texels around a place, between the four entries next to it.
    fn level_mean(&self, layer: u32, level: u32, middle: Vec2) -> f32 {
        let Level { begin, side } = self.levels[level as usize];
        let entries = &self.tables[begin + layer as usize / 4 * side * side..][..side * side];
        let size = (1_u32 << level) as f32;
        let is_nbuffer = self.frame.filter_kind == FILTER_NBUFFER;
        let place = if is_nbuffer { middle + 0.5 * size - 1.0 } else { middle / size - 0.5 };
        let bounded = place.clamp(Vec2::splat(-2.0), Vec2::splat(side as f32 + 1.0));
        let low = bounded.floor();
        let share = bounded - low;
        let inside = |at: i32| usize::try_from(at).ok().filter(|at| *at < side);
        let mut sum = 0.0;
        for (row, row_weight) in [1.0 - share.y, share.y].into_iter().enumerate() {
            for (column, column_weight) in [1.0 - share.x, share.x].into_iter().enumerate() {
                let [x, y] = [low.x as i32 + column as i32, low.y as i32 + row as i32].map(inside);
                if let (Some(x), Some(y)) = (x, y) {
                    sum += unpack(entries[y * side + x])[layer as usize % 4] * column_weight * row_weight;
                }
            }
        }
        sum
    }

    /// As published: between the two levels next to the kernel's size. A kernel larger than all texels has what lies in all of them.
    fn level_share(&self, layer: u32, [begin, end]: [Vec2; 2]) -> f32 {
        let size = end - begin;
        let wanted = (0.5 * (size.x * size.y).log2()).max(0.0);
        let last = self.places.window.resolution.ilog2();
        let level = (wanted as u32).min(last - 1);
        let middle = (begin + end) * 0.5;
        let share = (wanted - level as f32).clamp(0.0, 1.0);
        let [finer, coarser] = [level, level + 1].map(|level| self.level_mean(layer, level, middle));
        let mean = finer * (1.0 - share) + coarser * share;
        mean * (-2.0 * (wanted - last as f32).max(0.0)).exp2()
    }

    fn hidden_share(&self, layer: u32, corners: [Vec2; 2]) -> f32 {
        if self.frame.filter_kind == FILTER_SUMMED_AREA {
            self.exact_share(layer, corners)
        } else {
            self.level_share(layer, corners)
        }
    }

    fn slices_before(&self, depth: f32) -> SlicesBefore {
        let (slices, planes) = (self.places.window.slices, &self.places.planes);
        let low = self.places.slices_before(depth);
        let mut before = SlicesBefore { count: low, last_weight: 1.0, is_behind_all: false };
        if slices > 0 {
            let last = planes[slices as usize - 1];
            // A hair before the last plane is behind it, where a receiver was lifted off what touches the casters.
            if depth >= last - 1e-5 * (1.0 + last.abs()) {
                (before.count, before.is_behind_all) = (slices, true);
            } else if low > 0 {
                let [plane, next] = [planes[low as usize - 1], planes[low as usize]];
                before.last_weight = ((depth - plane) / (next - plane).max(1e-30)).clamp(0.0, 1.0);
            }
        }
        before
    }

    /// As above where rays find what is near. They pass the receiver's own slice and the one before it, whose casters were moved next to
    /// the receiver, where the surface that it stands on goes on.
    fn slices_beyond_rays(&self, depth: f32) -> SlicesBefore {
        let mut before = self.slices_before(depth);
        before.last_weight = 1.0;
        if !before.is_behind_all {
            before.count = before.count.saturating_sub(1);
        }
        before
    }

    /// The slices that hide any of the light at all, a bit each; nothing where all of it is hidden.
    fn hiding_slices(&self, view: &LayerView, before: SlicesBefore) -> Option<u128> {
        let mut hiding = 0;
        for layer in 0..before.count {
            let depth = self.places.planes[layer as usize];
            let [low, high] = kernel_box(view, &self.places.window, self.parts.whole, depth);
            let share = self.hidden_share(layer, [low - Vec2::ONE, high + Vec2::ONE]);
            if share > 0.999_999 && (layer + 1 < before.count || before.last_weight >= 1.0) {
                return None;
            }
            hiding |= u128::from(share > 0.0) << layer;
        }
        Some(hiding)
    }

    /// What a part of the light shows past all slices that hide any of it.
    fn visible_share(&self, view: &LayerView, before: SlicesBefore, part: Vec4, slices: u128) -> f32 {
        let (mut visible, mut left) = (1.0, slices);
        while left != 0 {
            let layer = left.trailing_zeros();
            left &= left - 1;
            let corners = kernel_box(view, &self.places.window, part, self.places.planes[layer as usize]);
            let weight = if layer + 1 == before.count { before.last_weight } else { 1.0 };
            visible = self.combined(visible, weight * self.hidden_share(layer, corners));
        }
        visible.max(0.0)
    }

    /// Hidden shares put together, from 0 hidden on: what is visible so far.
    fn combined(&self, before: f32, share: f32) -> f32 {
        match self.parts.combine {
            COMBINE_MAXIMUM => before.min(1.0 - share),
            COMBINE_SUM => before - share,
            _ => before * (1.0 - share),
        }
    }

    /// What a receiver sees of the light, where `blocked` says which parts are hidden before the first slice.
    fn values(&self, receiver: &Receiver, blocked: Option<u64>) -> Vec3 {
        let seen = light_view(&self.light, receiver.position);
        if receiver.kind == RECEIVER_NONE || !seen.exists || seen.inside {
            return Vec3::splat(if seen.inside { 1.0 } else { 0.0 });
        }
        let view = layer_view(&self.frame, self.places.window.inverse_distance, receiver.position);
        let before = match blocked {
            Some(_) => self.slices_beyond_rays(view.at.z),
            None => self.slices_before(view.at.z),
        };
        let mut values = Vec3::ZERO;
        if let Some(hiding) = self.hiding_slices(&view, before) {
            for (k, (part, weight)) in self.parts.boxes().iter().zip(self.parts.weights()).enumerate() {
                let is_blocked = blocked.unwrap_or(0) >> k & 1 != 0;
                let above = if is_blocked { 0.0 } else { horizon_share(&self.frame, receiver, &view, *part) };
                let asked = if above > 0.0 { hiding } else { 0 };
                values += weight.xyz() * (above * self.visible_share(&view, before, *part, asked));
            }
        }
        values.clamp(Vec3::ZERO, Vec3::ONE)
    }
}

/// Differences from one column to the next of the sums between two rows.
fn row_cells(below: UVec4, above: UVec4) -> Vec3 {
    let sums = UVec4::from_array(std::array::from_fn(|k| below[k].wrapping_sub(above[k])));
    Vec3::new(
        sums.y.wrapping_sub(sums.x).cast_signed() as f32,
        sums.z.wrapping_sub(sums.y).cast_signed() as f32,
        sums.w.wrapping_sub(sums.z).cast_signed() as f32,
    )
}

pub(super) fn look_up(call: &mut Call) {
    answer(call, None);
}

/// As `look_up`, where short rays say what hides the light before the first slice.
pub(super) fn look_up_beyond(call: &mut Call) {
    let [blocked] = call.buffers(["near_blocked"]);
    let blocked = blocked.to_vec();
    answer(call, Some(&blocked));
}

fn answer(call: &mut Call, blocked: Option<&[u32]>) {
    let items = call.item_range();
    let (light, frame, parts) = (call.uniform("light"), call.uniform("layer_frame"), call.uniform("light_parts"));
    let [receivers, places, tables, visibility] =
        call.buffers(["receivers", "layer_places", "layer_tables", "visibility"]);
    let (places, levels) = (records::<LayerPlaces>(places)[0], levels(&frame));
    let layers = Layers { light, frame, parts, places, levels, tables };
    let channels = layers.parts.channels as usize;
    let receivers = &records::<Receiver>(receivers)[items.clone()];
    let visibility = &mut visibility[items.start * channels..items.end * channels];
    let runs = receivers.par_chunks(RUN).zip(visibility.par_chunks_mut(RUN * channels)).enumerate();
    runs.for_each(|(run, (receivers, visibility))| {
        for (at, (receiver, words)) in receivers.iter().zip(visibility.chunks_exact_mut(channels)).enumerate() {
            let index = items.start + run * RUN + at;
            let near = blocked.map(|words| u64::from(words[2 * index]) | u64::from(words[2 * index + 1]) << 32);
            let values = layers.values(receiver, near);
            words.iter_mut().zip(values.to_array()).for_each(|(word, value)| *word = value.to_bits());
        }
    });
}

struct Near<'a> {
    layers: Layers<'a>,
    nodes: &'a [BvhNode],
    triangles: &'a [[Corner; 3]],
}

pub(super) fn trace_near(call: &mut Call) {
    let (items, level) = (call.items.clone(), call.level);
    let (light, frame, parts) = (call.uniform("light"), call.uniform("layer_frame"), call.uniform("light_parts"));
    let names = ["receivers", "layer_places", "nodes", "corners", "near_blocked", "near_counts"];
    let [receivers, places, nodes, corners, blocked, counts] = call.buffers(names);
    let (places, levels) = (records::<LayerPlaces>(places)[0], levels(&frame));
    let layers = Layers { light, frame, parts, places, levels, tables: &[] };
    let near = Near { layers, nodes: records(nodes), triangles: records(corners) };
    let receivers = records::<Receiver>(receivers);
    let (blocked, counts) = (atomic_words(blocked), atomic_words(counts));
    let runs = near.layers.parts.boxes().len().div_ceil(LANES);
    items.into_par_iter().with_min_len(64).for_each(|item| {
        let (index, run) = (item as usize / runs, item as usize % runs);
        dispatch!(level, simd => trace_run(simd, &near, &receivers[index], run * LANES, &blocked[2 * index..][..2], &counts[0]));
    });
}

#[inline(always)]
fn trace_run<S: Simd>(
    simd: S,
    near: &Near<'_>,
    receiver: &Receiver,
    first: usize,
    blocked: &[AtomicU32],
    count: &AtomicU32,
) {
    let layers = &near.layers;
    let seen = light_view(&layers.light, receiver.position);
    let window = &layers.places.window;
    let view = layer_view(&layers.frame, window.inverse_distance, receiver.position);
    let before = layers.slices_beyond_rays(view.at.z);
    let is_asked = receiver.kind != RECEIVER_NONE && seen.exists && !seen.inside;
    if !is_asked || before.is_behind_all || window.slices == 0 {
        return;
    }
    // The share of the way to the light at which the slices begin.
    let mut share = if view.is_sun { ACROSS } else { 1.0 };
    if before.count > 0 {
        let projected_depth = layers.places.planes[before.count as usize - 1];
        let depth = projected_depth / (1.0 - projected_depth * window.inverse_distance);
        let own = layers.frame.row_z.dot(receiver.position - layers.frame.origin);
        share = if view.is_sun { own - depth } else { (own - depth) / own.max(1e-30) };
    }
    let boxes = layers.parts.boxes();
    let boxes = &boxes[first..boxes.len().min(first + LANES)];
    let (mut ways, mut asked) = ([Vec3::X; LANES], 0_u64);
    for (k, part) in boxes.iter().enumerate() {
        ways[k] = way_to(&layers.frame, receiver, &view, part.xy()) * share;
        asked |= u64::from(horizon_share(&layers.frame, receiver, &view, *part) > 0.0) << k;
    }
    let ways = Vec3x8::from_fn(simd, |k| ways[k]);
    let hit = any_near(simd, near, receiver, ways, mask32x8::from_bitmask(simd, asked));
    count.fetch_add(1, Relaxed);
    if hit != 0 {
        blocked[first / 32].fetch_or((hit as u32) << (first % 32), Relaxed);
    }
}

/// Which of eight short rays meet a triangle.
#[inline(always)]
fn any_near<S: Simd>(simd: S, near: &Near<'_>, receiver: &Receiver, ways: Vec3x8<S>, asked: mask32x8<S>) -> u64 {
    let splat = |x: f32| f32x8::splat(simd, x);
    let inverse = eight_reciprocals(simd, ways);
    let (from, pad) = (receiver.position, Vec3::splat(box_pad(receiver.position)));
    let (to_low, to_high) = (Vec3x8::splat(simd, -from - pad) * inverse, Vec3x8::splat(simd, -from + pad) * inverse);
    let mut open = asked;
    let mut node = 0;
    while node < near.nodes.len() && open.any_true() {
        let here = &near.nodes[node];
        let low = Vec3x8::splat(simd, here.low) * inverse + to_low;
        let high = Vec3x8::splat(simd, here.high) * inverse + to_high;
        let (first, last) = (low.min(high), low.max(high));
        let enter = first.x.max(first.y).max(first.z.max(splat(0.0)));
        let leave = last.x.min(last.y).min(last.z.min(splat(1.0)));
        let met = (enter.simd_le(leave) & open).any_true();
        if met {
            for triangle in &near.triangles[here.triangles()] {
                if triangle[0].triangle != receiver.triangle {
                    let corners = triangle.map(|corner| corner.position);
                    open &= !triangle_blocks(simd, corners, from, ways, false);
                }
            }
        }
        node = if met && here.leaf == 0 { node + 1 } else { here.skip as usize };
    }
    (asked & !open).to_bitmask() & u64::from(u8::MAX)
}
