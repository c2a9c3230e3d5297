//! The passes of the triangle-wise path: no tiles, no lists, no counters.

use softshadow_plan::{Kernel, Over, Plan, Values};
use softshadow_scene::LightShape;

use super::tiled::{COUNT_BYTES, LIST_COUNTS, scattered};
use super::values::GROUP;
use super::{DepthComplexity, Reads};
use crate::parts::occluder_buffers::OccluderContents;
use crate::request::Request;

const COVER_FACES: Kernel = Kernel { file: "depth_complexity/cover_faces.wgsl", entry: "cover_faces" };
const COVER_MOVING: Kernel = Kernel { file: "depth_complexity/cover_faces.wgsl", entry: "cover_moving" };

/// Strips into which either axis of the light is cut.
const BINS: usize = 63;
/// Steps of one round.
const ROUND_STEPS: u64 = 7000;
/// Steps that a face takes at most: its own, its leaf's, and four sides of 64 samples each.
const FACE_STEPS: u64 = 14 + 4 * 64;
/// Rounds at most. A receiver that needs more is reported.
const MOST_ROUNDS: u64 = 16;

/// `CoverSettings` of `cover_faces.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CoverSettings {
    receiver_count: u32,
    group: u32,
    round: u32,
    rounds: u32,
}

/// `SampleBins` of `sample_bins.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SampleBins {
    low: [f32; 2],
    scale: [f32; 2],
    before: [[u32; 4]; 64],
}

impl SampleBins {
    fn new(samples: &[[f32; 2]]) -> Self {
        let mut bins = Self { low: [0.0; 2], scale: [0.0; 2], before: [[0; 4]; BINS + 1] };
        for axis in 0..2 {
            let places = || samples.iter().map(|s| s[axis]);
            let (low, high) = (places().fold(f32::INFINITY, f32::min), places().fold(f32::NEG_INFINITY, f32::max));
            let width = high - low;
            // A trifle less, so that the last sample lies in the last strip.
            let scale = if width > 0.0 { (BINS as f32 - 0.01) / width } else { 0.0 };
            (bins.low[axis], bins.scale[axis]) = (low, scale);
            for (index, place) in places().enumerate() {
                let strip = ((place - low) * scale) as usize;
                for row in &mut bins.before[strip + 1..] {
                    row[2 * axis + index / 32] |= 1 << (index % 32);
                }
            }
        }
        bins
    }
}

/// How often an invocation can have to go on, at most.
fn rounds(occluders: &OccluderContents) -> u32 {
    let nodes = 2 * u64::from(occluders.face_count);
    (nodes + FACE_STEPS * u64::from(occluders.face_count)).div_ceil(ROUND_STEPS).clamp(1, MOST_ROUNDS) as u32
}

/// The passes from triangles to masks.
pub(super) fn append_covers(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    occluders: &OccluderContents,
    reads: &Reads,
) {
    let faces = plan.uploaded("faces", &occluders.faces);
    let face_tree = plan.uploaded("face hierarchy", &occluders.face_tree);
    let face_corners = plan.uploaded("corners of faces", &occluders.face_corners);
    let counts = plan.buffer("running counts", COUNT_BYTES);
    plan.clear("no counts", "nothing is counted yet", counts);
    let kernel = if matches!(request.light.shape(), LightShape::Sphere { .. }) { COVER_MOVING } else { COVER_FACES };
    for group in 0..settings.samples.div_ceil(GROUP) {
        let group_samples = plan.parameter(format!("group samples {group}"), u64::from(GROUP) * 16);
        let bins = plan.parameter(format!("sample bins {group}"), size_of::<SampleBins>() as u64);
        for round in 0..rounds(occluders) {
            let label = format!("cover settings {group}.{round}");
            let cover_settings = plan.parameter(label, size_of::<CoverSettings>() as u64);
            let why = match round {
                0 => "ORs what each triangle hides of 64 samples",
                _ => "goes on where a driver would have ended the loop",
            };
            let over = Over::Items { count: scattered(request.block.count as u32), work_per_item: 64 };
            plan.compute(format!("cover triangles {group}.{round}"), why, kernel, over)
                .bind("light_frame", reads.frame)
                .bind("group_samples", group_samples)
                .bind("sample_bins", bins)
                .bind("cover_settings", cover_settings)
                .bind("receivers", reads.receivers)
                .bind("faces", faces)
                .bind("face_corners", face_corners)
                .bind("face_tree", face_tree)
                .bind("slots", reads.slots)
                .bind("blocked", reads.blocked)
                .bind("counts", counts);
        }
    }
    let report = plan.buffer(LIST_COUNTS, COUNT_BYTES);
    plan.copy("report counts", "tells whether any receiver was not finished", [counts, report], COUNT_BYTES);
    plan.outputs.push(report);
}

/// The values of their parameters.
pub(super) fn values(request: &Request<'_>, occluders: &OccluderContents, samples: &[[f32; 2]], values: &mut Values) {
    let rounds = rounds(occluders);
    for (group, samples) in (0..).zip(samples.chunks(GROUP as usize)) {
        values.insert(format!("sample bins {group}"), bytemuck::bytes_of(&SampleBins::new(samples)).to_vec());
        for round in 0..rounds {
            let settings = CoverSettings { receiver_count: request.block.count as u32, group, round, rounds };
            values.insert(format!("cover settings {group}.{round}"), bytemuck::bytes_of(&settings).to_vec());
        }
    }
}
