//! The silhouette edges as seen from the light's centre, listed on the device for draws that begin at them. Nothing is read back.

use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};

use crate::parts::occluder_buffers::OccluderContents;

const LIST: Kernel = Kernel { file: "light_silhouettes/list.wgsl", entry: "list_silhouettes" };

/// `EdgeCorners` of `list.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct EdgeCorners {
    per_edge: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

/// Bytes of `DrawArguments`.
const DRAW_BYTES: u64 = 16;
/// Bytes of `LightSilhouette`.
pub const LIGHT_SILHOUETTE_BYTES: u64 = 32;

/// What draws read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightSilhouettes {
    /// `LightSilhouette`s, in no order.
    pub(crate) list: ResourceId,
    /// Arguments of an indirect draw: so many corners an edge.
    pub(crate) draw: ResourceId,
}

/// Lists them. The caller's draws take as many corners an edge as [`values`] says.
pub(crate) fn append(plan: &mut Plan, occluders: &OccluderContents, light: ResourceId) -> LightSilhouettes {
    let edges = plan.uploaded("edges", &occluders.edges);
    let incident_faces = plan.uploaded("faces at edges", &occluders.incident_faces);
    let edge_corners = plan.parameter("edge corners", size_of::<EdgeCorners>() as u64);
    let list = plan.buffer("light silhouettes", u64::from(occluders.edge_count) * LIGHT_SILHOUETTE_BYTES);
    let draw = plan.buffer("silhouette corners", DRAW_BYTES);
    plan.clear("no silhouettes", "no edge is listed yet", draw);
    let over = Over::Items { count: occluders.edge_count, work_per_item: 1 };
    plan.compute("list silhouettes", "finds the silhouettes as the light's centre sees them", LIST, over)
        .bind("light", light)
        .bind("edge_corners", edge_corners)
        .bind("edges", edges)
        .bind("incident_faces", incident_faces)
        .bind("silhouettes", list)
        .bind("draw", draw);
    LightSilhouettes { list, draw }
}

/// The values of its parameters: how many corners are drawn at each edge.
pub(crate) fn values(per_edge: u32, values: &mut Values) {
    let record = EdgeCorners { per_edge, reserved0: 0, reserved1: 0, reserved2: 0 };
    values.insert("edge corners".into(), bytemuck::bytes_of(&record).to_vec());
}
