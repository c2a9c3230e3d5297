//! The twin of `ray_traced/trace.wgsl`: eight rays of one receiver walk the hierarchy together.
//!
//! Rays that walk together should go the same way, but samples come in an order whose every prefix is spread over the light. So each set
//! is brought into clusters of eight neighbours first; which ray is in which lane changes no result.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use glam::Vec3;
use rayon::prelude::*;

use super::hierarchy::{Candidate, TraceRange, listed};
use crate::engine::{Call, atomic_words, shared};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::records;
use crate::kernels::shared::hierarchy::{BvhNode, box_pad, eight_reciprocals};
use crate::kernels::shared::light::{LIGHT_SUN, Light, LightView, eight_ways, light_view};
use crate::kernels::shared::receiver::Receiver;
use crate::kernels::shared::samples::Sampling;
use crate::kernels::shared::triangle::{Corner, triangle_blocks};

/// Candidates that a thread takes at once: each may cost a thousand times another.
const CANDIDATES: usize = 64;

struct Scene<'a> {
    light: Light,
    sampling: Sampling,
    range: TraceRange,
    receivers: &'a [Receiver],
    samples: &'a [[f32; 4]],
    nodes: &'a [BvhNode],
    triangles: &'a [[Corner; 3]],
    decided: &'a [u32],
    /// The samples of the range, set after set, neighbours together.
    order: Vec<u32>,
}

const NAMES: [&str; 7] = ["receivers", "light_samples", "nodes", "corners", "decided", "candidates", "blocked"];
const ATTENUATED: [&str; 8] = {
    let [a, b, c, d, e, f, _] = NAMES;
    [a, b, c, d, e, f, "triangle_transmittance", "sample_transmittance"]
};

pub(super) fn trace(call: &mut Call) {
    let (uniforms, level) = (Uniforms::of(call), call.level);
    let [receivers, samples, nodes, corners, decided, candidates, blocked] = call.buffers(NAMES);
    let scene = uniforms.scene(receivers, samples, nodes, corners, decided);
    let blocked = atomic_words(blocked);
    listed(candidates).par_chunks(CANDIDATES).for_each(|candidates| {
        dispatch!(level, simd => trace_run(simd, &scene, candidates, blocked));
    });
}

/// As `trace`, where some triangles are semi-opaque.
pub(super) fn trace_attenuated(call: &mut Call) {
    let (uniforms, level) = (Uniforms::of(call), call.level);
    let [receivers, samples, nodes, corners, decided, candidates, triangles, passing] = call.buffers(ATTENUATED);
    let scene = uniforms.scene(receivers, samples, nodes, corners, decided);
    let passing = atomic_words(passing);
    listed(candidates).par_chunks(CANDIDATES).for_each(|candidates| {
        dispatch!(level, simd => attenuate_run(simd, &scene, candidates, records(triangles), passing));
    });
}

struct Uniforms {
    light: Light,
    sampling: Sampling,
    range: TraceRange,
}

impl Uniforms {
    fn of(call: &mut Call) -> Self {
        Self { light: call.uniform("light"), sampling: call.uniform("sampling"), range: call.uniform("trace_range") }
    }

    fn scene<'a>(
        self,
        receivers: &'a [u32],
        samples: &'a [u32],
        nodes: &'a [u32],
        corners: &'a [u32],
        decided: &'a [u32],
    ) -> Scene<'a> {
        let Self { light, sampling, range } = self;
        let samples: &[[f32; 4]] = records(samples);
        let mut order = Vec::new();
        for set in samples.chunks_exact(sampling.count as usize) {
            let first = order.len();
            order.extend(range.first_sample..range.end_sample);
            gather_neighbours(&mut order[first..], set);
        }
        let (nodes, triangles) = (records(nodes), records(corners));
        Scene { light, sampling, range, receivers: records(receivers), samples, nodes, triangles, decided, order }
    }
}

