//! The twin of `depth_complexity/fold.wgsl`: folds the silhouette edges of a part of a tile into the counters of its receivers, 64 samples
//! at a time. Here eight receivers of a bundle walk their list together; steps are not counted, because here every walk ends.
//!
//! Closures that compute with vectors are marked as always inlined: a function of their own would not have the processor's vectors.

mod attenuated;
mod opaque;
mod own;
mod standing;

use std::sync::atomic::AtomicU32;

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, i32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;
use rayon::prelude::*;

use super::coverage::Crossing;
use super::edge::{EdgeImage, before_limit, edge_image, image_matters};
use super::frame::{FrameView, LightFrame};
use super::horizon::{horizon_slope, is_above_horizon};
use super::lists::{Bundle, entries};
use super::occluders::{IncidentFace, OccluderEdge};
use super::sides::weighing_side;
use super::tiles::{BUNDLE, BUNDLES, HEAD, TILE, count, first_chunk_word, listed_edge};
use crate::engine::{atomic_words, shared};
use crate::kernels::lanes::Vec3x8;
use crate::kernels::records;
use crate::kernels::shared::receiver::{RECEIVER_SURFACE, Receiver};
pub(super) use attenuated::{fold_attenuated, fold_attenuated_own_samples};
pub(super) use opaque::{fold, fold_areas, fold_own_samples, fold_own_samples_areas};

/// Parts of tiles that a thread takes at once: they differ in cost.
const PARTS: usize = 4;

/// Samples of a group.
const GROUP: u32 = 64;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct FoldSettings {
    slot_count: u32,
    /// Which 64 of a receiver's samples.
    group: u32,
    /// An area farther from the samples' share is not believed.
    sampling_bound: f32,
    tile_count: u32,
}

/// What every fold reads.
struct Stock<'a> {
    frame: LightFrame,
    settings: FoldSettings,
    receivers: &'a [Receiver],
    edges: &'a [OccluderEdge],
    incident_faces: &'a [IncidentFace],
    slots: &'a [AtomicU32],
    heads: &'a [u32],
    chunks: &'a [u32],
    counts: &'a [AtomicU32],
}

