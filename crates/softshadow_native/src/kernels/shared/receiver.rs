//! The twin of `shared/receiver.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The camera sees nothing.
pub(crate) const RECEIVER_NONE: u32 = 0;
/// Has a normal: its own plane blocks what lies below it.
pub(crate) const RECEIVER_SURFACE: u32 = 1;
/// Has no normal and no horizon.
pub(crate) const RECEIVER_POINT: u32 = 2;

/// Of a receiver that lies on none.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// The point whose visibility is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Receiver {
    pub(crate) position: Vec3,
    pub(crate) triangle: u32,
    pub(crate) normal: Vec3,
    pub(crate) kind: u32,
}

/// Points are moved off their own surface by what rounding can have cost: 14 u (|p| + largest |vertex|), u = 2⁻²⁴.
pub(crate) const LIFT: f32 = 14.0 * 5.960_464_5e-8;

pub(crate) fn receiver_lift(position: Vec3, normal: Vec3, scene_extent: f32) -> Vec3 {
    position + normal * (LIFT * (position.abs().max_element() + scene_extent))
}
