//! Which of eight edges a shaft's list takes.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;

use super::super::eight_edges::{EightEdges, EightFaces, Sides, first_lanes};
use super::super::occluders::{IncidentFace, OccluderEdge};
use super::super::shaft::Planes;
use super::super::tiles::EDGE_BITS;
use crate::kernels::lanes::{LANES, Vec3x8};

const MARGIN: f32 = 64.0 * 5.960_464_5e-8;

/// A shaft, and the box of its receivers.
pub(super) struct Shaft {
    pub(super) planes: Planes,
    pub(super) middle: Vec3,
    pub(super) half: Vec3,
}

type Row = [u32; LANES];

/// Eight edges as they are kept: tested by one shaft after the other. What is missing at the end repeats the last.
#[repr(align(32))]
pub(super) struct KeptEdges {
    low: [Row; 3],
    high: [Row; 3],
    normals: [[Row; 3]; 2],
    points: [[Row; 3]; 2],
    incidence_count: Row,
    index: Row,
    count: usize,
}

#[inline(always)]
fn rows<S: Simd>(v: Vec3x8<S>) -> [Row; 3] {
    [v.x.to_bits().to_array(), v.y.to_bits().to_array(), v.z.to_bits().to_array()]
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, row: &Row) -> f32x8<S> {
    f32x8::from_bits(u32x8::from_slice(simd, row))
}

#[inline(always)]
fn vector<S: Simd>(simd: S, [x, y, z]: &[Row; 3]) -> Vec3x8<S> {
    Vec3x8::new(lanes(simd, x), lanes(simd, y), lanes(simd, z))
}

impl KeptEdges {
    /// Of one to eight edges.
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        simd: S,
        edges: &[OccluderEdge],
        incident_faces: &[IncidentFace],
        indices: &[u32],
    ) -> Self {
        let index: Row = std::array::from_fn(|k| indices[k.min(indices.len() - 1)]);
        let eight = EightEdges::new(simd, edges, incident_faces, |k| index[k] as usize);
        Self {
            low: rows(eight.low),
            high: rows(eight.high),
            normals: [rows(eight.faces[0].normal), rows(eight.faces[1].normal)],
            points: [rows(eight.faces[0].point), rows(eight.faces[1].point)],
            incidence_count: eight.incidence_count.to_array(),
            index,
            count: indices.len(),
        }
    }

    #[inline(always)]
    fn faces<S: Simd>(&self, simd: S, k: usize) -> EightFaces<S> {
        EightFaces { normal: vector(simd, &self.normals[k]), point: vector(simd, &self.points[k]) }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S) -> EightEdges<S> {
        EightEdges {
            low: vector(simd, &self.low),
            high: vector(simd, &self.high),
            incidence_count: u32x8::from_slice(simd, &self.incidence_count),
            faces: [self.faces(simd, 0), self.faces(simd, 1)],
        }
    }
}

/// A shaft in all lanes, with what all edges share.
pub(super) struct ShaftInLanes<S: Simd> {
    planes: [(Vec3x8<S>, f32x8<S>); 5],
    middle: Vec3x8<S>,
    half: Vec3x8<S>,
    size: Vec3x8<S>,
}

/// What a shaft's list takes of eight edges, and which side of their faces all its receivers are on.
struct Taken<S: Simd> {
    edges: mask32x8<S>,
    sides: [Sides<S>; 2],
}

impl<S: Simd> ShaftInLanes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, shaft: &Shaft) -> Self {
        let mut planes = [(Vec3x8::splat(simd, Vec3::ZERO), f32x8::splat(simd, 0.0)); 5];
        for (in_lanes, plane) in planes.iter_mut().zip(&shaft.planes) {
            *in_lanes = (Vec3x8::splat(simd, plane.truncate()), f32x8::splat(simd, plane.w));
        }
        Self {
            planes,
            middle: Vec3x8::splat(simd, shaft.middle),
            half: Vec3x8::splat(simd, shaft.half),
            size: Vec3x8::splat(simd, shaft.middle.abs() + shaft.half),
        }
    }

    #[inline(always)]
    fn meets(&self, simd: S, edges: &EightEdges<S>) -> mask32x8<S> {
        let mut excluded = mask32x8::splat(simd, false);
        for (normal, bound) in &self.planes {
            excluded |= normal.dot(edges.low).simd_gt(*bound) & normal.dot(edges.high).simd_gt(*bound);
        }
        !excluded
    }

    /// Which side of a face all receivers are on; neither where they are not.
    #[inline(always)]
    fn side(&self, face: &EightFaces<S>) -> Sides<S> {
        let height = face.normal.dot(self.middle - face.point);
        let size = self.size + face.point.abs();
        let margin = face.normal.abs().dot(self.half) + MARGIN * (1.0 + size.x + size.y + size.z);
        Sides::new(height, margin)
    }

    /// Nothing where no edge is taken.
    #[inline(always)]
    fn taken(&self, simd: S, kept: &KeptEdges, edges: &EightEdges<S>) -> Option<Taken<S>> {
        let meets = self.meets(simd, edges) & first_lanes(simd, kept.count);
        if !meets.any_true() {
            return None;
        }
        let (a, b) = (self.side(&edges.faces[0]), self.side(&edges.faces[1]));
        // What it adds on one side it takes away on the other.
        let cancels = edges.are_pairs() & a.are_opposite(b);
        Some(Taken { edges: meets & !cancels, sides: [a, b] })
    }

    /// Appends the edges that the list takes.
    #[inline(always)]
    pub(super) fn list_edges(&self, simd: S, kept: &KeptEdges, list: &mut Vec<u32>) {
        if let Some(taken) = self.taken(simd, kept, &kept.load(simd)) {
            append(list, u32x8::from_slice(simd, &kept.index), taken.edges);
        }
    }

    /// Appends the edges that the list takes, with the weight where that is the same for all receivers.
    #[inline(always)]
    pub(super) fn list_entries(&self, simd: S, kept: &KeptEdges, list: &mut Vec<u32>) {
        let edges = kept.load(simd);
        let Some(taken) = self.taken(simd, kept, &edges) else { return };
        let [a, b] = taken.sides;
        let are_known = edges.incidence_count.simd_le(2) & a.are_known() & b.are_known();
        // A pair that was not left out has both faces on one side.
        let size = edges.are_pairs().select(u32x8::splat(simd, 2), u32x8::splat(simd, 1));
        let weight_and_four = a.above.select(size + 4, 4 - size);
        let weight = are_known.select(weight_and_four << EDGE_BITS, u32x8::splat(simd, 0));
        append(list, u32x8::from_slice(simd, &kept.index) | weight, taken.edges);
    }
}

/// Appends the lanes that count.
#[inline(always)]
fn append<S: Simd>(list: &mut Vec<u32>, entries: u32x8<S>, counts: mask32x8<S>) {
    let end = list.len() + counts.to_bitmask().count_ones() as usize;
    // All eight at once, and cut: a copy of one length is a single store.
    list.extend_from_slice(&entries.compress(counts).to_array());
    list.truncate(end);
}
