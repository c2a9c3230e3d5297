//! The blended evaluation: Forest et al.'s own pipeline, without geometry shader and without readback of any edge.
//!
//! A pass has two stages. The first places receivers, counts layers over the reference point, lists the silhouette edges, and draws their
//! wedges once to add up by how much each receiver's counters can change. By the largest sums the second stage chooses how wide a digit
//! is (the paper's adaptive packing; here the samples stay and the words grow), draws the wedges again, and adds up digits; then masks are
//! read off. What a wedge adds is decided by the predicates of the tiled evaluation, so the masks are the same, bit for bit.

mod packing;
mod z_fail;

use softshadow_plan::{
    Blend, ColorTarget, Count, Kernel, Origin, Over, Plan, Raster, RasterKernel, ResourceId, Shape, TextureFormat,
    Values, VertexSource,
};
use softshadow_scene::LocalCamera;

use super::tiled::{
    CLUSTER, CLUSTER_BYTES, COUNT_BYTES, EdgeStock, LIST_COUNTS, PART_BYTES, Stock, TILE, append_depths,
    append_silhouettes, first_face_bytes, list_bytes, tiles,
};
use super::values::ClusterRange;
use super::{DepthComplexity, InitialCounts, Reads, Samples, append_masks};
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::receivers::clip_ways;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{light_buffers, receivers, resolve};
use crate::request::Request;
pub(super) use packing::BASES;
use packing::Digits;
pub use packing::{Largest, Packing, TARGETS};

/// Label of what the first stage finds and the second is chosen by: `Largest`.
pub const LARGEST_COUNTS: &str = "largest counts";

/// Bytes of `DrawArguments`.
const DRAW_BYTES: u64 = 16;
/// Bytes of `Changes`.
const CHANGE_BYTES: u64 = 8;

const APPEND_WEDGES: Kernel = Kernel { file: "depth_complexity/blended/append_wedges.wgsl", entry: "append_wedges" };
const FIND_LARGEST: Kernel = Kernel { file: "depth_complexity/blended/find_largest.wgsl", entry: "find_largest" };
const UNPACK_WORDS: Kernel = Kernel { file: "depth_complexity/blended/unpack.wgsl", entry: "unpack_words" };
const UNPACK_TARGETS: Kernel = Kernel { file: "depth_complexity/blended/unpack.wgsl", entry: "unpack_targets" };

const fn draw_wedges(fragment: &'static str) -> RasterKernel {
    let file = "depth_complexity/blended/draw_wedges.wgsl";
    RasterKernel { file, vertex: "extrude", fragment: Some(fragment) }
}

/// `WedgeView` of `hull.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct WedgeView {
    eye: [f32; 3],
    width: u32,
    clip_x: [f32; 3],
    pixel: f32,
    clip_y: [f32; 3],
    receiver_count: u32,
    forward: [f32; 3],
    reserved: u32,
}

/// Bytes on the device that one receiver takes here alone, at the widest digits.
pub(super) fn bytes_per_receiver(settings: &DepthComplexity) -> u64 {
    // Sums of changes, the pixel that is drawn on, and counters.
    CHANGE_BYTES + 4 + packing::most_bytes(settings.counters, settings.samples)
}

/// The stage that the request asks for.
pub(super) fn plan(request: &Request<'_>, settings: &DepthComplexity, [width, _]: [u32; 2]) -> Plan {
    let image = [width, request.block.count as u32 / width];
    match request.stage {
        0 => bound(request, settings, image),
        _ => count(request, settings, image),
    }
}

fn hidden_by<'a>(request: &Request<'a>) -> Option<&'a OccluderContents> {
    request.occluders.filter(|occluders| occluders.edge_count > 0)
}

fn items(count: u32, work_per_item: u32) -> Over {
    Over::Items { count, work_per_item }
}

/// What both stages draw with.
struct Wedges {
    view: ResourceId,
    wedges: ResourceId,
    arguments: ResourceId,
    edges: ResourceId,
    incident_faces: ResourceId,
    changes: ResourceId,
}

impl Wedges {
    fn new(plan: &mut Plan, request: &Request<'_>, occluders: &OccluderContents) -> Self {
        Self {
            view: plan.parameter("wedge view", size_of::<WedgeView>() as u64),
            edges: plan.uploaded("edges", &occluders.edges),
            incident_faces: plan.uploaded("faces at edges", &occluders.incident_faces),
            wedges: plan.persistent("wedges", u64::from(occluders.edge_count) * 4),
            arguments: plan.persistent("wedge corners", DRAW_BYTES),
            changes: plan.persistent("changes", request.block.count as u64 * CHANGE_BYTES),
        }
    }

    /// A draw of all wedges; the caller binds what its fragments write.
    fn draw<'a>(
        &self,
        plan: &'a mut Plan,
        label: String,
        why: &str,
        fragment: &'static str,
        colors: Vec<ColorTarget>,
        reads: &Reads,
    ) -> &'a mut softshadow_plan::Pass {
        let vertices = VertexSource::Generated(Count::Indirect(self.arguments));
        let raster = Raster { kernel: draw_wedges(fragment), vertices, colors, depth: None };
        plan.raster(label, why, raster)
            .bind("light_frame", reads.frame)
            .bind("wedge_view", self.view)
            .bind("wedges", self.wedges)
            .bind("edges", self.edges)
            .bind("incident_faces", self.incident_faces)
            .bind("receivers", reads.receivers)
    }
}

