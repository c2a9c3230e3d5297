//! Averages of pixels side by side whose samples make up one set: the passes that only interleaved samples need.

use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};
use softshadow_scene::{LightSampling, SampleSpread};

use crate::request::{ReceiverSource, Request};

const INTERLEAVE: Kernel = Kernel { file: "resolve/resolve.wgsl", entry: "interleave" };
const INTERLEAVE_COLORS: Kernel = Kernel { file: "shading/interleave_colors.wgsl", entry: "interleave_colors" };

/// Label of the values of one pass before they are averaged.
const PASS_VALUES: &str = "values of a pass";
/// Label of the colours before they are averaged.
const NOISY_COLOR: &str = "noisy color";
/// Label of the parameter.
const INTERLEAVING: &str = "interleaving";

/// Bytes of a receiver's values before they are averaged, and as many of its colour.
pub const NOISY_BYTES: u64 = 16;

/// `Interleaving` of `shared/continuity.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct InterleavingRecord {
    eye: [f32; 3],
    tile: u32,
    width: u32,
    height: u32,
    channels: u32,
    reserved: u32,
}

/// Rows above and below a pixel with which it is averaged.
#[must_use]
pub fn halo_rows(sampling: &LightSampling) -> u32 {
    match sampling.spread {
        SampleSpread::Interleaved => sampling.tile / 2,
        SampleSpread::Correlated | SampleSpread::Decorrelated => 0,
    }
}

/// Where the values of one pass are kept until they are averaged.
pub fn pass_values(plan: &mut Plan, request: &Request<'_>) -> ResourceId {
    plan.buffer(PASS_VALUES, request.block.count as u64 * NOISY_BYTES)
}

/// Where colours are added up until they are averaged.
pub fn noisy_color(plan: &mut Plan, request: &Request<'_>) -> ResourceId {
    plan.persistent(NOISY_COLOR, request.block.count as u64 * NOISY_BYTES)
}

/// What the averages are made of.
pub struct Averaged {
    /// `Sampling`.
    pub sampling: ResourceId,
    /// The receivers.
    pub receivers: ResourceId,
    /// From [`pass_values`].
    pub pass_values: ResourceId,
    /// Mean of the passes.
    pub visibility: ResourceId,
    /// Its standard error.
    pub standard_error: ResourceId,
}

/// Adds the pass from the values of one pass to those of all passes so far.
pub fn append(plan: &mut Plan, request: &Request<'_>, tile: u32, averaged: &Averaged) {
    let interleaving = parameter(plan);
    let why = "averages pixels side by side whose samples make up one set, where they see one surface";
    plan.compute("interleave", why, INTERLEAVE, over(request, tile))
        .bind("sampling", averaged.sampling)
        .bind("interleaving", interleaving)
        .bind("receivers", averaged.receivers)
        .bind("pass_values", averaged.pass_values)
        .bind("visibility", averaged.visibility)
        .bind("standard_error", averaged.standard_error);
}

/// Adds the pass from the block's added up colours to those that leave.
pub fn append_colors(
    plan: &mut Plan,
    request: &Request<'_>,
    tile: u32,
    [receivers, triangle_materials, noisy, color]: [ResourceId; 4],
) {
    let interleaving = parameter(plan);
    let why = "averages the light of pixels side by side, where they see one surface of one material";
    plan.compute("interleave colors", why, INTERLEAVE_COLORS, over(request, tile))
        .bind("interleaving", interleaving)
        .bind("receivers", receivers)
        .bind("triangle_materials", triangle_materials)
        .bind("noisy_color", noisy)
        .bind("color", color);
}

fn parameter(plan: &mut Plan) -> ResourceId {
    let known = plan.find(INTERLEAVING);
    known.unwrap_or_else(|| plan.parameter(INTERLEAVING, size_of::<InterleavingRecord>() as u64))
}

fn over(request: &Request<'_>, tile: u32) -> Over {
    Over::Items { count: request.block.count as u32, work_per_item: tile * tile }
}

/// The value of the parameter that the passes added.
pub fn values(request: &Request<'_>, sampling: &LightSampling, values: &mut Values) {
    let ReceiverSource::Camera(camera) = request.receivers else { return };
    if sampling.spread != SampleSpread::Interleaved {
        return;
    }
    let record = InterleavingRecord {
        eye: camera.local(&request.scene.local.frame).eye.as_vec3().to_array(),
        tile: sampling.tile,
        width: camera.size()[0],
        height: (request.block.count / camera.size()[0] as usize) as u32,
        channels: request.channels,
        reserved: 0,
    };
    values.insert(INTERLEAVING.into(), bytemuck::bytes_of(&record).to_vec());
}
