//! Folds where some faces are semi-opaque. Samples answer: an area under a layer that lets light through is no visibility.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Simd, dispatch, i32x8, prelude::*};

use super::super::attenuation::{Attenuated, AttenuationScale, LARGEST_ATTENUATION, OPAQUE};
use super::super::counters::LARGEST_COUNT;
use super::super::coverage::Crossing;
use super::super::lists::lanes_of;
use super::super::occluders::OccluderEdge;
use super::super::sums::Sums;
use super::super::tiles::count;
use super::own::{Own, Sets};
use super::standing::Standing;
use super::{Eight, GROUP, Samples, Stock};
use crate::engine::{Call, atomic_words};
use crate::kernels::lanes::LANES;

/// What is known of semi-opaque faces, and where what passes goes.
struct Passing<'a> {
    scale: AttenuationScale,
    triangles: &'a [u32],
    transmittance: &'a [AtomicU32],
}

const NAMES: [&str; 8] = [
    "receivers",
    "edges",
    "incident_faces",
    "slots",
    "lists",
    "counts",
    "triangle_attenuation",
    "sample_transmittance",
];

pub(in super::super) fn fold_attenuated(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let scale = call.uniform("attenuation_scale");
    let [a, b, c, d, e, f, triangles, transmittance, samples, table] =
        call.buffers(with(["group_samples", "coverage_table"]));
    let (stock, samples) = (Stock::new(frame, settings, [a, b, c, d, e, f]), Standing::new(samples, table));
    let passing = Passing { scale, triangles, transmittance: atomic_words(transmittance) };
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, &passing, |_| &samples));
    });
}

pub(in super::super) fn fold_attenuated_own_samples(call: &mut Call) {
    let (level, frame, settings) = (call.level, call.uniform("light_frame"), call.uniform("fold_settings"));
    let (scale, sampling) = (call.uniform("attenuation_scale"), call.uniform("sampling"));
    let [a, b, c, d, e, f, triangles, transmittance, sets] = call.buffers(with(["sample_sets"]));
    let stock = Stock::new(frame, settings, [a, b, c, d, e, f]);
    let sets = Sets::new(sampling, sets, &stock);
    let passing = Passing { scale, triangles, transmittance: atomic_words(transmittance) };
    stock.for_parts(|head| {
        dispatch!(level, simd => fold_part(simd, &stock, head, &passing, #[inline(always)] |eight| Own::new(simd, &sets, &stock, eight)));
    });
}

/// The names of the bindings of both folds, and further ones.
fn with<const N: usize, const M: usize>(further: [&'static str; N]) -> [&'static str; M] {
    std::array::from_fn(|k| if k < NAMES.len() { NAMES[k] } else { further[k - NAMES.len()] })
}

#[inline(always)]
fn fold_part<S: Simd, T: Samples<S>>(
    simd: S,
    stock: &Stock<'_>,
    head: &[u32],
    passing: &Passing<'_>,
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
            let mut attenuated = eight.bundle.slots.map(|slot| Attenuated::begin(slot.attenuation));
            stock.edges(
                simd,
                eight,
                list,
                #[inline(always)]
                |_, edge, image, matters| {
                    let [opaque, units] = weight_of_both(simd, stock, eight, passing.triangles, edge);
                    let crossing = Crossing::of(simd, image);
                    samples.crossed(
                        simd,
                        &crossing,
                        matters.to_bitmask() as u32,
                        #[inline(always)]
                        |k, mask| {
                            let sign = if image.left.test(k) { -1 } else { 1 };
                            sums[k].with_layers(opaque.as_slice()[k] * sign, mask);
                            attenuated[k].add(units.as_slice()[k].wrapping_mul(sign), edge.face_count(), mask);
                        },
                    );
                },
            );
            finish(simd, stock, eight, &samples, passing, &sums, &attenuated);
        },
    );
}

/// Layers left of the edge minus those right of it: opaque ones, and in units of attenuation.
#[inline(always)]
fn weight_of_both<S: Simd>(
    simd: S,
    stock: &Stock<'_>,
    eight: &Eight<S>,
    triangles: &[u32],
    edge: &OccluderEdge,
) -> [i32x8<S>; 2] {
    let [mut opaque, mut attenuation] = [i32x8::splat(simd, 0); 2];
    for face in stock.faces_at(edge) {
        let left = eight.left_of(simd, &stock.frame, face);
        match triangles[(face.reference >> 1) as usize] {
            OPAQUE => opaque += left,
            units => attenuation += left * i32x8::splat(simd, units as i32),
        }
    }
    [opaque, attenuation]
}

#[inline(always)]
fn finish<S: Simd>(
    simd: S,
    stock: &Stock<'_>,
    eight: &Eight<S>,
    samples: &impl Samples<S>,
    passing: &Passing<'_>,
    sums: &[Sums; LANES],
    attenuated: &[Attenuated; LANES],
) {
    for k in lanes_of(eight.member_bits) {
        let below = if eight.is_above(k) { 0 } else { samples.below(simd, eight.slope, k) };
        let hidden = sums[k].counters.nonzero() | below;
        let at = eight.bundle.slots[k].receiver * stock.frame.sample_count + GROUP * stock.settings.group;
        let samples = &passing.transmittance[at as usize..][..stock.count() as usize];
        for (sample, target) in samples.iter().enumerate() {
            let is_hidden = hidden >> sample & 1 != 0;
            let passes = if is_hidden { 0.0 } else { passing.scale.passed(attenuated[k].of_sample(sample)) };
            target.store(passes.to_bits(), Ordering::Relaxed);
        }
        let overflows = attenuated[k].most > LARGEST_ATTENUATION;
        let unfinished = sums[k].changes > LARGEST_COUNT;
        for (at, found) in [(count::OVERFLOWED, overflows), (count::UNFINISHED, unfinished)] {
            if found {
                stock.counts[at].fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}
