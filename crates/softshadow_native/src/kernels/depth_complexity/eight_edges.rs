//! Eight edges side by side, each with its first face and its last.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

use super::occluders::{IncidentFace, OccluderEdge, UNEQUAL_FACES};
use crate::kernels::lanes::{LANES, Vec3x8, transposed};

/// Eight faces at edges.
#[derive(Clone, Copy)]
pub(super) struct EightFaces<S: Simd> {
    /// The other way round where the face lies backwards at its edge: a side of this plane is already turned.
    pub(super) normal: Vec3x8<S>,
    pub(super) point: Vec3x8<S>,
}

impl<S: Simd> EightFaces<S> {
    #[inline(always)]
    fn new(simd: S, incident_faces: &[IncidentFace], at: [u32; LANES]) -> Self {
        let words = transposed(simd, |k| bytemuck::cast(incident_faces[at[k] as usize]));
        let sign = (words[3] & 1) << 31;
        Self { normal: vector(&[words[0] ^ sign, words[1] ^ sign, words[2] ^ sign]), point: vector(&words[4..7]) }
    }
}

#[derive(Clone, Copy)]
pub(super) struct EightEdges<S: Simd> {
    pub(super) low: Vec3x8<S>,
    pub(super) high: Vec3x8<S>,
    /// With [`UNEQUAL_FACES`] where these differ in opacity.
    pub(super) incidence_count: u32x8<S>,
    pub(super) faces: [EightFaces<S>; 2],
}

#[inline(always)]
fn vector<S: Simd>(words: &[u32x8<S>]) -> Vec3x8<S> {
    Vec3x8::new(f32x8::from_bits(words[0]), f32x8::from_bits(words[1]), f32x8::from_bits(words[2]))
}

impl<S: Simd> EightEdges<S> {
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        edges: &[OccluderEdge],
        incident_faces: &[IncidentFace],
        edge: impl Fn(usize) -> usize,
    ) -> Self {
        let record = |k: usize| &edges[edge(k)];
        let words = transposed(simd, |k| bytemuck::cast(*record(k)));
        let face_count = words[7] & !UNEQUAL_FACES;
        let last_face = words[3] + face_count - 1;
        let faces = [
            EightFaces::new(simd, incident_faces, words[3].to_array()),
            EightFaces::new(simd, incident_faces, last_face.to_array()),
        ];
        Self { low: vector(&words[0..3]), high: vector(&words[4..7]), incidence_count: words[7], faces }
    }

    /// Which have exactly two faces, of one opacity.
    #[inline(always)]
    pub(super) fn are_pairs(&self) -> mask32x8<S> {
        self.incidence_count.simd_eq(2)
    }
}

/// On which side of eight planes something lies: on neither where they meet it.
#[derive(Clone, Copy)]
pub(super) struct Sides<S: Simd> {
    pub(super) above: mask32x8<S>,
    pub(super) below: mask32x8<S>,
}

impl<S: Simd> Sides<S> {
    #[inline(always)]
    pub(super) fn new(height: f32x8<S>, margin: f32x8<S>) -> Self {
        Self { above: height.simd_gt(margin), below: height.simd_lt(-margin) }
    }

    #[inline(always)]
    pub(super) fn are_known(self) -> mask32x8<S> {
        self.above | self.below
    }

    /// Where one plane sees it from the other side than the other.
    #[inline(always)]
    pub(super) fn are_opposite(self, other: Self) -> mask32x8<S> {
        (self.above & other.below) | (self.below & other.above)
    }
}

/// Lanes of which there are so many.
#[inline(always)]
pub(super) fn first_lanes<S: Simd>(simd: S, count: usize) -> mask32x8<S> {
    mask32x8::from_bitmask(simd, (1 << count.min(LANES)) - 1)
}
