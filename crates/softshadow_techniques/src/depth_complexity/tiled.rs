//! The passes of the tiled path: receivers in tiles of 64, a list of edges for each, counters folded over it.

use softshadow_plan::{Kernel, Over, Plan, ResourceId};

use super::coverage_table::TABLE_BYTES;
use super::values::{ClusterRange, FoldSettings, GROUP, MOST_CORNERS, area_answers};
use super::{Attenuated, DepthComplexity, Reads, Samples, Silhouettes};
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
/// Chunks of lists that a tile and its bundles get on average, together: 3,840 edges and faces.
const CHUNKS_PER_TILE: u64 = 128;
/// Chunks beyond that, 8 MiB: a small image has few tiles, and each sees as much of the scene as many tiles of a large one.
const SPARE_CHUNKS: u64 = 65_536;
/// Bytes of `ListCounts`.
pub(super) const COUNT_BYTES: u64 = 32;
/// Bytes of `TilePart`.
pub(super) const PART_BYTES: u64 = 112;
/// Bytes of `Slot`.
pub(super) const SLOT_BYTES: u64 = 16;
/// Bytes of `Cluster`.
pub(super) const CLUSTER_BYTES: u64 = 32;

const SILHOUETTES: Kernel = Kernel { file: "depth_complexity/silhouettes.wgsl", entry: "silhouettes" };
const STANDARD_SILHOUETTES: Kernel =
    Kernel { file: "depth_complexity/silhouettes.wgsl", entry: "standard_silhouettes" };
const BOUND_CLUSTERS: Kernel = Kernel { file: "depth_complexity/bound_clusters.wgsl", entry: "bound_clusters" };
const FIND_FACES: Kernel = Kernel { file: "depth_complexity/find_faces.wgsl", entry: "find_faces" };
const REFERENCE_DEPTH: Kernel = Kernel { file: "depth_complexity/reference_depth.wgsl", entry: "reference_depth" };
const LIST_FACES: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "list_faces" };
const BOUND_TILES: Kernel = Kernel { file: "depth_complexity/bound_tiles.wgsl", entry: "bound_tiles" };
const CULL: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "cull" };
const NARROW: Kernel = Kernel { file: "depth_complexity/cull.wgsl", entry: "narrow" };
const SIZE_FOLD: Kernel = Kernel { file: "depth_complexity/size_fold.wgsl", entry: "size_fold" };
const FOLD: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold" };
const FOLD_AREAS: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_areas" };
const FOLD_OWN_SAMPLES: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_own_samples" };
const FOLD_OWN_SAMPLES_AREAS: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_own_samples_areas" };
const FOLD_ATTENUATED: Kernel = Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_attenuated" };
const FOLD_ATTENUATED_OWN_SAMPLES: Kernel =
    Kernel { file: "depth_complexity/fold.wgsl", entry: "fold_attenuated_own_samples" };
const REFERENCE_DEPTH_ATTENUATED: Kernel =
    Kernel { file: "depth_complexity/reference_depth.wgsl", entry: "reference_depth_attenuated" };
const SPREAD_REFERENCE: Kernel = Kernel { file: "depth_complexity/spread_reference.wgsl", entry: "spread_reference" };

/// Bytes of the lists that one receiver takes, on average.
pub(super) fn list_bytes_per_receiver() -> u64 {
    (2 * (PART_BYTES + HEAD_BYTES + u64::from(BUNDLES) * 4) + CHUNKS_PER_TILE * CHUNK_BYTES).div_ceil(u64::from(TILE))
}

/// Items of a pass that takes groups of 64 in strides.
pub(super) fn scattered(items: u32) -> u32 {
    items.div_ceil(64).next_multiple_of(STRIDES) * 64
}

/// Bytes of the lists of a block: their heads, and chunks.
pub(super) fn list_bytes(request: &Request<'_>) -> u64 {
    let tile_count = tiles(request);
    u64::from(tile_count) * (2 * HEAD_BYTES + CHUNKS_PER_TILE * CHUNK_BYTES) + SPARE_CHUNKS * CHUNK_BYTES
}

