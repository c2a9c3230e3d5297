//! The twin of `ray_traced/begin.wgsl`.

use fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use glam::Vec3;
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::light::{Light, LightView, eight_ways, light_view, light_way_bounds};
use crate::kernels::shared::receiver::{RECEIVER_NONE, RECEIVER_SURFACE, Receiver};
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records};

struct Lit<'a> {
    light: Light,
    sampling: Sampling,
    samples: &'a [[f32; 4]],
}

pub(super) fn begin(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (light, sampling): (Light, Sampling) = (call.uniform("light"), call.uniform("sampling"));
    let names = ["receivers", "light_samples", "blocked", "decided"];
    let [receivers, samples, blocked, decided] = call.buffers(names);
    let lit = Lit { light, sampling, samples: records(samples) };
    let words = sampling.words as usize;
    let receivers = &records::<Receiver>(receivers)[items.clone()];
    let blocked = &mut blocked[items.start * words..items.end * words];
    let decided = &mut decided[items.clone()];
    let runs = receivers.par_chunks(RUN).zip(blocked.par_chunks_mut(RUN * words)).zip(decided.par_chunks_mut(RUN));
    runs.enumerate().for_each(|(run, ((receivers, blocked), decided))| {
        let first = (items.start + run * RUN) as u32;
        dispatch!(level, simd => begin_run(simd, &lit, first, receivers, blocked, decided));
    });
}

#[inline(always)]
fn begin_run<S: Simd>(
    simd: S,
    lit: &Lit<'_>,
    first: u32,
    receivers: &[Receiver],
    blocked: &mut [u32],
    decided: &mut [u32],
) {
    let Lit { light, sampling, samples } = lit;
    let masks = blocked.chunks_mut(sampling.words as usize);
    for (at, ((receiver, mask), decided)) in receivers.iter().zip(masks).zip(decided).enumerate() {
        let view = light_view(light, receiver.position);
        let hidden = receiver.kind == RECEIVER_NONE || !view.exists;
        mask.fill(if hidden { u32::MAX } else { 0 });
        // A receiver without light needs no ray; inside a sphere light nothing lies between.
        *decided = if hidden || view.inside { 0 } else { sampling.probes };
        let below = !hidden && !view.inside && receiver.kind == RECEIVER_SURFACE;
        if below && !all_above(light, &view, receiver) {
            let own = sampling.first_sample(first + at as u32) as usize;
            block_below(simd, light, &view, receiver, &samples[own..own + sampling.count as usize], mask);
        }
    }
}

/// Whether the whole light lies above the receiver's horizon, as it does for most: no sample has to be asked.
fn all_above(light: &Light, view: &LightView, receiver: &Receiver) -> bool {
    let ways = light_way_bounds(light, view, receiver.position);
    let lowest = (receiver.normal * ways.low).min(receiver.normal * ways.high);
    let magnitude = ways.low.abs().max(ways.high.abs());
    lowest.dot(Vec3::ONE) > 4e-6 * magnitude.dot(Vec3::ONE)
}

/// Blocks the samples below the receiver's horizon, eight at a time.
#[inline(always)]
fn block_below<S: Simd>(
    simd: S,
    light: &Light,
    view: &LightView,
    receiver: &Receiver,
    samples: &[[f32; 4]],
    mask: &mut [u32],
) {
    let normal = Vec3x8::splat(simd, receiver.normal);
    for (eight, samples) in samples.chunks(LANES).enumerate() {
        let last = samples.len() - 1;
        let records = std::array::from_fn(|k| samples[k.min(last)]);
        let ways = eight_ways(simd, light, view, &records, receiver.position);
        let below = normal.dot(ways).simd_le(f32x8::splat(simd, 0.0)).to_bitmask() as u32;
        let first = eight * LANES;
        mask[first / 32] |= (below & (u32::MAX >> (31 - last))) << (first % 32);
    }
}
