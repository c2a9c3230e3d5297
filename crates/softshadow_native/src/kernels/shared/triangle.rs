//! The twin of `shared/triangle.wgsl`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::Vec3x8;

/// A corner of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Corner {
    pub(crate) position: Vec3,
    pub(crate) triangle: u32,
}

/// Whether the segments from `p` along each `d` cross the triangle strictly between their ends; with `unbounded` they have no far end.
#[inline(always)]
pub(crate) fn triangle_blocks<S: Simd>(
    simd: S,
    [v0, v1, v2]: [Vec3; 3],
    p: Vec3,
    d: Vec3x8<S>,
    unbounded: bool,
) -> mask32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let splat = |v: Vec3| Vec3x8::splat(simd, v);
    let a = v0 - p;
    let (edge01, edge02) = (v1 - v0, v2 - v0);
    let across = d.cross(splat(a));
    let ab = across.dot(splat(edge01));
    let ac = across.dot(splat(edge02));
    let bc = d.cross(splat(v1 - p)).dot(splat(v2 - v1));
    let inside = (ab.simd_ge(zero) & bc.simd_ge(zero) & ac.simd_le(zero))
        | (ab.simd_le(zero) & bc.simd_le(zero) & ac.simd_ge(zero));
    let normal = edge01.cross(edge02);
    let offset = normal.dot(a);
    let along = splat(normal).dot(d);
    // Beyond the plane is where `along` has the sign of the offset, and its size too where the way has an end.
    let beyond = f32x8::splat(simd, if unbounded { 0.0 } else { offset.abs() });
    let ahead = if offset > 0.0 { along } else { -along };
    inside & ahead.simd_gt(beyond) & mask32x8::splat(simd, offset != 0.0)
}
