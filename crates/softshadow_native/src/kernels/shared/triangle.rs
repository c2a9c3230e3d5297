//! The twin of `shared/triangle.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A corner of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Corner {
    pub(crate) position: Vec3,
    pub(crate) triangle: u32,
}

pub(crate) fn triple(x: Vec3, y: Vec3, z: Vec3) -> f32 {
    x.dot(y.cross(z))
}
