//! Layers over the reference point by shadow volumes, as published: two draws, and no ray.

use softshadow_plan::{ColorTarget, Count, Kernel, Plan, Raster, RasterKernel, VertexSource};

use super::super::Reads;
use super::{Wedges, items};
use crate::parts::occluder_buffers::{FaceRecord, OccluderContents};
use crate::request::Request;

const TAKE_LAYERS: Kernel = Kernel { file: "depth_complexity/blended/take_layers.wgsl", entry: "take_layers" };

/// Bytes of a receiver's count.
pub(super) const LAYER_BYTES: u64 = 4;
/// Corners of both caps of a face.
const CAP_CORNERS: usize = 12;

const fn draw(vertex: &'static str) -> RasterKernel {
    let file = "depth_complexity/blended/z_fail.wgsl";
    RasterKernel { file, vertex, fragment: Some("count_layers") }
}

/// Counts the layers over the reference point into the slots; edges have to be listed before.
pub(super) fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    occluders: &OccluderContents,
    wedges: &Wedges,
    reads: &Reads,
    canvas: ColorTarget,
) {
    let faces = plan.uploaded("faces", &occluders.faces);
    let layers = plan.buffer("layers", request.block.count as u64 * LAYER_BYTES);
    plan.clear("no layers", "nothing is counted yet", layers);
    let corners = occluders.faces.bytes.len() / size_of::<FaceRecord>() * CAP_CORNERS;
    let why = "counts the faces, and what they hide at infinity, behind each receiver";
    let vertices = VertexSource::Generated(Count::Fixed(corners as u32));
    let raster = Raster { kernel: draw("draw_caps"), vertices, colors: vec![canvas], depth: None };
    plan.raster("count caps", why, raster)
        .bind("light_frame", reads.frame)
        .bind("wedge_view", wedges.view)
        .bind("faces", faces)
        .bind("edges", wedges.edges)
        .bind("receivers", reads.receivers)
        .bind("layers", layers);
    let why = "counts the sides of shadow volumes behind each receiver";
    let vertices = VertexSource::Generated(Count::Indirect(wedges.arguments));
    let raster = Raster { kernel: draw("draw_sides"), vertices, colors: vec![canvas], depth: None };
    plan.raster("count sides", why, raster)
        .bind("light_frame", reads.frame)
        .bind("wedge_view", wedges.view)
        .bind("wedges", wedges.wedges)
        .bind("edges", wedges.edges)
        .bind("incident_faces", wedges.incident_faces)
        .bind("receivers", reads.receivers)
        .bind("layers", layers);
    let why = "takes their layers for those over the reference point";
    plan.compute("take layers", why, TAKE_LAYERS, items(request.block.count as u32, 1))
        .bind("light_frame", reads.frame)
        .bind("layers", layers)
        .bind("slots", reads.slots)
        .bind("blocked", reads.blocked);
}
