//! The twin of `receivers/trace_camera.wgsl`: eight neighbouring pixels walk the hierarchy together.

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;
use rayon::prelude::*;

use super::place::{CameraRays, NOTHING, SubScene};
use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::hierarchy::{BvhNode, box_pad, safe_reciprocal};
use crate::kernels::shared::receiver::{NO_TRIANGLE, Receiver};
use crate::kernels::shared::triangle::Corner;
use crate::kernels::{RUN, records, records_mut};

const NEAR: f32 = 1.0 / 1_048_576.0;
const FAR: f32 = 1e30;

struct Scene<'a> {
    rays: CameraRays,
    sub_scene: SubScene,
    nodes: &'a [BvhNode],
    corners: &'a [Corner],
}

pub(super) fn trace_camera(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (rays, sub_scene) = (call.uniform("camera_rays"), call.uniform("sub_scene"));
    let [nodes, corners, distances, receivers] = call.buffers(["nodes", "corners", "distances", "receivers"]);
    let scene = Scene { rays, sub_scene, nodes: records(nodes), corners: records(corners) };
    let distances = &mut records_mut::<f32>(distances)[items.clone()];
    let receivers = &mut records_mut::<Receiver>(receivers)[items.clone()];
    let runs = receivers.par_chunks_mut(RUN).zip(distances.par_chunks_mut(RUN)).enumerate();
    runs.for_each(|(run, (receivers, distances))| {
        let first = (items.start + run * RUN) as u32;
        dispatch!(level, simd => trace_run(simd, &scene, first, receivers, distances));
    });
}

#[inline(always)]
fn trace_run<S: Simd>(simd: S, scene: &Scene<'_>, first: u32, receivers: &mut [Receiver], distances: &mut [f32]) {
    for (at, (receivers, distances)) in receivers.chunks_mut(LANES).zip(distances.chunks_mut(LANES)).enumerate() {
        let first = first + (at * LANES) as u32;
        if scene.sub_scene.first_triangle == 0 {
            receivers.fill(NOTHING);
            distances.fill(FAR);
        }
        let last = receivers.len() - 1;
        let ways: [Vec3; LANES] = std::array::from_fn(|k| scene.rays.way_of(first + k.min(last) as u32));
        let start = std::array::from_fn(|k| distances[k.min(last)]);
        let d = Vec3x8::from_fn(simd, |k| ways[k]);
        let (nearest, found) = trace_eight(simd, scene, &ways, d, start);
        let finds = found.map(|found| found != NO_TRIANGLE);
        if finds.contains(&true) {
            // Who finds nothing takes any triangle, and is left alone.
            let at = found.map(|found| if found == NO_TRIANGLE { 0 } else { 3 * found as usize });
            let corners = [0, 1, 2].map(
                #[inline(always)]
                |i| Vec3x8::from_fn(simd, |k| scene.corners[at[k] + i].position),
            );
            let triangles = found.map(|found| scene.sub_scene.first_triangle.wrapping_add(found));
            let placed = scene.rays.receivers_on(simd, d, corners, triangles);
            for (k, receiver) in receivers.iter_mut().enumerate().filter(|(k, _)| finds[*k]) {
                *receiver = placed[k];
            }
        }
        distances.copy_from_slice(&nearest[..distances.len()]);
    }
}

/// The nearest triangle of each lane, and how far along its ray that is.
#[inline(always)]
fn trace_eight<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    ways: &[Vec3; LANES],
    d: Vec3x8<S>,
    start: [f32; LANES],
) -> ([f32; LANES], [u32; LANES]) {
    let eye = scene.rays.eye;
    let inverse = Vec3x8::from_fn(simd, |k| safe_reciprocal(ways[k]));
    let pad = Vec3::splat(box_pad(eye));
    let to_low = Vec3x8::splat(simd, -eye - pad) * inverse;
    let to_high = Vec3x8::splat(simd, -eye + pad) * inverse;
    let zero = f32x8::splat(simd, 0.0);
    let mut nearest = f32x8::load_array(simd, start);
    let mut found = u32x8::splat(simd, NO_TRIANGLE);
    let mut node = 0;
    while node < scene.nodes.len() {
        let here = &scene.nodes[node];
        let low = Vec3x8::splat(simd, here.low) * inverse + to_low;
        let high = Vec3x8::splat(simd, here.high) * inverse + to_high;
        // Whichever border a ray meets first: where its component is negative that is the higher.
        let (near, far) = (low.min(high), low.max(high));
        let enter = near.x.max(near.y).max(near.z.max(zero));
        let leave = far.x.min(far.y).min(far.z.min(nearest));
        if enter.simd_le(leave).any_true() {
            for k in here.triangles() {
                let corner = |i: usize| scene.corners[3 * k + i].position;
                let at = distance_to(simd, d, eye, [corner(0), corner(1), corner(2)]);
                let index = u32x8::splat(simd, k as u32);
                let first_of_equals = at.simd_eq(nearest) & at.simd_lt(FAR) & index.simd_lt(found);
                found = (at.simd_lt(nearest) | first_of_equals).select(index, found);
                nearest = nearest.min(at);
            }
            node = if here.leaf == 0 { node + 1 } else { here.skip as usize };
        } else {
            node = here.skip as usize;
        }
    }
    (nearest.to_array(), found.to_array())
}

#[inline(always)]
fn distance_to<S: Simd>(simd: S, d: Vec3x8<S>, eye: Vec3, [v0, v1, v2]: [Vec3; 3]) -> f32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let a = v0 - eye;
    let (edge01, edge02) = (v1 - v0, v2 - v0);
    let across = d.cross(Vec3x8::splat(simd, a));
    let ab = across.dot(Vec3x8::splat(simd, edge01));
    let ac = across.dot(Vec3x8::splat(simd, edge02));
    let bc = d.cross(Vec3x8::splat(simd, v1 - eye)).dot(Vec3x8::splat(simd, v2 - v1));
    let inside = (ab.simd_ge(zero) & bc.simd_ge(zero) & ac.simd_le(zero))
        | (ab.simd_le(zero) & bc.simd_le(zero) & ac.simd_ge(zero));
    if !inside.any_true() {
        return f32x8::splat(simd, FAR);
    }
    let normal = edge01.cross(edge02);
    let along = Vec3x8::splat(simd, normal).dot(d);
    let has_slope: mask32x8<S> = along.simd_ne(zero);
    let distance = f32x8::splat(simd, normal.dot(a)) / has_slope.select(along, f32x8::splat(simd, 1.0));
    (inside & has_slope & distance.simd_ge(NEAR)).select(distance, f32x8::splat(simd, FAR))
}
