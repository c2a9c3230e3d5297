//! Triangles that touch a ball of light: sample by sample, after everything that has edges.

use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};

use super::DepthComplexity;
use crate::parts::light_buffers::LightBuffers;
use crate::parts::occluder_buffers::{OccluderContents, TouchingContents};
use crate::request::Request;

const TRY_TOUCHING: Kernel = Kernel { file: "depth_complexity/touching.wgsl", entry: "try_touching" };

/// Triangles of one pass: 32 samples against them take fewer steps than the 65,535 after which Mesa's software driver ends all loops.
const MOST_IN_PASS: u32 = 1900;

/// `TouchingRange` of `touching.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct TouchingRange {
    first: u32,
    end: u32,
    reserved0: u32,
    reserved1: u32,
}

fn ranges(touching: &TouchingContents) -> impl Iterator<Item = (String, TouchingRange)> {
    let count = touching.count;
    (0..count.div_ceil(MOST_IN_PASS)).map(move |pass| {
        let (first, end) = (pass * MOST_IN_PASS, count.min((pass + 1) * MOST_IN_PASS));
        (format!("touching range {pass}"), TouchingRange { first, end, reserved0: 0, reserved1: 0 })
    })
}

/// The passes over them; none where there are none.
pub(super) fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    light: &LightBuffers,
    receivers: ResourceId,
    blocked: ResourceId,
) {
    let Some(touching) = request.occluders.and_then(|occluders| occluders.touching.as_ref()) else { return };
    let corners = plan.uploaded("touching triangles", &touching.corners);
    for (pass, (label, range)) in ranges(touching).enumerate() {
        let touching_range = plan.parameter(label, size_of::<TouchingRange>() as u64);
        let over = Over::Items {
            count: request.block.count as u32 * settings.words(),
            work_per_item: 32 * (range.end - range.first),
        };
        let why = "tries the triangles that touch the ball of light against every sample";
        plan.compute(format!("try touching triangles {pass}"), why, TRY_TOUCHING, over)
            .bind("light", light.light)
            .bind("sampling", light.sampling)
            .bind("light_samples", light.samples)
            .bind("touching_range", touching_range)
            .bind("receivers", receivers)
            .bind("touching", corners)
            .bind("blocked", blocked);
    }
}

/// The values of their parameters.
pub(super) fn values(occluders: &OccluderContents, values: &mut Values) {
    for (label, range) in occluders.touching.iter().flat_map(ranges) {
        values.insert(label, bytemuck::bytes_of(&range).to_vec());
    }
}
