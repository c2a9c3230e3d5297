//! The passes of the tiled path: receivers in tiles of 64, a list of edges for each, counters folded over it.

use softshadow_plan::{Kernel, Over, Plan, ResourceId};

use super::values::{ClusterRange, FoldSettings, MOST_CORNERS};
use super::{Attenuated, Reads};
use crate::parts::occluder_buffers::OccluderContents;
use crate::request::Request;

/// Label of what the passes over the lists report: parts, chunks, edges, unfinished receivers, receivers by area, overflowed receivers.
pub const LIST_COUNTS: &str = "list counts";

/// Receivers of a tile.
pub(super) const TILE: u32 = 64;
/// Edges of a cluster, and clusters of a group.
pub(super) const CLUSTER: u32 = 32;
/// Bytes of a chunk of a list of edges.
const CHUNK_BYTES: u64 = 128;
/// Chunks of lists that a tile gets on average: 1,920 edges.
const CHUNKS_PER_TILE: u64 = 64;
/// Bytes of `ListCounts`.
const COUNT_BYTES: u64 = 32;
/// Bytes of `TilePart`.
const PART_BYTES: u64 = 112;
/// Bytes of `Slot`.
pub(super) const SLOT_BYTES: u64 = 16;
/// Bytes of `Cluster`.
const CLUSTER_BYTES: u64 = 32;

const SILHOUETTES: Kernel = Kernel { file: "depth_complexity/silhouettes.wgsl", entry: "silhouettes" };
const BOUND_CLUSTERS: Kernel = Kernel { file: "depth_complexity/bound_clusters.wgsl", entry: "bound_clusters" };
const FIND_FACES: Kernel = Kernel { file: "depth_complexity/find_faces.wgsl", entry: "find_faces" };
const REFERENCE_DEPTH: Kernel = Kernel { file: "depth_complexity/reference_depth.wgsl", entry: "reference_depth" };
const BOUND_TILES: Kernel = Kernel { file: "depth_complexity/bound_tiles.wgsl", entry: "bound_tiles" };
const CULL: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "cull" };
const SIZE_FOLD: Kernel = Kernel { file: "depth_complexity/size_fold.wgsl", entry: "size_fold" };
const FOLD: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold" };
const REFERENCE_DEPTH_ATTENUATED: Kernel =
    Kernel { file: "depth_complexity/reference_depth.wgsl", entry: "reference_depth_attenuated" };
const SPREAD_REFERENCE: Kernel = Kernel { file: "depth_complexity/spread_reference.wgsl", entry: "spread_reference" };
const FOLD_ATTENUATED: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_attenuated" };

/// Bytes of the lists that one receiver takes, on average.
pub(super) fn list_bytes_per_receiver() -> u64 {
    (2 * PART_BYTES + 16 + CHUNKS_PER_TILE * CHUNK_BYTES).div_ceil(u64::from(TILE))
}

/// Tiles of a block.
pub(super) fn tiles(request: &Request<'_>) -> u32 {
    (request.block.count as u32).div_ceil(TILE)
}

/// The passes from occluders to masks; returns the visible areas.
pub(super) fn append_fold(
    plan: &mut Plan,
    request: &Request<'_>,
    occluders: &OccluderContents,
    reads: &Reads,
    attenuated: Option<&Attenuated>,
) -> ResourceId {
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
    let kernel = if attenuated.is_some() { REFERENCE_DEPTH_ATTENUATED } else { REFERENCE_DEPTH };
    let pass = plan.compute("count reference depth", why, kernel, items(request.block.count as u32, 4));
    pass.bind("light_frame", reads.frame)
        .bind("receivers", reads.receivers)
        .bind("faces", faces)
        .bind("edges", edges)
        .bind("face_tree", face_tree)
        .bind("parts", parts)
        .bind("slots", reads.slots);
    match attenuated {
        None => pass.bind("blocked", reads.blocked),
        Some(passing) => pass.bind("triangle_attenuation", passing.triangles),
    };
    pass.bind("counts", counts);
    if let Some(passing) = attenuated {
        let why = "spreads what passes to that point over all samples";
        plan.compute("spread reference", why, SPREAD_REFERENCE, items(request.block.count as u32, 4))
            .bind("light_frame", reads.frame)
            .bind("attenuation_scale", passing.scale)
            .bind("slots", reads.slots)
            .bind("sample_transmittance", passing.samples);
    }
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
    let (kernel, why) = match attenuated {
        None => (FOLD, "adds up what changes at each edge, for 64 samples at a time, and the area beyond it"),
        Some(_) => (FOLD_ATTENUATED, "adds up opaque layers and attenuation at each edge, for 64 samples at a time"),
    };
    let outline = attenuated.is_none().then(|| plan.parameter("light outline", MOST_CORNERS as u64 * 16));
    let pass = plan.compute("fold edges", why, kernel, Over::Indirect(size));
    pass.bind("light_frame", reads.frame).bind("frame_samples", reads.samples).bind("fold_settings", settings);
    if let Some(outline) = outline {
        pass.bind("outline", outline);
    }
    pass.bind("receivers", reads.receivers)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("slots", reads.slots)
        .bind("lists", lists);
    match attenuated {
        None => pass.bind("blocked", reads.blocked).bind("areas", areas),
        Some(passing) => pass
            .bind("attenuation_scale", passing.scale)
            .bind("triangle_attenuation", passing.triangles)
            .bind("sample_transmittance", passing.samples),
    };
    pass.bind("counts", counts);
    let report = plan.buffer(LIST_COUNTS, COUNT_BYTES);
    let why = "tells how many edges there were, what areas answered, and whether anything did not fit";
    plan.copy("report counts", why, [counts, report], COUNT_BYTES);
    plan.outputs.push(report);
    areas
}
