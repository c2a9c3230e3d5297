//! # `depth_complexity`: silhouette edges instead of rays
//!
//! V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by Depth Complexity Sampling", Computer Graphics Forum 27(2), 2008.
//!
//! The number of triangles between a receiver and a light sample is counted at one reference point of the light, by a ray, and changes
//! only at the images of silhouette edges. So a receiver folds the edges between it and the light into one counter a sample, 64 samples at
//! a time; a sample is visible where its counter is 0. What counts as which side is decided once for each edge and face
//! (`softshadow_native::depth_complexity` is the same in Rust, and says why), so the answer is that of rays to the same samples.
//!
//! Beyond the paper: edges are not rasterised as wedges. Receivers are taken in tiles; every tile lists the edges that can be
//! silhouettes in the shaft between it and the light. And where the counters show a single depth, the *area* beyond the edges answers,
//! without sampling noise.
//!
//! **Parameters.** `samples` a pass, up to 256; `pattern`, `seed`, `passes` as for `ray_traced`; `exact_area`.
//!
//! **When it is wrong.** Areas are wrong where layers overlap between the samples (the first 64 of them say whether; at most by the
//! sampler's own error). They answer for rectangles, discs, polygons of up to 64 corners and suns up to half a degree; not for spheres and
//! wider suns, whose measure is solid angle, and for no light of a call in which any has a texture. Samples are off as for `ray_traced`. Foliage has no surface to take silhouettes of: every leaf's border is an edge, lists grow long, and the call ends
//! with an error that names `ray_traced`. Triangles that touch a sphere light are refused.

use serde::{Deserialize, Serialize};
use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};
use softshadow_scene::{Light, LightFrame, LightKind, LightSamples, Outline, SamplePattern, pass_seed};

use crate::TechniqueError;
use crate::parts::light_buffers::{self, SampleSet, Sampling};
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::pattern_name;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{receivers, resolve, shading};
use crate::request::{ReceiverSource, Request};

/// Settings of `depth_complexity`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DepthComplexity {
    /// Light samples of one pass, 1 to 256.
    pub samples: u32,
    /// How they are spread.
    #[serde(with = "pattern_name")]
    pub pattern: SamplePattern,
    /// Which set of them.
    pub seed: u32,
    /// Progressive passes.
    pub passes: u32,
    /// Whether the light's visible area answers where a single layer hides it.
    pub exact_area: bool,
}

impl Default for DepthComplexity {
    fn default() -> Self {
        Self { samples: 64, pattern: SamplePattern::Stratified, seed: 0, passes: 1, exact_area: true }
    }
}

/// Label of what the passes over the lists report: parts, chunks, edges, unfinished receivers, receivers by area.
pub const LIST_COUNTS: &str = "list counts";

/// Samples of one set at most: as many as one uniform holds.
const MOST_SAMPLES: u32 = 256;
/// Corners of a polygon light at most.
const MOST_CORNERS: usize = 64;
/// Receivers of a tile.
const TILE: u32 = 64;
/// Edges of a cluster, and clusters of a group.
const CLUSTER: u32 = 32;
/// Bytes of a chunk of a list of edges.
const CHUNK_BYTES: u64 = 128;
/// Chunks of lists that a tile gets on average: 1,920 edges.
const CHUNKS_PER_TILE: u64 = 64;
/// Bytes of `ListCounts`.
const COUNT_BYTES: u64 = 32;
/// Bytes of `TilePart`.
const PART_BYTES: u64 = 112;
/// Bytes of `Slot`.
const SLOT_BYTES: u64 = 16;
/// Bytes of `Cluster`.
const CLUSTER_BYTES: u64 = 32;
/// An area is not believed when it differs from the samples' share by more than this over `samples^(3/4)`: twice the largest error seen
/// for stratified samples of a half plane.
const SAMPLING_BOUND: f32 = 2.0;