/// Halves the samples across their longer extent until eight are left.
fn gather_neighbours(order: &mut [u32], samples: &[[f32; 4]]) {
    if order.len() <= LANES {
        return;
    }
    let at = |sample: u32, axis: usize| samples[sample as usize][axis];
    let extent = |axis: usize| {
        let each = || order.iter().map(|sample| at(*sample, axis));
        each().fold(f32::MIN, f32::max) - each().fold(f32::MAX, f32::min)
    };
    let axis = (0..3).max_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(0);
    let middle = (order.len() / 2).next_multiple_of(LANES);
    order.select_nth_unstable_by(middle - 1, |a, b| at(*a, axis).total_cmp(&at(*b, axis)));
    let (low, high) = order.split_at_mut(middle);
    gather_neighbours(low, samples);
    gather_neighbours(high, samples);
}

/// What the rays of one candidate share.
struct Own<'a> {
    walk: &'a Candidate,
    receiver: &'a Receiver,
    view: LightView,
    first_sample: u32,
}

impl Scene<'_> {
    fn own<'a>(&'a self, walk: &'a Candidate) -> Own<'a> {
        let receiver = &self.receivers[walk.receiver as usize];
        let first_sample = self.sampling.first_sample(walk.receiver);
        Own { walk, receiver, view: light_view(&self.light, receiver.position), first_sample }
    }

    /// The samples that a candidate asks for.
    fn asked(&self, own: &Own<'_>) -> impl Iterator<Item = u32> {
        let length = self.range.end_sample - self.range.first_sample;
        let first = (own.first_sample / self.sampling.count * length) as usize;
        let decided = self.decided[own.walk.receiver as usize];
        self.order[first..first + length as usize].iter().copied().filter(move |sample| *sample < decided)
    }

    /// The rays to at most eight samples; those to the first fill up the lanes.
    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, own: &Own<'_>, samples: &[u32]) -> Rays<'_, S> {
        let of = |k: usize| self.samples[(own.first_sample + samples[if k < samples.len() { k } else { 0 }]) as usize];
        let ways = eight_ways(simd, &self.light, &own.view, &std::array::from_fn(of), own.receiver.position);
        Rays::new(simd, self, own.receiver, ways, own.walk)
    }
}

/// Eight rays of one receiver on their way through the hierarchy.
struct Rays<'a, S: Simd> {
    simd: S,
    nodes: &'a [BvhNode],
    triangles: &'a [[Corner; 3]],
    origin: Vec3,
    own_triangle: u32,
    unbounded: bool,
    way: Vec3x8<S>,
    inverse: Vec3x8<S>,
    to_low: Vec3x8<S>,
    to_high: Vec3x8<S>,
    node: usize,
}

impl<'a, S: Simd> Rays<'a, S> {
    #[inline(always)]
    fn new(simd: S, scene: &Scene<'a>, receiver: &Receiver, way: Vec3x8<S>, walk: &Candidate) -> Self {
        let inverse = eight_reciprocals(simd, way);
        // The box is widened by what rounding can cost, so that no box hides a triangle that a ray would meet.
        let pad = Vec3::splat(box_pad(receiver.position));
        Self {
            simd,
            nodes: &scene.nodes[..=walk.last_node as usize],
            triangles: scene.triangles,
            origin: receiver.position,
            own_triangle: receiver.triangle,
            unbounded: scene.light.kind == LIGHT_SUN,
            way,
            inverse,
            to_low: Vec3x8::splat(simd, -receiver.position - pad) * inverse,
            to_high: Vec3x8::splat(simd, -receiver.position + pad) * inverse,
            node: walk.first_node as usize,
        }
    }

