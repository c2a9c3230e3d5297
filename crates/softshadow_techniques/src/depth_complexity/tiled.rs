//! The passes of the tiled path: receivers in tiles of 64, a list of edges for each, counters folded over it.

use softshadow_plan::{Kernel, Over, Plan, ResourceId};
use softshadow_scene::{LightShape, Outline};

use super::values::{ClusterRange, FoldSettings, GROUP, MOST_CORNERS, area_answers, light_outline};
use super::{DepthComplexity, Reads};
use crate::parts::occluder_buffers::OccluderContents;
use crate::request::Request;

/// Label of what the passes over the lists report: parts, chunks, edges, unfinished receivers, receivers by area.
pub const LIST_COUNTS: &str = "list counts";

/// Receivers of a tile.
pub(super) const TILE: u32 = 64;
/// Edges of a cluster, and clusters of a group.
pub(super) const CLUSTER: u32 = 32;
/// Strides in which a pass takes its groups.
const STRIDES: u32 = 32;
/// Bundles of a tile.
const BUNDLES: u32 = 8;
/// Bytes of the head of the lists of a part of a tile.
const HEAD_BYTES: u64 = 40;
/// Bytes of a chunk of a list of edges.
const CHUNK_BYTES: u64 = 128;
/// Chunks of lists that a tile gets on average: 1,920 edges.
const CHUNKS_PER_TILE: u64 = 64;
/// Bytes of `ListCounts`.
pub(super) const COUNT_BYTES: u64 = 32;
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
const LIST_FACES: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "list_faces" };
const BOUND_TILES: Kernel = Kernel { file: "depth_complexity/bound_tiles.wgsl", entry: "bound_tiles" };
const CULL: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "cull" };
const NARROW: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "narrow" };
const SIZE_FOLD: Kernel = Kernel { file: "depth_complexity/size_fold.wgsl", entry: "size_fold" };
const FOLD: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold" };
const FOLD_QUADRANGLE: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_quadrangle" };
const FOLD_POLYGON: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_polygon" };
const FOLD_DISC: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_disc" };
const FOLD_MOVING: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_moving" };

/// Bytes of the lists that one receiver takes, on average.
pub(super) fn list_bytes_per_receiver() -> u64 {
    (2 * (PART_BYTES + HEAD_BYTES + u64::from(BUNDLES) * 4) + CHUNKS_PER_TILE * CHUNK_BYTES).div_ceil(u64::from(TILE))
}

/// Items of a pass that takes groups of 64 in strides.
pub(super) fn scattered(items: u32) -> u32 {
    items.div_ceil(64).next_multiple_of(STRIDES) * 64
}

/// Tiles of a block.
pub(super) fn tiles(request: &Request<'_>) -> u32 {
    (request.block.count as u32).div_ceil(TILE)
}

/// The passes from occluders to masks; returns the visible areas, where those answer.
pub(super) fn append_fold(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    occluders: &OccluderContents,
    reads: &Reads,
) -> Option<ResourceId> {
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
    let lists = plan.buffer("edge lists", u64::from(tile_count) * (2 * HEAD_BYTES + CHUNKS_PER_TILE * CHUNK_BYTES));
    let areas = area_answers(request, settings).then(|| {
        let areas = plan.buffer("visible areas", request.block.count as u64 * 4);
        plan.clear("no areas", "samples answer, unless a fold finds an area", areas);
        areas
    });
    let counts = plan.buffer("running counts", COUNT_BYTES);
    plan.clear("no counts", "nothing is counted yet", counts);
    let items = |count: u32, work_per_item: u32| Over::Items { count, work_per_item };

    let why = "bounds the receivers of each tile, and the shaft between them and the light";
    plan.compute("bound tiles", why, BOUND_TILES, items(tile_count, 64))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("parts", parts);
    let why = "finds the tiles with any face between them and the light";
    plan.compute("find faces", why, FIND_FACES, items(2 * tile_count, 64))
        .bind("face_tree", face_tree)
        .bind("parts", parts);
    let first_faces = plan.buffer("first faces", u64::from(2 * tile_count * BUNDLES) * 4);
    let why = "lists for every eight receivers the faces that can lie between them and one point of the light";
    plan.compute("list faces", why, LIST_FACES, items(scattered(2 * tile_count * BUNDLES), 64))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("face_tree", face_tree)
        .bind("edges", edges)
        .bind("parts", parts)
        .bind("first_faces", first_faces)
        .bind("lists", lists)
        .bind("counts", counts);
    let why = "counts the layers over one point of the light";
    plan.compute("count reference depth", why, REFERENCE_DEPTH, items(scattered(tile_count * TILE), 4))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("receivers", reads.receivers)
        .bind("faces", faces)
        .bind("edges", edges)
        .bind("first_faces", first_faces)
        .bind("lists", lists)
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
    let narrow_size = plan.buffer("narrow dispatch", 12);
    plan.compute("size fold", "sizes the dispatches over the tiles that have edges", SIZE_FOLD, items(1, 1))
        .bind("light_frame", reads.frame)
        .bind("counts", counts)
        .bind("dispatch_size", size)
        .bind("narrow_size", narrow_size);
    let why = "lists for every eight receivers those edges of their tile that can be silhouettes before them";
    plan.compute("narrow edges", why, NARROW, Over::Indirect(narrow_size))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", range)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("lists", lists)
        .bind("counts", counts);
    let moving = matches!(request.light.shape(), LightShape::Sphere { .. });
    let area_kernel = match light_outline(request) {
        Some(Outline::Disc(_)) => FOLD_DISC,
        Some(Outline::Polygon(corners)) if corners.len() == 4 => FOLD_QUADRANGLE,
        _ => FOLD_POLYGON,
    };
    for group in 0..settings.samples.div_ceil(GROUP) {
        let group_samples = plan.parameter(format!("group samples {group}"), u64::from(GROUP) * 16);
        let fold_settings = plan.parameter(format!("fold settings {group}"), size_of::<FoldSettings>() as u64);
        let areas = areas.filter(|_| group == 0);
        let (kernel, why) = match areas {
            Some(_) => (area_kernel, "adds up what changes at each edge for 64 samples, and the area beyond it"),
            None if moving => {
                (FOLD_MOVING, "adds up what changes at each edge for 64 samples that move with the receiver")
            }
            None => (FOLD, "adds up what changes at each edge for 64 samples"),
        };
        let outline = areas.map(|_| plan.parameter("light outline", MOST_CORNERS as u64 * 16));
        let pass = plan.compute(format!("fold edges {group}"), why, kernel, Over::Indirect(size));
        pass.bind("light_frame", reads.frame)
            .bind("group_samples", group_samples)
            .bind("fold_settings", fold_settings)
            .bind("receivers", reads.receivers)
            .bind("edges", edges)
            .bind("incident_faces", incident_faces)
            .bind("slots", reads.slots)
            .bind("lists", lists)
            .bind("blocked", reads.blocked)
            .bind("counts", counts);
        if let (Some(areas), Some(outline)) = (areas, outline) {
            pass.bind("areas", areas).bind("outline", outline);
        }
    }
    let report = plan.buffer(LIST_COUNTS, COUNT_BYTES);
    let why = "tells how many edges there were, what areas answered, and whether anything did not fit";
    plan.copy("report counts", why, [counts, report], COUNT_BYTES);
    plan.outputs.push(report);
    areas
}