const SILHOUETTES: Kernel = Kernel { file: "depth_complexity/silhouettes.wgsl", entry: "silhouettes" };
const BOUND_CLUSTERS: Kernel = Kernel { file: "depth_complexity/bound_clusters.wgsl", entry: "bound_clusters" };
const OPEN_MASKS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks" };
const FIND_FACES: Kernel = Kernel { file: "depth_complexity/find_faces.wgsl", entry: "find_faces" };
const REFERENCE_DEPTH: Kernel = Kernel { file: "depth_complexity/reference_depth.wgsl", entry: "reference_depth" };
const BOUND_TILES: Kernel = Kernel { file: "depth_complexity/bound_tiles.wgsl", entry: "bound_tiles" };
const CULL: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "cull" };
const SIZE_FOLD: Kernel = Kernel { file: "depth_complexity/size_fold.wgsl", entry: "size_fold" };
const FOLD: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold" };

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
    wants_area: u32,
    sampling_bound: f32,
    tile_count: u32,
}

impl DepthComplexity {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        let fail =
            |setting, reason: String| Err(TechniqueError::Setting { technique: "depth_complexity", setting, reason });
        if self.samples == 0 || self.samples > MOST_SAMPLES {
            let reason = format!("must lie between 1 and {MOST_SAMPLES}, got {}; more come as passes", self.samples);
            return fail("samples", reason);
        }
        if self.passes == 0 {
            return fail("passes", "must be at least 1".into());
        }
        Ok(())
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64) -> u64 {
        let per_tile = 2 * PART_BYTES + 16 + CHUNKS_PER_TILE * CHUNK_BYTES;
        // Order, slot, mask, decided samples, area; its part of a tile; values and their errors.
        4 + SLOT_BYTES + u64::from(self.words()) * 4 + 4 + 4 + per_tile.div_ceil(u64::from(TILE)) + 8 * channels
    }

    fn words(&self) -> u32 {
        self.samples.div_ceil(32)
    }
}

fn tiles(request: &Request<'_>) -> u32 {
    (request.block.count as u32).div_ceil(TILE)
}

