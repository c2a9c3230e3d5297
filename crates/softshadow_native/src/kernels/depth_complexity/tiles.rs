//! The twin of `depth_complexity/tiles.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

pub(super) const TILE: usize = 64;

/// Depth of the reference point of a receiver that does not look at the light: nothing there, behind it, or all of it below the horizon.
pub(super) const NO_VIEW: i32 = -2_147_483_647;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct TilePart {
    /// `plane.xyz · v > plane.w`: v is outside the shaft.
    pub(super) planes: [Vec4; 5],
    pub(super) low: Vec3,
    /// Receivers with a view of the light; 0 for none.
    pub(super) receiver_count: u32,
    pub(super) high: Vec3,
    /// Whether any face lies in the shaft.
    pub(super) has_faces: u32,
}

/// A receiver in the order of the tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Slot {
    pub(super) receiver: u32,
    /// Of its tile.
    pub(super) part: u32,
    /// Of the reference point, or [`NO_VIEW`].
    pub(super) depth: i32,
    /// Of the reference point, in units.
    pub(super) attenuation: i32,
}

/// Words of `ListCounts`: what the passes over the lists report.
pub(super) mod count {
    /// Parts with edges.
    pub(in crate::kernels::depth_complexity) const PARTS: usize = 0;
    /// Chunks handed out; the first is left unused, 0 ends a list.
    pub(in crate::kernels::depth_complexity) const CHUNKS: usize = 1;
    /// Edges in all lists.
    pub(in crate::kernels::depth_complexity) const EDGES: usize = 2;
    /// Receivers for which a list had no room, or a counter no bit.
    pub(in crate::kernels::depth_complexity) const UNFINISHED: usize = 3;
    /// Receivers that areas answered.
    pub(in crate::kernels::depth_complexity) const BY_AREA: usize = 4;
    /// Receivers with more attenuation than a sum holds.
    pub(in crate::kernels::depth_complexity) const OVERFLOWED: usize = 5;
}

/// Receivers of a bundle, and bundles of a tile.
pub(super) const BUNDLE: usize = 8;
pub(super) const BUNDLES: usize = 8;

/// Words of the head of a part's lists: the part, the first chunk of its list, and the first chunks of its bundles' lists.
pub(super) const HEAD: usize = 10;

/// Words of a chunk: the next chunk, how many entries stand in this one, and those.
pub(super) const CHUNK: usize = 32;
pub(super) const CHUNK_EDGES: usize = 30;

pub(super) fn first_chunk_word(tile_count: usize) -> usize {
    2 * HEAD * tile_count
}

pub(super) const EDGE_BITS: u32 = 29;

/// The edge of an entry. An entry is an edge and its weight, −2 to 2, 0 where each receiver finds its own.
pub(super) fn listed_edge(entry: u32) -> u32 {
    entry & ((1 << EDGE_BITS) - 1)
}

/// 0 where it is not listed.
pub(super) fn listed_weight(entry: u32) -> i32 {
    match entry >> EDGE_BITS {
        0 => 0,
        code => code as i32 - 4,
    }
}
