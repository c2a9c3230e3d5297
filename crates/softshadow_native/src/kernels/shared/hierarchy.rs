//! The twin of `shared/hierarchy.wgsl`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::Vec3x8;

/// A node, in depth-first order: where its box is missed, or it is a leaf, `skip` says where to go on.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BvhNode {
    pub(crate) low: Vec3,
    pub(crate) skip: u32,
    pub(crate) high: Vec3,
    pub(crate) leaf: u32,
}

const LEAF_BITS: u32 = 3;

impl BvhNode {
    /// The triangles of a leaf; none of another node.
    pub(crate) fn triangles(&self) -> std::ops::Range<usize> {
        let (first, count) = (self.leaf >> LEAF_BITS, self.leaf & ((1 << LEAF_BITS) - 1));
        first as usize..(first + count) as usize
    }
}

/// The reciprocal of a component that may be zero.
pub(crate) fn safe_reciprocal(v: Vec3) -> Vec3 {
    let safe = |x: f32| {
        let tiny = if x < 0.0 { -1e-20 } else { 1e-20 };
        1.0 / if x.abs() < 1e-20 { tiny } else { x }
    };
    Vec3::new(safe(v.x), safe(v.y), safe(v.z))
}

/// How much boxes are widened, so that none hides a triangle that a float32 test would meet.
pub(crate) fn box_pad(receiver: Vec3) -> f32 {
    16.0 * 5.960_464_5e-8 * (receiver.abs().max_element() + 1.0)
}

/// Eight at a time.
#[inline(always)]
pub(crate) fn eight_reciprocals<S: Simd>(simd: S, v: Vec3x8<S>) -> Vec3x8<S> {
    let splat = |x: f32| f32x8::splat(simd, x);
    let safe = |x: f32x8<S>| {
        let tiny = x.simd_lt(splat(0.0)).select(splat(-1e-20), splat(1e-20));
        splat(1.0) / x.abs().simd_lt(splat(1e-20)).select(tiny, x)
    };
    Vec3x8::new(safe(v.x), safe(v.y), safe(v.z))
}
