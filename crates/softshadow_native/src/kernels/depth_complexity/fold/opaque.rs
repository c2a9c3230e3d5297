//! Folds where all faces are opaque.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Simd, dispatch, i32x8, prelude::*};
use glam::Vec2;

use super::super::area::{Beyond, Outline};
use super::super::counters::LARGEST_COUNT;
use super::super::coverage::Crossing;
use super::super::lists::lanes_of;
use super::super::occluders::OccluderEdge;
use super::super::sums::{AREA_UNITS, Sums, existing, signed_area};
use super::super::tiles::{count, listed_weight};
use super::own::{Own, Sets};
use super::standing::Standing;
use super::{Eight, Samples, Stock};
use crate::engine::{Call, atomic_words};
use crate::kernels::lanes::LANES;

/// Layers of which areas are believed: far below where counters or sums of areas wrap.
const MOST_AREA_LAYERS: u32 = 127;

/// Marks an area that answers; the other bits are its float.
const AREA_ANSWERS: u32 = 0x8000_0000;

/// What areas are found with, and where they go.
struct Areas<'a> {
    outline: Outline,
    areas: &'a [AtomicU32],
}

const NAMES: [&str; 7] = ["receivers", "edges", "incident_faces", "slots", "lists", "counts", "blocked"];

pub(in super::super) fn fold(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let [a, b, c, d, e, f, blocked, samples, table] = call.buffers(with(["group_samples", "coverage_table"]));
    let (stock, samples) = (Stock::new(frame, settings, [a, b, c, d, e, f]), Standing::new(samples, table));
    let blocked = atomic_words(blocked);
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, blocked, None, |_| &samples));
    });
}

pub(in super::super) fn fold_areas(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let names = with(["group_samples", "coverage_table", "areas", "outline"]);
    let [a, b, c, d, e, f, blocked, samples, table, areas, outline] = call.buffers(names);
    let (stock, samples) = (Stock::new(frame, settings, [a, b, c, d, e, f]), Standing::new(samples, table));
    let (blocked, areas) = (atomic_words(blocked), Areas::new(&stock, outline, areas));
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, blocked, Some(&areas), |_| &samples));
    });
}

pub(in super::super) fn fold_own_samples(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let sampling = call.uniform("sampling");
    let [a, b, c, d, e, f, blocked, sets] = call.buffers(with(["sample_sets"]));
    let stock = Stock::new(frame, settings, [a, b, c, d, e, f]);
    let (blocked, sets) = (atomic_words(blocked), Sets::new(sampling, sets, &stock));
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, blocked, None, #[inline(always)] |eight| Own::new(simd, &sets, &stock, eight)));
    });
}

pub(in super::super) fn fold_own_samples_areas(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let sampling = call.uniform("sampling");
    let [a, b, c, d, e, f, blocked, sets, areas, outline] = call.buffers(with(["sample_sets", "areas", "outline"]));
    let stock = Stock::new(frame, settings, [a, b, c, d, e, f]);
    let (blocked, areas) = (atomic_words(blocked), Areas::new(&stock, outline, areas));
    let sets = Sets::new(sampling, sets, &stock);
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, blocked, Some(&areas), #[inline(always)] |eight| Own::new(simd, &sets, &stock, eight)));
    });
}