/// A target for draws that write to buffers: there is no draw without one.
fn canvas(plan: &mut Plan, image: [u32; 2]) -> ColorTarget {
    let texture = plan.texture("wedge pixels", TextureFormat::R32Uint, image, Origin::Transient);
    ColorTarget { texture, layer: 0, clear: Some(0.0), blend: Blend::Replace }
}

/// The first stage: layers over the reference point, the list of wedges, and how far counters can go.
fn bound(request: &Request<'_>, settings: &DepthComplexity, image: [u32; 2]) -> Plan {
    let mut plan = Plan::new("depth complexity, bounds");
    let receivers = receivers::append(&mut plan, request);
    plan.outputs.extend(request.opens_block.then_some(receivers));
    let samples = Samples::shared(&mut plan);
    let reads = append_masks(&mut plan, request, settings, samples, receivers, Origin::Persistent);
    let Some(occluders) = hidden_by(request) else { return plan };
    let (count, cluster_count) = (request.block.count as u32, occluders.edge_count.div_ceil(CLUSTER));
    let wedges = Wedges::new(&mut plan, request, occluders);
    let range = plan.parameter("cluster range", size_of::<ClusterRange>() as u64);
    let clusters = plan.buffer("clusters", u64::from(cluster_count) * CLUSTER_BYTES);
    let counts = plan.buffer("running counts", COUNT_BYTES);
    let canvas = canvas(&mut plan, image);
    plan.clear("no counts", "nothing is counted yet", counts);
    let (edges, incident_faces) = (wedges.edges, wedges.incident_faces);
    append_silhouettes(&mut plan, settings, occluders, &reads, &EdgeStock { edges, incident_faces, range, clusters });
    plan.clear("no wedges", "no edge is listed yet", wedges.arguments);
    let why = "lists the silhouettes, and counts the corners of their wedges for the draws";
    plan.compute("list wedges", why, APPEND_WEDGES, items(cluster_count, 32))
        .bind("clusters", clusters)
        .bind("edges", edges)
        .bind("wedges", wedges.wedges)
        .bind("draw", wedges.arguments)
        .bind("counts", counts);
    match settings.initial_counts {
        InitialCounts::ZFail => z_fail::append(&mut plan, request, occluders, &wedges, &reads, canvas),
        InitialCounts::Rays => {
            let stock = Stock {
                faces: plan.uploaded("faces", &occluders.faces),
                face_tree: plan.uploaded("face hierarchy", &occluders.face_tree),
                edges,
                range,
                parts: plan.buffer("tile parts", 2 * u64::from(tiles(request)) * PART_BYTES),
                first_faces: plan.buffer("first faces", first_face_bytes(request)),
                lists: plan.buffer("face lists", list_bytes(request)),
                counts,
            };
            append_depths(&mut plan, request, &reads, &stock, None);
        }
    }
    plan.clear("no changes", "nothing changes yet", wedges.changes);
    let why = "adds up by how much the counters of each receiver can rise and fall";
    wedges
        .draw(&mut plan, "bound changes".into(), why, "bound_changes", vec![canvas], &reads)
        .bind("changes", wedges.changes);
    let largest = plan.persistent(LARGEST_COUNTS, size_of::<Largest>() as u64);
    plan.clear("no largest", "no counter is known yet", largest);
    let why = "finds how wide a digit has to be";
    plan.compute("find largest", why, FIND_LARGEST, items(count, 1))
        .bind("wedge_view", wedges.view)
        .bind("receivers", reads.receivers)
        .bind("slots", reads.slots)
        .bind("changes", wedges.changes)
        .bind("largest", largest);
    let report = plan.buffer(LIST_COUNTS, COUNT_BYTES);
    let why = "tells how many edges there were, and whether anything was left undone";
    plan.copy("report counts", why, [counts, report], COUNT_BYTES);
    plan.outputs.extend([report, largest]);
    plan.decision = Some(largest);
    plan
}

fn digits(request: &Request<'_>, settings: &DepthComplexity) -> Digits {
    let [count, fall, initial, astray] = request.decision;
    Digits::new(settings.counters, settings.base, Largest { count, fall, initial, astray })
}

/// Labels and numbers of the batches of a draw.
fn batches(settings: &DepthComplexity) -> &'static [(&'static str, u32)] {
    match settings.batches {
        1 => &[("all", 0)],
        _ => &[("outer", 1), ("inner", 2)],
    }
}