/// Bytes of the first chunk of the faces of every bundle.
pub(super) fn first_face_bytes(request: &Request<'_>) -> u64 {
    u64::from(2 * tiles(request) * BUNDLES) * 4
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
    attenuated: Option<&Attenuated>,
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
    let lists = plan.buffer("edge lists", list_bytes(request));
    let areas = area_answers(request, settings).then(|| {
        let areas = plan.buffer("visible areas", request.block.count as u64 * 4);
        plan.clear("no areas", "samples answer, unless a fold finds an area", areas);
        areas
    });
    let counts = plan.buffer("running counts", COUNT_BYTES);
    plan.clear("no counts", "nothing is counted yet", counts);
    let items = |count: u32, work_per_item: u32| Over::Items { count, work_per_item };
    let first_faces = plan.buffer("first faces", first_face_bytes(request));
    let stock = Stock { faces, face_tree, edges, range, parts, first_faces, lists, counts };
    append_depths(plan, request, reads, &stock, attenuated);
    append_silhouettes(plan, settings, occluders, reads, &EdgeStock { edges, incident_faces, range, clusters });
    let why = "bounds 32 clusters of edges at a time";
    plan.compute("bound clusters", why, BOUND_CLUSTERS, items(clusters_in(cluster_count), 8))
        .bind("cluster_range", range)
        .bind("clusters", clusters)
        .bind("groups_of_clusters", groups);
    let why = "lists for each tile the edges that can be silhouettes in its shaft";
    plan.compute("cull edges", why, CULL, items(2 * tile_count, 512))
        .bind("light_frame", reads.frame)
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
    for group in 0..settings.samples.div_ceil(GROUP) {
        let areas = areas.filter(|_| group == 0);
        let [plain, with_areas, attenuating] = match reads.samples {
            Samples::Shared(_) => [FOLD, FOLD_AREAS, FOLD_ATTENUATED],
            Samples::Own { .. } => [FOLD_OWN_SAMPLES, FOLD_OWN_SAMPLES_AREAS, FOLD_ATTENUATED_OWN_SAMPLES],
        };
        let (kernel, why) = match areas {
            _ if attenuated.is_some() => {
                (attenuating, "adds up opaque layers and attenuation at each edge for 64 samples")
            }
            Some(_) => (with_areas, "adds up what changes at each edge for 64 samples, and the area beyond it"),
            None => (plain, "adds up what changes at each edge for 64 samples"),
        };
        let fold_settings = plan.parameter(format!("fold settings {group}"), size_of::<FoldSettings>() as u64);
        let standing = match reads.samples {
            Samples::Shared(_) => Some([
                plan.parameter(format!("group samples {group}"), u64::from(GROUP) * 16),
                plan.parameter(format!("coverage table {group}"), TABLE_BYTES),
            ]),
            Samples::Own { .. } => None,
        };
        let outline = areas.map(|_| plan.parameter("light outline", MOST_CORNERS as u64 * 16));
        let pass = plan.compute(format!("fold edges {group}"), why, kernel, Over::Indirect(size));
        pass.bind("light_frame", reads.frame)
            .bind("fold_settings", fold_settings)
            .bind("receivers", reads.receivers)
            .bind("edges", edges)
            .bind("incident_faces", incident_faces)
            .bind("slots", reads.slots)
            .bind("lists", lists);
        match attenuated {
            None => pass.bind("blocked", reads.blocked),
            Some(passing) => pass
                .bind("attenuation_scale", passing.scale)
                .bind("triangle_attenuation", passing.triangles)
                .bind("sample_transmittance", passing.samples),
        };
        pass.bind("counts", counts);
        match standing {
            Some([group_samples, table]) => {
                pass.bind("group_samples", group_samples).bind("coverage_table", table);
            }
            None => reads.samples.bind(pass),
        }
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

/// What silhouettes are found with.
pub(super) struct EdgeStock {
    pub(super) edges: ResourceId,
    pub(super) incident_faces: ResourceId,
    pub(super) range: ResourceId,
    pub(super) clusters: ResourceId,
}

/// What layers are counted with.
pub(super) struct Stock {
    pub(super) faces: ResourceId,
    pub(super) face_tree: ResourceId,
    pub(super) edges: ResourceId,
    pub(super) range: ResourceId,
    pub(super) parts: ResourceId,
    pub(super) first_faces: ResourceId,
    pub(super) lists: ResourceId,
    pub(super) counts: ResourceId,
}

/// Counts the layers over the reference point for every receiver.
pub(super) fn append_depths(
    plan: &mut Plan,
    request: &Request<'_>,
    reads: &Reads,
    stock: &Stock,
    attenuated: Option<&Attenuated>,
) {
    let tile_count = tiles(request);
    let items = |count: u32, work_per_item: u32| Over::Items { count, work_per_item };
    let why = "bounds the receivers of each tile, and the shaft between them and the light";
    plan.compute("bound tiles", why, BOUND_TILES, items(tile_count, 64))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", stock.range)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("parts", stock.parts);
    let why = "finds the tiles with any face between them and the light";
    plan.compute("find faces", why, FIND_FACES, items(2 * tile_count, 64))
        .bind("face_tree", stock.face_tree)
        .bind("parts", stock.parts);
    let why = "lists for every eight receivers the faces that can lie between them and one point of the light";
    plan.compute("list faces", why, LIST_FACES, items(scattered(2 * tile_count * BUNDLES), 64))
        .bind("light_frame", reads.frame)
        .bind("cluster_range", stock.range)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("face_tree", stock.face_tree)
        .bind("edges", stock.edges)
        .bind("parts", stock.parts)
        .bind("first_faces", stock.first_faces)
        .bind("lists", stock.lists)
        .bind("counts", stock.counts);
    let why = "counts the layers over one point of the light";
    let kernel = if attenuated.is_some() { REFERENCE_DEPTH_ATTENUATED } else { REFERENCE_DEPTH };
    let pass = plan.compute("count reference depth", why, kernel, items(scattered(tile_count * TILE), 4));
    pass.bind("light_frame", reads.frame)
        .bind("cluster_range", stock.range)
        .bind("receivers", reads.receivers)
        .bind("faces", stock.faces)
        .bind("edges", stock.edges)
        .bind("first_faces", stock.first_faces)
        .bind("lists", stock.lists)
        .bind("slots", reads.slots);
    match attenuated {
        None => pass.bind("blocked", reads.blocked),
        Some(passing) => pass.bind("triangle_attenuation", passing.triangles),
    };
    pass.bind("counts", stock.counts);
    if let Some(passing) = attenuated {
        let why = "spreads what passes to that point over all samples";
        plan.compute("spread reference", why, SPREAD_REFERENCE, items(request.block.count as u32, 4))
            .bind("light_frame", reads.frame)
            .bind("attenuation_scale", passing.scale)
            .bind("slots", reads.slots)
            .bind("sample_transmittance", passing.samples);
    }
}

/// Finds the edges that can be silhouettes at all.
pub(super) fn append_silhouettes(
    plan: &mut Plan,
    settings: &DepthComplexity,
    occluders: &OccluderContents,
    reads: &Reads,
    stock: &EdgeStock,
) {
    let cluster_count = occluders.edge_count.div_ceil(CLUSTER);
    let (kernel, why) = match settings.silhouettes {
        Silhouettes::Accurate => (SILHOUETTES, "finds the edges that can be silhouettes over any part of the light"),
        Silhouettes::Standard => (STANDARD_SILHOUETTES, "finds the silhouettes of one point of the light"),
    };
    plan.compute("find silhouettes", why, kernel, Over::Items { count: cluster_count, work_per_item: 16 })
        .bind("light_frame", reads.frame)
        .bind("cluster_range", stock.range)
        .bind("edges", stock.edges)
        .bind("incident_faces", stock.incident_faces)
        .bind("clusters", stock.clusters);
}
