//! The twin of `depth_complexity/clusters.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Cluster {
    pub(super) low: Vec3,
    /// One bit an edge.
    pub(super) silhouettes: u32,
    pub(super) high: Vec3,
    pub(super) reserved: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ClusterRange {
    pub(super) edge_count: u32,
    pub(super) cluster_count: u32,
    pub(super) tile_count: u32,
    pub(super) receiver_count: u32,
}

pub(super) const CLUSTER: usize = 32;
