//! The parameters of the plans: what changes from light to light and pass to pass.

use softshadow_plan::Values;
use softshadow_scene::occluders::UNITS_PER_HALVING;
use softshadow_scene::{Light, LightFrame, LightKind, LightShape, Outline, SampleSpread};

use super::coverage_table::coverage_table;
use super::order::order;
use super::tiled::{CLUSTER, tiles};
use super::unit::{Unit, unit_of};
use super::{Attenuation, DepthComplexity, Evaluation, Silhouettes, blended, covered, touching};
use crate::TechniqueError;
use crate::parts::light_buffers::{self, Sampling};
use crate::parts::opacity::UNITS_PER_WHOLE;
use crate::parts::{interleaving, receivers, shading};
use crate::request::{ReceiverSource, Request};

/// Samples of one set at most: as many as one uniform holds.
pub(super) const MOST_SAMPLES: u32 = 256;
/// Samples that one fold holds.
pub(super) const GROUP: u32 = 64;
/// Samples of all sets at most, where there are several: as many as the largest uniform holds, two a row.
pub(super) const SET_SAMPLES: u32 = 8192;
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
    weighs_from_light: u32,
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

/// `AttenuationScale` of `attenuation.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct AttenuationScale {
    halvings: f32,
    shares: f32,
}

impl AttenuationScale {
    fn of(attenuation: Attenuation) -> Self {
        match attenuation {
            Attenuation::Logarithmic => Self { halvings: (1.0 / UNITS_PER_HALVING) as f32, shares: 0.0 },
            Attenuation::Sum => Self { halvings: 0.0, shares: (1.0 / UNITS_PER_WHOLE) as f32 },
        }
    }
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
    let sampling = settings.sampling(pass);
    let samples = light_buffers::values(request, light, &sampling, &mut values)?;
    interleaving::values(request, &sampling, &mut values);
    let record = Sampling::new(request, &sampling, pass, settings.passes);
    values.insert("sampling".into(), bytemuck::bytes_of(&record).to_vec());

    let local = &request.scene.local.frame;
    let frame = LightFrame::new(light, local);
    let corners = match &frame.outline {
        Some(Outline::Polygon(corners)) => corners.clone(),
        _ => Vec::new(),
    };
    let answers = area_answers(request, settings);
    let record = FrameRecord {
        weighs_from_light: u32::from(settings.silhouettes == Silhouettes::Standard),
        ..frame_record(&frame, settings.samples, if answers { corners.len() } else { 0 })
    };
    values.insert("light frame".into(), bytemuck::bytes_of(&record).to_vec());
    let padded = |points: &[[f32; 2]], length: usize| -> Vec<u8> {
        let mut rows: Vec<[f32; 4]> = points.iter().take(length).map(|p| [p[0], p[1], 0.0, 0.0]).collect();
        rows.resize(length, [0.0; 4]);
        bytemuck::cast_slice(&rows).to_vec()
    };
    values.insert("light outline".into(), padded(&corners, MOST_CORNERS));
    let mut placed = frame.samples(light, &samples);
    let shared = shares_samples(light, settings);
    if shared {
        values.insert("frame samples".into(), padded(&placed, MOST_SAMPLES as usize));
    }
    let (tile_count, receiver_count) = (tiles(request), request.block.count as u32);
    let edge_count = request.occluders.map_or(0, |o| o.edge_count);
    let range = ClusterRange { edge_count, cluster_count: edge_count.div_ceil(CLUSTER), tile_count, receiver_count };
    values.insert("cluster range".into(), bytemuck::bytes_of(&range).to_vec());
    for group in 0..settings.samples.div_ceil(GROUP) {
        let here = GROUP.min(settings.samples - group * GROUP);
        let fold = FoldSettings {
            slot_count: receiver_count,
            group,
            sampling_bound: SAMPLING_BOUND * (here as f32).powf(-0.75),
            tile_count,
        };
        values.insert(format!("fold settings {group}"), bytemuck::bytes_of(&fold).to_vec());
        let first = (group * GROUP) as usize;
        let samples = &placed[first..first + here as usize];
        if settings.spread == SampleSpread::Correlated {
            values.insert(format!("group samples {group}"), padded(samples, GROUP as usize));
        }
        if shared {
            let table = coverage_table(samples, settings.coverage);
            values.insert(format!("coverage table {group}"), bytemuck::cast_slice(&table).to_vec());
        }
    }
    if let Some(occluders) = request.occluders {
        if unit_of(request, settings, occluders) == Unit::Triangles {
            covered::values(request, occluders, &placed, &mut values);
        }
        touching::values(occluders, &mut values);
    }
    if !shared {
        placed.resize(SET_SAMPLES as usize, [0.0; 2]);
        values.insert("sample sets".into(), bytemuck::cast_slice(&placed).to_vec());
    }
    let scale = AttenuationScale::of(settings.attenuation);
    values.insert("attenuation scale".into(), bytemuck::bytes_of(&scale).to_vec());
    values.insert("receiver order".into(), bytemuck::cast_slice(&order(request)).to_vec());
    shading::values(request, settings.passes, &mut values);
    if let (Evaluation::Blended, ReceiverSource::Camera(camera)) = (settings.evaluation, request.receivers) {
        blended::values(request, settings, &camera.local(local), &mut values);
    }
    Ok(values)
}

/// Whether one set of samples serves all receivers from one place. A sphere's move with the receiver, and tiles take them for its own.
pub(super) fn shares_samples(light: &Light, settings: &DepthComplexity) -> bool {
    let stands_still =
        settings.evaluation == Evaluation::Blended || !matches!(light.shape(), LightShape::Sphere { .. });
    settings.spread == SampleSpread::Correlated && stands_still
}

/// Whether the visible area answers: it is asked for, it is what visibility is a share of, and its outline fits. A texture's light is in its
/// samples, whatever light of the call it belongs to; and an area under a layer that lets light through is no visibility.
pub(super) fn area_answers(request: &Request<'_>, settings: &DepthComplexity) -> bool {
    let fits = match LightFrame::new(request.light, &request.scene.local.frame).outline {
        Some(Outline::Polygon(corners)) => corners.len() <= MOST_CORNERS,
        Some(Outline::Disc(_)) => true,
        None => false,
    };
    settings.exact_area && fits && request.channels == 1 && !is_attenuated(request)
}

/// Whether anything semi-opaque lies before the light.
pub(super) fn is_attenuated(request: &Request<'_>) -> bool {
    request.occluders.is_some_and(|occluders| occluders.is_semi_opaque)
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
