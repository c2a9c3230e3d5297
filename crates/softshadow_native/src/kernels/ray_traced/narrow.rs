//! The twin of `ray_traced/narrow.wgsl`: eight candidates walk together, each from a node and to a node of its own.

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;
use rayon::prelude::*;

use super::bundle::Bundles;
use super::hierarchy::{Candidate, append, listed};
use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::hierarchy::BvhNode;
use crate::kernels::shared::light::Light;
use crate::kernels::shared::receiver::Receiver;
use crate::kernels::shared::triangle::Corner;
use crate::kernels::{RUN, records};

const LONGEST_NARROW_WALK: u32 = 64;

/// The next node of a lane that walks no more.
const DONE: u32 = u32::MAX;

struct Scene<'a> {
    light: Light,
    receivers: &'a [Receiver],
    nodes: &'a [BvhNode],
    triangles: &'a [[Corner; 3]],
}

pub(super) fn narrow(call: &mut Call) {
    let (light, level) = (call.uniform("light"), call.level);
    let names = ["receivers", "nodes", "corners", "candidates", "narrowed"];
    let [receivers, nodes, corners, candidates, narrowed] = call.buffers(names);
    let triangles = records::<[Corner; 3]>(corners);
    let scene = Scene { light, receivers: records(receivers), nodes: records(nodes), triangles };
    let runs = listed(candidates).par_chunks(RUN);
    let found: Vec<_> = runs.map(|candidates| dispatch!(level, simd => narrow_run(simd, &scene, candidates))).collect();
    append(narrowed, &found);
}

#[inline(always)]
fn narrow_run<S: Simd>(simd: S, scene: &Scene<'_>, candidates: &[Candidate]) -> Vec<Candidate> {
    let mut found = Vec::new();
    for eight in candidates.chunks(LANES) {
        let first = first_leaves(simd, scene, &std::array::from_fn(|k| eight[k.min(eight.len() - 1)]));
        let begun = eight.iter().zip(first).filter(|(_, first)| *first != DONE);
        found.extend(begun.map(|(candidate, first_node)| Candidate { first_node, ..*candidate }));
    }
    found
}

/// Where the rays of each candidate begin: at the first leaf with such a triangle; `DONE` where there is none.
/// A long walk is given up: it would cost more than the rays that it saves.
#[inline(always)]
fn first_leaves<S: Simd>(simd: S, scene: &Scene<'_>, candidates: &[Candidate; LANES]) -> [u32; LANES] {
    let receivers = candidates.map(|c| scene.receivers[c.receiver as usize]);
    let bundles = Bundles::new(simd, &scene.light, &receivers);
    let own = u32x8::from_fn(simd, |k| receivers[k].triangle);
    let last = u32x8::from_fn(simd, |k| candidates[k].last_node);
    let done = u32x8::splat(simd, DONE);
    let mut next = u32x8::from_fn(simd, |k| candidates[k].first_node);
    let mut steps = u32x8::splat(simd, 0);
    let mut found = done;
    loop {
        let node = next.reduce_min();
        if node == DONE {
            return found.to_array();
        }
        let here = &scene.nodes[node as usize];
        let this = u32x8::splat(simd, node);
        let walking = next.simd_eq(this);
        let met = bundles.meet(simd, here) & walking;
        steps = walking.select(steps + u32x8::splat(simd, 1), steps);
        let mut any = walking & steps.simd_ge(u32x8::splat(simd, LONGEST_NARROW_WALK));
        if met.any_true() {
            for triangle in &scene.triangles[here.triangles()] {
                let other = own.simd_ne(u32x8::splat(simd, triangle[0].triangle));
                any |= met & other & can_block(simd, &bundles, triangle.map(|corner| corner.position));
            }
        }
        found = any.select(this, found);
        let skip = u32x8::splat(simd, here.skip);
        let down = if here.leaf == 0 { u32x8::splat(simd, node + 1) } else { skip };
        next = walking.select(met.select(down, skip), next);
        next = (any | next.simd_gt(last)).select(done, next);
    }
}

/// Whether a triangle can block any way of the bundle: it rises above the receiver's plane, and has no edge that all ways pass on
/// the outer side.
#[inline(always)]
fn can_block<S: Simd>(simd: S, bundles: &Bundles<S>, [v0, v1, v2]: [Vec3; 3]) -> mask32x8<S> {
    // Closures over arrays would not be inlined, and would lose the processor's instructions.
    let a = Vec3x8::splat(simd, v0) - bundles.origin;
    let b = Vec3x8::splat(simd, v1) - bundles.origin;
    let c = Vec3x8::splat(simd, v2) - bundles.origin;
    let normal = bundles.normal;
    let top = normal.dot(a).max(normal.dot(b).max(normal.dot(c)));
    let ab = way_range(simd, a, v1 - v0, bundles);
    let bc = way_range(simd, b, v2 - v1, bundles);
    let ca = way_range(simd, a, v0 - v2, bundles);
    let zero = f32x8::splat(simd, 0.0);
    let left = ab[1].simd_ge(zero) & bc[1].simd_ge(zero) & ca[1].simd_ge(zero);
    let right = ab[0].simd_le(zero) & bc[0].simd_le(zero) & ca[0].simd_le(zero);
    top.simd_ge(bundles.horizon) & (left | right)
}

/// Smallest and largest value of way · (corner × edge) over the bundle, widened by what rounding can cost here and in the rays'
/// own test: a share of the products before any of them cancel.
#[inline(always)]
fn way_range<S: Simd>(simd: S, corner: Vec3x8<S>, edge: Vec3, ways: &Bundles<S>) -> [f32x8<S>; 2] {
    let normal = corner.cross(Vec3x8::splat(simd, edge));
    let (c, e) = (corner.abs(), Vec3x8::splat(simd, edge.abs()));
    let uncancelled = Vec3x8::new(c.y * e.z + c.z * e.y, c.z * e.x + c.x * e.z, c.x * e.y + c.y * e.x);
    let slack = f32x8::splat(simd, 4e-6) * ways.low.abs().max(ways.high.abs()).dot(uncancelled);
    let (at_low, at_high) = (ways.low * normal, ways.high * normal);
    let (least, most) = (at_low.min(at_high), at_low.max(at_high));
    [least.x + least.y + least.z - slack, most.x + most.y + most.z + slack]
}