impl<'a> Stock<'a> {
    fn new(frame: LightFrame, settings: FoldSettings, words: [&'a mut [u32]; 6]) -> Self {
        let [receivers, edges, incident_faces, slots, lists, counts] = words;
        let (heads, chunks) = lists.split_at(first_chunk_word(settings.tile_count as usize));
        let counts = atomic_words(counts);
        let parts = shared(&counts[count::PARTS]) as usize;
        Self {
            frame,
            settings,
            receivers: records(receivers),
            edges: records(edges),
            incident_faces: records(incident_faces),
            slots: atomic_words(slots),
            heads: &heads[..HEAD * parts],
            chunks,
            counts,
        }
    }

    /// Samples of this group.
    fn count(&self) -> u32 {
        GROUP.min(self.frame.sample_count - GROUP * self.settings.group)
    }

    /// Calls `each` for every part of a tile that has edges, on all threads.
    fn for_parts(&self, each: impl Fn(&[u32]) + Send + Sync) {
        self.heads.par_chunks_exact(HEAD).with_max_len(PARTS).for_each(each);
    }

    /// Calls `each` for the bundles of a part.
    #[inline(always)]
    fn bundles<S: Simd>(&self, simd: S, head: &[u32], each: impl Fn(&Eight<S>, u32)) {
        let first = TILE * (head[0] >> 1) as usize;
        for at in 0..BUNDLES {
            let slot_count = self.settings.slot_count as usize;
            let bundle = Bundle::at(first + BUNDLE * at, slot_count, self.slots, self.receivers);
            let members = bundle.members(head[0] & 1);
            if members != 0 {
                each(&Eight::new(simd, &self.frame, bundle, members), head[2 + at]);
            }
        }
    }

    /// Calls `each` for the edges of a list that lie between any member and the light: entry, edge, image, for whom.
    #[inline(always)]
    fn edges<S: Simd>(
        &self,
        simd: S,
        eight: &Eight<S>,
        list: u32,
        mut each: impl FnMut(u32, &OccluderEdge, &EdgeImage<S>, mask32x8<S>),
    ) {
        for entry in entries(self.chunks, list) {
            let edge = &self.edges[listed_edge(entry) as usize];
            let image = before_limit(simd, &eight.view, edge, edge_image(simd, &eight.view, edge));
            let matters = image_matters(simd, &self.frame, &image) & eight.members;
            if matters.any_true() {
                each(entry, edge, &image, matters);
            }
        }
    }

    fn faces_at(&self, edge: &OccluderEdge) -> &[IncidentFace] {
        &self.incident_faces[edge.first_incidence as usize..][..edge.face_count() as usize]
    }
}

/// Eight receivers in the course of their fold.
struct Eight<S: Simd> {
    bundle: Bundle,
    member_bits: u32,
    members: mask32x8<S>,
    triangles: u32x8<S>,
    view: FrameView<S>,
    slope: Vec3x8<S>,
    /// One bit a lane above whose horizon the whole light lies.
    above_bits: u32,
}

impl<S: Simd> Eight<S> {
    #[inline(always)]
    fn new(simd: S, frame: &LightFrame, bundle: Bundle, member_bits: u32) -> Self {
        let view = frame.view(simd, bundle.positions(simd));
        let slope = horizon_slope(&view, Vec3x8::from_fn(simd, |k| bundle.receivers[k].normal));
        let surfaces = bundle.receivers.iter().enumerate();
        let surfaces: u64 = surfaces.map(|(k, r)| u64::from(r.kind == RECEIVER_SURFACE) << k).sum();
        let above = !mask32x8::from_bitmask(simd, surfaces) | is_above_horizon(frame, slope);
        Self {
            member_bits,
            members: mask32x8::from_bitmask(simd, u64::from(member_bits)),
            triangles: bundle.triangles(simd),
            bundle,
            view,
            slope,
            above_bits: above.to_bitmask() as u32,
        }
    }

    fn is_above(&self, lane: usize) -> bool {
        self.above_bits >> lane & 1 != 0
    }

    /// The side by which a face weighs; 0 on the face itself.
    #[inline(always)]
    fn left_of(&self, simd: S, frame: &LightFrame, face: &IncidentFace) -> i32x8<S> {
        let turned = weighing_side(simd, frame, &self.view, face);
        let own = self.triangles.simd_eq(u32x8::splat(simd, face.reference >> 1));
        own.select(i32x8::splat(simd, 0), turned)
    }
}

/// Which samples edges cover, and which lie below the horizon.
trait Samples<S: Simd> {
    /// Calls `found` for each of some lanes, with the samples that it crosses the edge to.
    fn crossed(&self, simd: S, crossing: &Crossing<S>, lanes: u32, found: impl FnMut(usize, u64));

    /// The samples of a lane that lie below its horizon.
    fn below(&self, simd: S, slope: Vec3x8<S>, lane: usize) -> u64;
}

impl<S: Simd, T: Samples<S>> Samples<S> for &T {
    #[inline(always)]
    fn crossed(&self, simd: S, crossing: &Crossing<S>, lanes: u32, found: impl FnMut(usize, u64)) {
        (*self).crossed(simd, crossing, lanes, found);
    }

    #[inline(always)]
    fn below(&self, simd: S, slope: Vec3x8<S>, lane: usize) -> u64 {
        (*self).below(simd, slope, lane)
    }
}

/// Whether a sample lies below a receiver's horizon.
#[inline(always)]
fn is_below(slope: Vec3, [x, y]: [f32; 2]) -> bool {
    slope.z + slope.x * x + slope.y * y <= 0.0
}
