//! The edges that can be silhouettes at all, as the shafts of a call test them: eight boxes and eight edges at a time. Made once a call: what it
//! costs is a small part of what one tile in a hundred saves.

use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};
use glam::Vec3;
use rayon::prelude::*;

use super::super::clusters::{CLUSTER, Cluster};
use super::super::occluders::{IncidentFace, OccluderEdge};
use super::super::shaft::{Planes, shaft_meets_boxes};
use super::entries::KeptEdges;
use crate::kernels::lanes::{LANES, Vec3x8};

/// Eight boxes; what is missing at the end is no box.
struct Boxes {
    low: [[f32; LANES]; 3],
    high: [[f32; LANES]; 3],
    /// One bit a box.
    exist: u64,
}

impl Boxes {
    fn new(clusters: &[Cluster]) -> Self {
        let rows = |of: fn(&Cluster) -> Vec3| -> [[f32; LANES]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|k| clusters.get(k).map_or(0.0, |c| of(c)[i])))
        };
        let exists = |(k, cluster): (usize, &Cluster)| u64::from(cluster.silhouettes != 0) << k;
        let exist = clusters.iter().enumerate().map(exists).sum();
        Self { low: rows(|c| c.low), high: rows(|c| c.high), exist }
    }

    /// The boxes that a shaft meets, one bit each.
    #[inline(always)]
    fn met<S: Simd>(&self, simd: S, planes: &Planes) -> u64 {
        shaft_meets_boxes(simd, planes, vector(simd, &self.low), vector(simd, &self.high)).to_bitmask() & self.exist
    }
}

#[inline(always)]
fn vector<S: Simd>(simd: S, [x, y, z]: &[[f32; LANES]; 3]) -> Vec3x8<S> {
    Vec3x8::new(f32x8::from_slice(simd, x), f32x8::from_slice(simd, y), f32x8::from_slice(simd, z))
}

/// A group of clusters.
struct Group {
    boxes: Vec<Boxes>,
    edges: Vec<KeptEdges>,
    /// Where the edges of each cluster begin, and where the last end.
    firsts: Vec<usize>,
}

pub(super) struct Stock {
    boxes: Vec<Boxes>,
    groups: Vec<Group>,
}

impl Stock {
    pub(super) fn new(
        level: Level,
        edges: &[OccluderEdge],
        incident_faces: &[IncidentFace],
        clusters: &[Cluster],
        groups: &[Cluster],
    ) -> Self {
        let group = |(index, clusters): (usize, &[Cluster])| dispatch!(level, simd => Group::new(simd, edges, incident_faces, index * CLUSTER, clusters));
        Self {
            boxes: groups.chunks(LANES).map(Boxes::new).collect(),
            groups: clusters.par_chunks(CLUSTER).enumerate().map(group).collect(),
        }
    }

    /// Hands the edges of every cluster that a shaft meets to `visit`.
    #[inline(always)]
    pub(super) fn visit<S: Simd>(&self, simd: S, planes: &Planes, mut visit: impl FnMut(&KeptEdges)) {
        each_met(simd, planes, &self.boxes, |group| {
            let group = &self.groups[group];
            each_met(simd, planes, &group.boxes, |cluster| {
                for kept in &group.edges[group.firsts[cluster]..group.firsts[cluster + 1]] {
                    visit(kept);
                }
            });
        });
    }
}

#[inline(always)]
fn each_met<S: Simd>(simd: S, planes: &Planes, boxes: &[Boxes], mut visit: impl FnMut(usize)) {
    for (at, boxes) in boxes.iter().enumerate() {
        let mut waiting = boxes.met(simd, planes);
        while waiting != 0 {
            visit(at * LANES + waiting.trailing_zeros() as usize);
            waiting &= waiting - 1;
        }
    }
}

impl Group {
    #[inline(always)]
    fn new<S: Simd>(
        simd: S,
        edges: &[OccluderEdge],
        incident_faces: &[IncidentFace],
        first_cluster: usize,
        clusters: &[Cluster],
    ) -> Self {
        let (mut kept, mut firsts) = (Vec::new(), vec![0]);
        let mut indices = Vec::with_capacity(CLUSTER);
        for (at, cluster) in clusters.iter().enumerate() {
            let first = ((first_cluster + at) * CLUSTER) as u32;
            indices.clear();
            indices.extend((0..CLUSTER as u32).filter(|k| cluster.silhouettes >> k & 1 != 0).map(|k| first + k));
            for indices in indices.chunks(LANES) {
                kept.push(KeptEdges::new(simd, edges, incident_faces, indices));
            }
            firsts.push(kept.len());
        }
        Self { boxes: clusters.chunks(LANES).map(Boxes::new).collect(), edges: kept, firsts }
    }
}