/// The second stage: counters, and masks from them.
fn count(request: &Request<'_>, settings: &DepthComplexity, image: [u32; 2]) -> Plan {
    let mut plan = Plan::new("depth complexity, counts");
    let count = request.block.count as u64;
    let receivers = receivers::append(&mut plan, request);
    let light = light_buffers::append(&mut plan, settings.samples);
    let blocked = plan.persistent(BLOCKED, count * u64::from(settings.words()) * 4);
    if let Some(occluders) = hidden_by(request) {
        let wedges = Wedges::new(&mut plan, request, occluders);
        let reads = Reads {
            frame: plan.parameter("light frame", size_of::<super::FrameRecord>() as u64),
            samples: Samples::shared(&mut plan),
            receivers,
            slots: plan.persistent("slots", u64::from(tiles(request) * TILE) * super::tiled::SLOT_BYTES),
            blocked,
        };
        append_counters(&mut plan, request, settings, image, &wedges, &reads);
    }
    let decided = plan.buffer("decided samples", count * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks = Masks { blocked, decided, areas: None, transmittance: None };
    resolve::append(&mut plan, request, &settings.sampling(0), &light, receivers, masks);
    plan
}

fn append_counters(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    image: [u32; 2],
    wedges: &Wedges,
    reads: &Reads,
) {
    let count = request.block.count as u32;
    let (draws, targets) = digits(request, settings).draws(settings.samples, &request.host.limits);
    let packings: Vec<Vec<ResourceId>> = (0..draws.len())
        .map(|draw| {
            let packing = |(batch, _): &(&str, u32)| {
                plan.parameter(format!("packing {draw} {batch}"), size_of::<Packing>() as u64)
            };
            batches(settings).iter().map(packing).collect()
        })
        .collect();
    let why = "adds what each edge changes to the digits of the samples beyond it";
    let unpack = |plan: &mut Plan, draw: usize, kernel: Kernel, name: &'static str, counters: ResourceId| {
        let why = "blocks the samples whose count is not 0";
        let over = items(count, settings.samples.div_ceil(4));
        let pass = plan.compute(format!("unpack {draw}"), why, kernel, over);
        reads.samples.bind(pass.bind("light_frame", reads.frame));
        pass.bind("packing", packings[draw][0])
            .bind("receivers", reads.receivers)
            .bind("slots", reads.slots)
            .bind("changes", wedges.changes)
            .bind("blocked", reads.blocked)
            .bind(name, counters);
    };
    if targets == 0 {
        let words = plan.buffer("counters", u64::from(count) * u64::from(draws[0].words()) * 4);
        plan.clear("no counters", "nothing is counted yet", words);
        let canvas = canvas(plan, image);
        for ((batch, _), packing) in batches(settings).iter().zip(&packings[0]) {
            let pass = wedges.draw(plan, format!("count {batch}"), why, "add_words", vec![canvas], reads);
            reads.samples.bind(pass.bind("packing", *packing).bind("words", words));
        }
        unpack(plan, 0, UNPACK_WORDS, "words", words);
        return;
    }
    let shape = Shape::Texture { format: TextureFormat::Rgba32Float, size: image, layers: packing::layers(targets) };
    let texture = plan.resource("counters", shape, Origin::Transient);
    let fragment = FRAGMENTS[TARGETS.iter().position(|n| *n as usize == targets).unwrap_or_default()];
    for (draw, packings) in packings.iter().enumerate() {
        for (number, ((batch, _), packing)) in batches(settings).iter().zip(packings).enumerate() {
            let clear = (number == 0).then_some(0.0);
            let target = |layer| ColorTarget { texture, layer, clear, blend: Blend::Add };
            let colors = (0..targets as u32).map(target).collect();
            let pass = wedges.draw(plan, format!("count {draw} {batch}"), why, fragment, colors, reads);
            reads.samples.bind(pass.bind("packing", *packing));
        }
        unpack(plan, draw, UNPACK_TARGETS, "targets", texture);
    }
}

/// The fragment shader for each number of [`TARGETS`].
const FRAGMENTS: [&str; TARGETS.len()] =
    ["add_digits_1", "add_digits_2", "add_digits_3", "add_digits_4", "add_digits_6", "add_digits_8"];

/// The values of the parameters that the tiled evaluation has not.
pub(super) fn values(request: &Request<'_>, settings: &DepthComplexity, camera: &LocalCamera, values: &mut Values) {
    let (width, count) = (camera.size[0], request.block.count);
    let first_row = request.block.first / width as usize;
    let ways = clip_ways(camera, first_row, count / width as usize);
    let view = WedgeView {
        eye: camera.eye.as_vec3().to_array(),
        width,
        clip_x: ways.x.as_vec3().to_array(),
        pixel: camera.step_x.length().max(camera.step_y.length()) as f32,
        clip_y: ways.y.as_vec3().to_array(),
        receiver_count: count as u32,
        forward: camera.forward.as_vec3().to_array(),
        reserved: 0,
    };
    values.insert("wedge view".into(), bytemuck::bytes_of(&view).to_vec());
    if request.stage == 1 {
        let (draws, _) = digits(request, settings).draws(settings.samples, &request.host.limits);
        for (draw, packing) in draws.iter().enumerate() {
            for (batch, number) in batches(settings) {
                let packing = packing.in_batch(*number);
                values.insert(format!("packing {draw} {batch}"), bytemuck::bytes_of(&packing).to_vec());
            }
        }
    }
}
