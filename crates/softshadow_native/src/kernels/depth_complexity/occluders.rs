//! The twin of `shared/occluders.wgsl`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::Vec3x8;

pub(super) const NO_SIDE: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Face {
    pub(super) normal: Vec3,
    pub(super) triangle: u32,
    pub(super) point: Vec3,
    pub(super) flatness: f32,
    /// Edge << 1 | backward.
    pub(super) sides: [u32; 4],
}

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct OccluderEdge {
    pub(super) low: Vec3,
    pub(super) first_incidence: u32,
    pub(super) high: Vec3,
    /// With [`UNEQUAL_FACES`] where these differ in opacity.
    pub(super) incidence_count: u32,
}

/// Set in the count of an edge's faces: whichever sides its faces are on, it can change what passes, and is never left out.
pub(super) const UNEQUAL_FACES: u32 = 0x8000_0000;

impl OccluderEdge {
    pub(super) fn face_count(&self) -> u32 {
        self.incidence_count & !UNEQUAL_FACES
    }
}

/// A face at an edge, with what decides its side.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct IncidentFace {
    pub(super) normal: Vec3,
    /// Triangle << 1 | backward.
    pub(super) reference: u32,
    pub(super) point: Vec3,
    pub(super) flatness: f32,
}

/// +1 where the canonical winding is seen counter-clockwise on the light, −1 clockwise, 0 edge-on: such a face hides nothing.
#[inline(always)]
pub(super) fn side_of_plane<S: Simd>(
    simd: S,
    normal: Vec3,
    point: Vec3,
    flatness: f32,
    position: Vec3x8<S>,
) -> i32x8<S> {
    let height: f32x8<S> = Vec3x8::splat(simd, normal).dot(position - Vec3x8::splat(simd, point));
    let (one, zero) = (i32x8::splat(simd, 1), i32x8::splat(simd, 0));
    height.simd_gt(flatness).select(one, zero) - height.simd_lt(-flatness).select(one, zero)
}