/// Depth of the reference point for every receiver; lists of edges for every tile; counters folded over them.
pub(crate) fn plan(request: &Request<'_>, settings: &DepthComplexity) -> Plan {
    let mut plan = Plan::new("depth complexity");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = light_buffers::append(&mut plan, settings.samples);
    let frame = plan.parameter("light frame", size_of::<FrameRecord>() as u64);
    let samples = plan.parameter("frame samples", u64::from(MOST_SAMPLES) * 16);
    let order = plan.parameter("receiver order", count as u64 * 4);
    let slots = plan.buffer("slots", u64::from(tiles(request) * TILE) * SLOT_BYTES);
    let blocked = plan.buffer(BLOCKED, count as u64 * u64::from(settings.words()) * 4);
    let items = |n: u32, work_per_item: u32| Over::Items { count: n, work_per_item };
    let why = "blocks what lies below the horizon or behind the light";
    plan.compute("open masks", why, OPEN_MASKS, items(count as u32, settings.words()))
        .bind("light_frame", frame)
        .bind("frame_samples", samples)
        .bind("receivers", receivers)
        .bind("order", order)
        .bind("slots", slots)
        .bind("blocked", blocked);
    let reads = Reads { frame, samples, receivers, slots, blocked };
    let occluders = request.occluders.filter(|occluders| occluders.edge_count > 0);
    let areas = occluders.map(|occluders| append_fold(&mut plan, request, occluders, &reads));

    let decided = plan.buffer("decided samples", count as u64 * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks = Masks { blocked, decided, areas: areas.filter(|_| settings.exact_area) };
    resolve::append(&mut plan, request, settings.samples, &light, receivers, masks);
    plan
}

/// What several passes read.
struct Reads {
    frame: ResourceId,
    samples: ResourceId,
    receivers: ResourceId,
    slots: ResourceId,
    blocked: ResourceId,
}

/// The passes from occluders to masks; returns the visible areas.
fn append_fold(plan: &mut Plan, request: &Request<'_>, occluders: &OccluderContents, reads: &Reads) -> ResourceId {
    let clusters_in = |n: u32| n.div_ceil(CLUSTER);
    let (cluster_count, tile_count) = (clusters_in(occluders.edge_count), tiles(request));
    let faces = plan.uploaded("faces", &occluders.faces);
    let face_tree = plan.uploaded("face hierarchy", &occluders.face_tree);
    let edges = plan.uploaded("edges", &occluders.edges);
    let incident_faces = plan.uploaded("faces at edges", &occluders.incident_faces);
    let range = plan.parameter("cluster range", size_of::<ClusterRange>() as u64);
    let clusters = plan.buffer("clusters", u64::from(cluster_count) * CLUSTER_BYTES);
    let groups = plan.buffer("groups of clusters", u64::from(clusters_in(cluster_count)) * CLUSTER_BYTES);
    let parts = plan.buffer("tile parts", 2 * u64::from(tile_count) * PART_BYTES);
    let lists = plan.buffer("edge lists", u64::from(tile_count) * (16 + CHUNKS_PER_TILE * CHUNK_BYTES));
    let areas = plan.buffer("visible areas", request.block.count as u64 * 4);
    let counts = plan.buffer("running counts", COUNT_BYTES);
    plan.clear("no counts", "nothing is counted yet", counts);
    let items = |count: u32, work_per_item: u32| Over::Items { count, work_per_item };

    let why = "bounds the receivers of each tile, and the shaft between them and the light";
    plan.compute("bound tiles", why, BOUND_TILES, items(tile_count, 64))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("parts", parts)
        .bind("areas", areas);
    let why = "finds the tiles with any face between them and the light";
    plan.compute("find faces", why, FIND_FACES, items(2 * tile_count, 64))
        .bind("face_tree", face_tree)
        .bind("parts", parts);
    let why = "counts the layers over one point of the light";
    plan.compute("count reference depth", why, REFERENCE_DEPTH, items(request.block.count as u32, 4))
        .bind("light_frame", reads.frame)
        .bind("receivers", reads.receivers)
        .bind("faces", faces)
        .bind("edges", edges)
        .bind("face_tree", face_tree)
        .bind("parts", parts)
        .bind("slots", reads.slots)
        .bind("blocked", reads.blocked)
        .bind("counts", counts);
    let why = "finds the edges that can be silhouettes over any part of the light";
    plan.compute("find silhouettes", why, SILHOUETTES, items(cluster_count, 16))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("clusters", clusters);
    let why = "bounds 32 clusters of edges at a time";
    plan.compute("bound clusters", why, BOUND_CLUSTERS, items(clusters_in(cluster_count), 8))
        .bind("cluster_range", range)
        .bind("clusters", clusters)
        .bind("groups_of_clusters", groups);
    let why = "lists for each tile the edges that can be silhouettes in its shaft";
    plan.compute("cull edges", why, CULL, items(2 * tile_count, 512))
        .bind("cluster_range", range)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("clusters", clusters)
        .bind("groups_of_clusters", groups)
        .bind("parts", parts)
        .bind("lists", lists)
        .bind("counts", counts);
    let size = plan.buffer("fold dispatch", 12);
    plan.compute("size fold", "sizes the dispatch over the tiles that have edges", SIZE_FOLD, items(1, 1))
        .bind("light_frame", reads.frame)
        .bind("counts", counts)
        .bind("dispatch_size", size);
    let settings = plan.parameter("fold settings", size_of::<FoldSettings>() as u64);
    let outline = plan.parameter("light outline", MOST_CORNERS as u64 * 16);
    let why = "adds up what changes at each edge, for 64 samples at a time, and the area beyond it";
    plan.compute("fold edges", why, FOLD, Over::Indirect(size))
        .bind("light_frame", reads.frame)
        .bind("frame_samples", reads.samples)
        .bind("fold_settings", settings)
        .bind("outline", outline)
        .bind("receivers", reads.receivers)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("slots", reads.slots)
        .bind("lists", lists)
        .bind("blocked", reads.blocked)
        .bind("areas", areas)
        .bind("counts", counts);
    let report = plan.buffer(LIST_COUNTS, COUNT_BYTES);
    let why = "tells how many edges there were, what areas answered, and whether anything did not fit";
    plan.copy("report counts", why, [counts, report], COUNT_BYTES);
    plan.outputs.push(report);
    areas
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
    // A polygon of more corners than fit is answered by samples.
    let has_area = frame.outline.is_some() && corners.len() <= MOST_CORNERS;
    let record = frame_record(&frame, settings.samples, if has_area { corners.len() } else { 0 });
    values.insert("light frame".into(), bytemuck::bytes_of(&record).to_vec());
    let padded = |points: &[[f32; 2]], length: usize| -> Vec<u8> {
        let mut rows: Vec<[f32; 4]> = points.iter().take(length).map(|p| [p[0], p[1], 0.0, 0.0]).collect();
        rows.resize(length, [0.0; 4]);
        bytemuck::cast_slice(&rows).to_vec()
    };
    values.insert("light outline".into(), padded(&corners, MOST_CORNERS));
    let samples = LightSamples::new(light, local, set.pattern, set.count, set.seed)?;
    values.insert("frame samples".into(), padded(&frame.samples(light, &samples), MOST_SAMPLES as usize));

    let (tile_count, receiver_count) = (tiles(request), request.block.count as u32);
    let edge_count = request.occluders.map_or(0, |o| o.edge_count);
    let range = ClusterRange { edge_count, cluster_count: edge_count.div_ceil(CLUSTER), tile_count, receiver_count };
    values.insert("cluster range".into(), bytemuck::bytes_of(&range).to_vec());
    let fold = FoldSettings {
        slot_count: receiver_count,
        wants_area: u32::from(settings.exact_area && has_area && request.channels == 1),
        // Areas are checked against the first 64 samples, which one invocation holds.
        sampling_bound: SAMPLING_BOUND * (settings.samples.min(64) as f32).powf(-0.75),
        tile_count,
    };
    values.insert("fold settings".into(), bytemuck::bytes_of(&fold).to_vec());
    values.insert("receiver order".into(), bytemuck::cast_slice(&order(request)).to_vec());
    shading::values(request, settings.passes, &mut values);
    Ok(values)
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

/// Receivers of a block in the order of the tiles: pixels in squares of 8 × 8, points along a space-filling curve.
fn order(request: &Request<'_>) -> Vec<u32> {
    let count = request.block.count;
    match request.receivers {
        ReceiverSource::Camera(camera) => {
            let width = camera.size()[0] as usize;
            let rows = count / width.max(1);
            let mut order = Vec::with_capacity(count);
            for (top, left) in (0..rows).step_by(8).flat_map(|top| (0..width).step_by(8).map(move |left| (top, left))) {
                for row in top..(top + 8).min(rows) {
                    order.extend((left..(left + 8).min(width)).map(|column| (row * width + column) as u32));
                }
            }
            order
        }
        ReceiverSource::Points(points) => {
            let frame = &request.scene.local.frame;
            let block = request.block;
            let positions: Vec<glam::DVec3> = points.positions()[block.first..block.first + count]
                .iter()
                .map(|p| frame.local_from_world(*p))
                .collect();
            let low = positions.iter().fold(glam::DVec3::INFINITY, |low, p| low.min(*p));
            let high = positions.iter().fold(glam::DVec3::NEG_INFINITY, |high, p| high.max(*p));
            let size = (high - low).max_element().max(f64::MIN_POSITIVE);
            let mut keyed: Vec<(u64, u32)> =
                (0..).zip(&positions).map(|(index, p)| (morton((*p - low) / size), index)).collect();
            keyed.sort_unstable();
            keyed.into_iter().map(|(_, index)| index).collect()
        }
    }
}

/// The place of a point of the unit cube on Morton's curve, 16 bits an axis.
fn morton(p: glam::DVec3) -> u64 {
    let spread = |x: f64| {
        let bits = (x * 65_535.0) as u64;
        (0..16).fold(0, |key, bit| key | (bits >> bit & 1) << (3 * bit))
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}