    /// Goes on to the next leaf that one of the active rays meets: its triangles, and which rays meet it.
    ///
    /// A ray that meets a box meets the boxes around it: every step rounds, but none changes an order. So none has to remember where
    /// it left the others.
    #[inline(always)]
    fn next_leaf(&mut self, active: mask32x8<S>) -> Option<(&'a [[Corner; 3]], mask32x8<S>)> {
        let simd = self.simd;
        let zero = f32x8::splat(simd, 0.0);
        let end = f32x8::splat(simd, if self.unbounded { 1e30 } else { 1.0 });
        while self.node < self.nodes.len() {
            let here = &self.nodes[self.node];
            let low = Vec3x8::splat(simd, here.low) * self.inverse + self.to_low;
            let high = Vec3x8::splat(simd, here.high) * self.inverse + self.to_high;
            // Whichever border a ray meets first: where its component is negative that is the higher.
            let (near, far) = (low.min(high), low.max(high));
            let enter = near.x.max(near.y).max(near.z.max(zero));
            let leave = far.x.min(far.y).min(far.z.min(end));
            let met = enter.simd_le(leave) & active;
            let any = met.any_true();
            self.node = if any && here.leaf == 0 { self.node + 1 } else { here.skip as usize };
            if any && here.leaf != 0 {
                return Some((&self.triangles[here.triangles()], met));
            }
        }
        None
    }

    /// Which rays a triangle blocks.
    #[inline(always)]
    fn blocked_by(&self, triangle: &[Corner; 3]) -> mask32x8<S> {
        let others = mask32x8::splat(self.simd, triangle[0].triangle != self.own_triangle);
        let corners = triangle.map(|corner| corner.position);
        others & triangle_blocks(self.simd, corners, self.origin, self.way, self.unbounded)
    }
}

#[inline(always)]
fn trace_run<S: Simd>(simd: S, scene: &Scene<'_>, candidates: &[Candidate], blocked: &[AtomicU32]) {
    let mut open = Vec::new();
    for candidate in candidates {
        let own = scene.own(candidate);
        let words = scene.sampling.words as usize;
        let mask = &blocked[candidate.receiver as usize * words..][..words];
        let is_open = |sample: &u32| shared(&mask[(sample / 32) as usize]) >> (sample % 32) & 1 == 0;
        open.clear();
        open.extend(scene.asked(&own).filter(is_open));
        for eight in open.chunks(LANES) {
            let hit = blocked_of(simd, scene.rays(simd, &own, eight)).to_bitmask();
            for (k, sample) in eight.iter().enumerate() {
                if hit >> k & 1 == 1 {
                    // Each receiver is a candidate once, so nobody else writes its words.
                    mask[(sample / 32) as usize].fetch_or(1 << (sample % 32), Ordering::Relaxed);
                }
            }
        }
    }
}

/// Which rays any triangle blocks.
#[inline(always)]
fn blocked_of<S: Simd>(simd: S, mut rays: Rays<'_, S>) -> mask32x8<S> {
    let mut open = mask32x8::splat(simd, true);
    while let Some((triangles, met)) = rays.next_leaf(open) {
        for triangle in triangles {
            open &= !(met & rays.blocked_by(triangle));
        }
        if open.all_false() {
            break;
        }
    }
    !open
}

#[inline(always)]
fn attenuate_run<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    candidates: &[Candidate],
    transmittances: &[f32],
    passing: &[AtomicU32],
) {
    let mut open = Vec::new();
    for candidate in candidates {
        let own = scene.own(candidate);
        let count = scene.sampling.count as usize;
        let passing = &passing[candidate.receiver as usize * count..][..count];
        let before = |sample: u32| f32::from_bits(shared(&passing[sample as usize]));
        open.clear();
        open.extend(scene.asked(&own).filter(|sample| before(*sample) > 0.0));
        for eight in open.chunks(LANES) {
            let shares = passed_shares(simd, scene.rays(simd, &own, eight), transmittances).to_array();
            for (sample, share) in eight.iter().zip(shares) {
                passing[*sample as usize].store((before(*sample) * share).to_bits(), Ordering::Relaxed);
            }
        }
    }
}

/// What passes all triangles on the way: only an opaque one ends it.
#[inline(always)]
fn passed_shares<S: Simd>(simd: S, mut rays: Rays<'_, S>, transmittances: &[f32]) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let mut share = one;
    while let Some((triangles, met)) = rays.next_leaf(share.simd_gt(zero)) {
        for triangle in triangles {
            let passes = f32x8::splat(simd, transmittances[triangle[0].triangle as usize]);
            share *= (met & rays.blocked_by(triangle)).select(passes, one);
        }
    }
    share
}
