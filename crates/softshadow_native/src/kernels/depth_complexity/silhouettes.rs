//! The twin of `depth_complexity/silhouettes.wgsl`: eight edges of a cluster at a time.

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::clusters::{CLUSTER, Cluster};
use super::eight_edges::{EightEdges, EightFaces, Sides, first_lanes};
use super::frame::{FRAME_FLAT, FRAME_SUN, LightFrame};
use super::occluders::{IncidentFace, OccluderEdge};
use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::{records, records_mut};

/// Clusters that a thread takes at once.
const CLUSTERS: usize = 32;

/// A part of the light: `half` its size to either side of `middle`, and `radius` that of a ball.
struct Part {
    middle: Vec2,
    half: Vec2,
    radius: f32,
}

pub(super) fn silhouettes(call: &mut Call) {
    let frame: LightFrame = call.uniform("light_frame");
    let middle = (frame.low + frame.high) * 0.5 + frame.reference;
    find(call, &frame, &Part { middle, half: (frame.high - frame.low) * 0.5, radius: frame.size });
}

/// Those of the reference point alone.
pub(super) fn standard_silhouettes(call: &mut Call) {
    let frame: LightFrame = call.uniform("light_frame");
    find(call, &frame, &Part { middle: frame.reference, half: Vec2::ZERO, radius: 0.0 });
}

fn find(call: &mut Call, frame: &LightFrame, part: &Part) {
    let (items, level) = (call.item_range(), call.level);
    let range: super::clusters::ClusterRange = call.uniform("cluster_range");
    let [edges, incident_faces, clusters] = call.buffers(["edges", "incident_faces", "clusters"]);
    let edges = &records::<OccluderEdge>(edges)[..range.edge_count as usize];
    let incident_faces = records::<IncidentFace>(incident_faces);
    let clusters = &mut records_mut::<Cluster>(clusters)[items.clone()];
    clusters.par_chunks_mut(CLUSTERS).enumerate().for_each(|(run, clusters)| {
        let first = items.start + run * CLUSTERS;
        dispatch!(level, simd => {
            let plane = LightPlane::new(simd, frame, part);
            for (at, cluster) in clusters.iter_mut().enumerate() {
                *cluster = find_in_cluster(simd, &plane, edges, incident_faces, (first + at) * CLUSTER);
            }
        });
    });
}

/// What a side of the light is decided by, the same for all faces.
struct LightPlane<S: Simd> {
    kind: u32,
    /// Middle of the part; on a sun its direction.
    middle: Vec3x8<S>,
    /// Sum of the sizes of what `middle` was made of.
    size: Vec3x8<S>,
    x: Vec3x8<S>,
    y: Vec3x8<S>,
    half: Vec2,
    radius: f32,
}

impl<S: Simd> LightPlane<S> {
    #[inline(always)]
    fn new(simd: S, frame: &LightFrame, part: &Part) -> Self {
        let [x, y, middle, size] = if frame.kind == FRAME_SUN {
            let (x, y) = (frame.x_row * frame.size, frame.y_row * frame.size);
            [x, y, frame.z_row + x * part.middle.x + y * part.middle.y, Vec3::ZERO]
        } else {
            let across = frame.x_way * part.middle.x + frame.y_way * part.middle.y;
            let offset = if frame.kind == FRAME_FLAT { across } else { Vec3::ZERO };
            [frame.x_way, frame.y_way, frame.origin + offset, frame.origin.abs() + offset.abs()]
        };
        let [x, y] = [Vec3x8::splat(simd, x), Vec3x8::splat(simd, y)];
        let [middle, size] = [Vec3x8::splat(simd, middle), Vec3x8::splat(simd, size)];
        Self { kind: frame.kind, middle, size, x, y, half: part.half, radius: part.radius }
    }

    /// Which side of a face this part of the light is on.
    #[inline(always)]
    fn side(&self, simd: S, face: &EightFaces<S>) -> Sides<S> {
        let normal = face.normal;
        let across = normal.dot(self.x).abs() * self.half.x + normal.dot(self.y).abs() * self.half.y;
        let (height, spread, size) = if self.kind == FRAME_SUN {
            (normal.dot(self.middle), across, f32x8::splat(simd, 1.0))
        } else {
            let spread = if self.kind == FRAME_FLAT { across } else { f32x8::splat(simd, self.radius) };
            (normal.dot(self.middle - face.point), spread, (self.size + face.point.abs()).sum())
        };
        // Local scenes lie within 1: so far can a receiver be whose own sign has to agree.
        let margin = spread + 4e-6 * (1.0 + size + spread);
        Sides::new(height, margin)
    }
}

#[inline(always)]
fn find_in_cluster<S: Simd>(
    simd: S,
    plane: &LightPlane<S>,
    edges: &[OccluderEdge],
    incident_faces: &[IncidentFace],
    first: usize,
) -> Cluster {
    let end = edges.len().min(first + CLUSTER);
    let mut low = Vec3x8::splat(simd, Vec3::splat(1e30));
    let mut high = Vec3x8::splat(simd, Vec3::splat(-1e30));
    let mut silhouettes = 0;
    for at in (first..end).step_by(LANES) {
        let eight = EightEdges::new(simd, edges, incident_faces, |k| (at + k).min(end - 1));
        let sides = [plane.side(simd, &eight.faces[0]), plane.side(simd, &eight.faces[1])];
        let cancels = eight.are_pairs() & sides[0].are_opposite(sides[1]);
        let found: mask32x8<S> = !cancels & first_lanes(simd, end - at);
        silhouettes |= (found.to_bitmask() as u32) << (at - first);
        low = Vec3x8::select(found, low.min(eight.low.min(eight.high)), low);
        high = Vec3x8::select(found, high.max(eight.low.max(eight.high)), high);
    }
    Cluster { low: low.reduce_min(), silhouettes, high: high.reduce_max(), reserved: 0 }
}
