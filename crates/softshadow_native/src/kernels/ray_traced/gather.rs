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
        let walk = bundle_walk(simd, scene, std::array::from_fn(|k| eight[k.min(eight.len() - 1)]));
        for (k, &receiver) in eight.iter().enumerate() {
            let mut own = walk.lane(k);
            if walk.goes_on_at.is_some() {
                // The limit is on the steps of one bundle, and eight together take more.
                let alone = bundle_walk(simd, scene, [receiver; LANES]);
                own = alone.lane(0);
                if let Some(node) = alone.goes_on_at {
                    own = [own[0].min(node), scene.nodes.len() as u32 - 1];
                }
            }
            let [first_node, last_node] = own;
            if first_node <= last_node {
                found.push(Candidate { receiver, first_node, last_node });
            }
        }
    }
    found
}

/// First and last leaf that each bundle can meet; `first` is the number of nodes where there is none.
struct Walk<S: Simd> {
    first: u32x8<S>,
    last: u32x8<S>,
    /// Where the walk was too long.
    goes_on_at: Option<u32>,
}

impl<S: Simd> Walk<S> {
    #[inline(always)]
    fn lane(&self, k: usize) -> [u32; 2] {
        [self.first.as_slice()[k], self.last.as_slice()[k]]
    }
}

#[inline(always)]
fn bundle_walk<S: Simd>(simd: S, scene: &Scene<'_>, receivers: [u32; LANES]) -> Walk<S> {
    let bundles = Bundles::new(simd, &scene.light, &receivers.map(|index| scene.receivers[index as usize]));
    let mut first = u32x8::splat(simd, scene.nodes.len() as u32);
    let mut last = u32x8::splat(simd, 0);
    let (mut node, mut steps) = (0, 0);
    while node < scene.nodes.len() && steps < LONGEST_BUNDLE_WALK {
        steps += 1;
        let here = &scene.nodes[node];
        let met = bundles.meet(simd, here);
        let any = met.any_true();
        if any && here.leaf != 0 {
            let leaf = u32x8::splat(simd, node as u32);
            first = met.select(first.min(leaf), first);
            last = met.select(leaf, last);
        }
        node = if any && here.leaf == 0 { node + 1 } else { here.skip as usize };
    }
    Walk { first, last, goes_on_at: (node < scene.nodes.len()).then_some(node as u32) }
}
