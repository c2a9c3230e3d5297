//! The twin of `ray_traced/gather.wgsl`: the bundles of eight receivers walk the hierarchy together.

use fearless_simd::{Simd, dispatch, prelude::*, u32x8};
use rayon::prelude::*;

use super::bundle::Bundles;
use super::hierarchy::{Candidate, TraceRange, append};
use crate::engine::Call;
use crate::kernels::lanes::LANES;
use crate::kernels::shared::hierarchy::BvhNode;
use crate::kernels::shared::light::Light;
use crate::kernels::shared::receiver::Receiver;
use crate::kernels::{RUN, records};

const LONGEST_BUNDLE_WALK: u32 = 8192;

struct Scene<'a> {
    light: Light,
    receivers: &'a [Receiver],
    nodes: &'a [BvhNode],
}

pub(super) fn gather(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (light, range): (Light, TraceRange) = (call.uniform("light"), call.uniform("trace_range"));
    let [receivers, nodes, decided, candidates] = call.buffers(["receivers", "nodes", "decided", "candidates"]);
    let nodes = &records(nodes)[..range.node_count as usize];
    let scene = Scene { light, receivers: records(receivers), nodes };
    let runs = decided[items.clone()].par_chunks(RUN).enumerate();
    let found: Vec<_> = runs
        .map(|(run, decided)| {
            let first = (items.start + run * RUN) as u32;
            let asked: Vec<u32> = (first..).zip(decided).filter(|(_, d)| **d != 0).map(|(index, _)| index).collect();
            dispatch!(level, simd => gather_run(simd, &scene, &asked))
        })
        .collect();
    append(candidates, &found);
}

#[inline(always)]
fn gather_run<S: Simd>(simd: S, scene: &Scene<'_>, asked: &[u32]) -> Vec<Candidate> {
    let mut found = Vec::new();
    for eight in asked.chunks(LANES) {
        let [first, last] = bundle_walks(simd, scene, std::array::from_fn(|k| eight[k.min(eight.len() - 1)]));
        for ((&receiver, first_node), last_node) in eight.iter().zip(first).zip(last) {
            if first_node <= last_node {
                found.push(Candidate { receiver, first_node, last_node });
            }
        }
    }
    found
}

/// First and last leaf that each bundle can meet; `first` is the number of nodes where there is none.
#[inline(always)]
fn bundle_walks<S: Simd>(simd: S, scene: &Scene<'_>, receivers: [u32; LANES]) -> [[u32; LANES]; 2] {
    let bundles = Bundles::new(simd, &scene.light, &receivers.map(|index| scene.receivers[index as usize]));
    let splat = |value: u32| u32x8::splat(simd, value);
    let end = splat(scene.nodes.len() as u32);
    let (mut first, mut last, mut steps) = (end, splat(0), splat(0));
    // Each walks alone: the node at which it goes on lies behind the others' where they go down and it does not.
    let mut next = splat(0);
    let mut node = 0;
    while node < scene.nodes.len() {
        let here = &scene.nodes[node];
        let this = splat(node as u32);
        let walking = next.simd_le(this);
        let met = bundles.meet(simd, here) & walking;
        let any = met.any_true();
        if any && here.leaf != 0 {
            first = met.select(first.min(this), first);
            last = met.select(this, last);
        }
        let (skip, down) = (splat(here.skip), splat(node as u32 + 1));
        next = walking.select(met.select(down, skip), next);
        steps = walking.select(steps + splat(1), steps);
        let long = walking & steps.simd_ge(splat(LONGEST_BUNDLE_WALK)) & next.simd_lt(end);
        // A walk that was not finished has met what it has met, and may meet more to the end.
        if long.any_true() {
            first = long.select(first.min(next), first);
            last = long.select(end - splat(1), last);
            next = long.select(end, next);
        }
        node = if any && here.leaf == 0 { node + 1 } else { here.skip as usize };
    }
    [first.to_array(), last.to_array()]
}
