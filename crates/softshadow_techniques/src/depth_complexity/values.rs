//! The parameters of the plans: what changes from light to light and pass to pass.

use softshadow_plan::Values;
use softshadow_scene::{Light, LightFrame, LightKind, LightSamples, Outline, pass_seed};

use super::order::order;
use super::tiled::{CLUSTER, tiles};
use super::unit::Unit;
use super::{DepthComplexity, covered, touching};
use crate::TechniqueError;
use crate::parts::light_buffers::{self, SampleSet, Sampling};
use crate::parts::{receivers, shading};
use crate::request::Request;

/// Samples of one set at most: as many as one uniform holds.
pub(super) const MOST_SAMPLES: u32 = 256;
/// Samples that one fold holds.
pub(super) const GROUP: u32 = 64;
/// Corners of a polygon light at most.
pub(super) const MOST_CORNERS: usize = 64;
/// An area is not believed when it differs from the samples' share by more than this over `samples^(3/4)`: twice the largest error seen
/// for stratified samples of a half plane.
const SAMPLING_BOUND: f32 = 2.0;

/// `LightFrame` of `frame.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct FrameRecord {
    origin: [f32; 3],
    kind: u32,
    x_row: [f32; 3],
    size: f32,
    y_row: [f32; 3],
    area: f32,
    z_row: [f32; 3],
    outline_count: u32,
    x_way: [f32; 3],
    sample_count: u32,
    y_way: [f32; 3],
    reserved0: u32,
    reference: [f32; 2],
    low: [f32; 2],
    high: [f32; 2],
    reserved1: [f32; 2],
}

/// `ClusterRange` of `clusters.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ClusterRange {
    edge_count: u32,
    cluster_count: u32,
    tile_count: u32,
    receiver_count: u32,
}

/// `FoldSettings` of `fold.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct FoldSettings {
    slot_count: u32,
    group: u32,
    sampling_bound: f32,
    tile_count: u32,
}

/// The values of the plan's parameters for one light and pass.
pub(crate) fn values(
    request: &Request<'_>,
    settings: &DepthComplexity,
    light: &Light,
    pass: u32,
) -> Result<Values, TechniqueError> {
    let mut values = Values::new();
    receivers::values(request, &mut values);
    let set = SampleSet { pattern: settings.pattern, count: settings.samples, seed: pass_seed(settings.seed, pass) };
    light_buffers::values(request, light, set, &mut values)?;
    let sampling = Sampling {
        count: settings.samples,
        words: settings.words(),
        probes: settings.samples,
        pass_index: pass,
        passes: settings.passes,
        ..Sampling::default()
    };
    values.insert("sampling".into(), bytemuck::bytes_of(&sampling).to_vec());

    let local = &request.scene.local.frame;
    let frame = LightFrame::new(light, local);
    let corners = match &frame.outline {
        Some(Outline::Polygon(corners)) => corners.clone(),
        _ => Vec::new(),
    };
    let answers = area_answers(request, settings);
    let record = frame_record(&frame, settings.samples, if answers { corners.len() } else { 0 });
    values.insert("light frame".into(), bytemuck::bytes_of(&record).to_vec());
    let padded = |points: &[[f32; 2]], length: usize| -> Vec<u8> {
        let mut rows: Vec<[f32; 4]> = points.iter().take(length).map(|p| [p[0], p[1], 0.0, 0.0]).collect();
        rows.resize(length, [0.0; 4]);
        bytemuck::cast_slice(&rows).to_vec()
    };
    values.insert("light outline".into(), padded(&corners, MOST_CORNERS));
    let samples = frame.samples(light, &LightSamples::new(light, local, set.pattern, set.count, set.seed)?);
    values.insert("frame samples".into(), padded(&samples, MOST_SAMPLES as usize));

    let (tile_count, receiver_count) = (tiles(request), request.block.count as u32);
    let edge_count = request.occluders.map_or(0, |o| o.edge_count);
    let range = ClusterRange { edge_count, cluster_count: edge_count.div_ceil(CLUSTER), tile_count, receiver_count };
    values.insert("cluster range".into(), bytemuck::bytes_of(&range).to_vec());
    for (group, samples) in (0..).zip(samples.chunks(GROUP as usize)) {
        let fold = FoldSettings {
            slot_count: receiver_count,
            group,
            sampling_bound: SAMPLING_BOUND * (samples.len() as f32).powf(-0.75),
            tile_count,
        };
        values.insert(format!("fold settings {group}"), bytemuck::bytes_of(&fold).to_vec());
        values.insert(format!("group samples {group}"), padded(samples, GROUP as usize));
    }
    if let Some(occluders) = request.occluders {
        if settings.unit.of(occluders) == Unit::Triangles {
            covered::values(request, occluders, &samples, &mut values);
        }
        touching::values(occluders, &mut values);
    }
    values.insert("receiver order".into(), bytemuck::cast_slice(&order(request)).to_vec());
    shading::values(request, settings.passes, &mut values);
    Ok(values)
}

/// Whether the visible area answers: it is asked for, it is what visibility is a share of, and its outline fits. A texture's light is in its
/// samples, whatever light of the call it belongs to.
pub(super) fn area_answers(request: &Request<'_>, settings: &DepthComplexity) -> bool {
    let fits = match light_outline(request) {
        Some(Outline::Polygon(corners)) => corners.len() <= MOST_CORNERS,
        Some(Outline::Disc(_)) => true,
        None => false,
    };
    settings.exact_area && fits && request.channels == 1
}

/// The outline of the light, where visibility is a share of its area.
pub(super) fn light_outline(request: &Request<'_>) -> Option<Outline> {
    LightFrame::new(request.light, &request.scene.local.frame).outline
}

fn frame_record(frame: &LightFrame, sample_count: u32, corners: usize) -> FrameRecord {
    let base = FrameRecord {
        reference: frame.reference,
        low: frame.bounds[0],
        high: frame.bounds[1],
        area: frame.outline.as_ref().map_or(0.0, |outline| outline.area() as f32),
        outline_count: corners as u32,
        sample_count,
        ..bytemuck::Zeroable::zeroed()
    };
    match frame.kind {
        LightKind::Flat { origin, rows: [x_row, y_row, z_row], axes: [x_way, y_way] } => {
            FrameRecord { kind: 0, origin, x_row, y_row, z_row, x_way, y_way, ..base }
        }
        LightKind::Sphere { center, radius } => FrameRecord { kind: 1, origin: center, size: radius, ..base },
        LightKind::Sun { axes: [x_row, y_row, z_row], tangent } => {
            FrameRecord { kind: 2, x_row, y_row, z_row, size: tangent, ..base }
        }
    }
}