/// The names of the bindings of all folds, and further ones.
fn with<const N: usize, const M: usize>(further: [&'static str; N]) -> [&'static str; M] {
    std::array::from_fn(|k| if k < NAMES.len() { NAMES[k] } else { further[k - NAMES.len()] })
}

impl<'a> Areas<'a> {
    fn new(stock: &Stock<'_>, outline: &[u32], areas: &'a mut [u32]) -> Self {
        let corner = |words: &[u32]| Vec2::new(f32::from_bits(words[0]), f32::from_bits(words[1]));
        let corners = stock.frame.outline_count as usize;
        let outline = match corners {
            0 => Outline::Disc(-stock.frame.reference),
            _ => Outline::polygon(outline.chunks_exact(4).take(corners).map(corner).collect()),
        };
        Self { outline, areas: atomic_words(areas) }
    }
}

#[inline(always)]
fn fold_part<S: Simd, T: Samples<S>>(
    simd: S,
    stock: &Stock<'_>,
    head: &[u32],
    blocked: &[AtomicU32],
    areas: Option<&Areas<'_>>,
    samples: impl Fn(&Eight<S>) -> T,
) {
    stock.bundles(
        simd,
        head,
        #[inline(always)]
        |eight, list| {
            let samples = samples(eight);
            let mut sums = [Sums::begin(0); LANES];
            sums.iter_mut().zip(&eight.bundle.slots).for_each(|(sums, slot)| *sums = Sums::begin(slot.depth));
            let mut area = i32x8::splat(simd, 0);
            stock.edges(
                simd,
                eight,
                list,
                #[inline(always)]
                |entry, edge, image, matters| {
                    let listed = listed_weight(entry);
                    let weights =
                        if listed == 0 { weight(simd, stock, eight, edge) } else { i32x8::splat(simd, listed) };
                    let changes = matters & weights.simd_ne(0);
                    let lanes = changes.to_bitmask() as u32;
                    if lanes == 0 {
                        return;
                    }
                    let crossing = Crossing::of(simd, image);
                    samples.crossed(
                        simd,
                        &crossing,
                        lanes,
                        #[inline(always)]
                        |k, mask| {
                            sums[k].fold(weights.as_slice()[k], image.left.test(k), mask);
                        },
                    );
                    if let Some(Areas { outline, .. }) = areas {
                        let beyond = Beyond::of(image, &crossing).area(simd, outline, changes);
                        let beyond = signed_area(simd, beyond, weights, image.left);
                        area += changes.select(beyond, i32x8::splat(simd, 0));
                    }
                },
            );
            finish(simd, stock, eight, &samples, &sums, blocked, areas.map(|areas| (areas.areas, area.to_array())));
        },
    );
}

/// D left of the edge minus D right of it, for each receiver.
#[inline(always)]
fn weight<S: Simd>(simd: S, stock: &Stock<'_>, eight: &Eight<S>, edge: &OccluderEdge) -> i32x8<S> {
    let mut sum = i32x8::splat(simd, 0);
    for face in stock.faces_at(edge) {
        sum += eight.left_of(simd, &stock.frame, face);
    }
    sum
}

/// What is left to write once all edges are folded.
#[inline(always)]
fn finish<S: Simd>(
    simd: S,
    stock: &Stock<'_>,
    eight: &Eight<S>,
    samples: &impl Samples<S>,
    sums: &[Sums; LANES],
    blocked: &[AtomicU32],
    areas: Option<(&[AtomicU32], [i32; LANES])>,
) {
    let (count, all) = (stock.count(), existing(stock.count()));
    let words = stock.frame.sample_count.div_ceil(32) as usize;
    let (mut unfinished, mut by_area) = (0, 0);
    for k in lanes_of(eight.member_bits) {
        let (slot, sums) = (&eight.bundle.slots[k], &sums[k]);
        let below = if eight.is_above(k) { 0 } else { samples.below(simd, eight.slope, k) };
        let layered = sums.counters.nonzero() & all;
        let mask = layered | (below & all);
        let first = slot.receiver as usize * words + 2 * stock.settings.group as usize;
        blocked[first].store(mask as u32, Ordering::Relaxed);
        if count > 32 {
            blocked[first + 1].store((mask >> 32) as u32, Ordering::Relaxed);
        }
        unfinished += u32::from(sums.changes > LARGEST_COUNT);
        let Some((areas, area)) = &areas else { continue };
        let sampled = 1.0 - layered.count_ones() as f32 / count as f32;
        let visible = visible_area(stock, sums, area[k], slot.depth, layered, sampled);
        if let Some(visible) = visible.filter(|_| eight.is_above(k)) {
            areas[slot.receiver as usize].store(AREA_ANSWERS | visible.to_bits(), Ordering::Relaxed);
            by_area += 1;
        }
    }
    for (at, found) in [(count::UNFINISHED, unfinished), (count::BY_AREA, by_area)] {
        if found != 0 {
            stock.counts[at].fetch_add(found, Ordering::Relaxed);
        }
    }
}

/// The visible share of the area; nothing where samples have to answer.
#[inline(always)]
fn visible_area(stock: &Stock<'_>, sums: &Sums, area: i32, depth: i32, hidden: u64, sampled: f32) -> Option<f32> {
    let layers = if hidden == 0 { sums.smallest } else { sums.counters.single_value(hidden)? };
    if layers == 0 || layers > MOST_AREA_LAYERS || (depth != 0 && depth != layers as i32) {
        return None;
    }
    let whole = stock.frame.area;
    let total = depth as f32 * whole + area as f32 / AREA_UNITS;
    let visible = 1.0 - total / (layers as f32 * whole);
    let believed = (visible - sampled).abs() <= stock.settings.sampling_bound;
    believed.then(|| visible.clamp(0.0, 1.0))
}
