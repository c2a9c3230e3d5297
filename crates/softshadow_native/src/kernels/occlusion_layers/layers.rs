//! The twin of `occlusion_layers/layers.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

pub(super) const LAYERS_SPHERE: u32 = 1;
pub(super) const LAYERS_SUN: u32 = 2;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LayerFrame {
    pub(super) origin: Vec3,
    pub(super) kind: u32,
    /// Dots with p − origin: half sizes of the light across, scene units in depth.
    pub(super) row_x: Vec3,
    /// Of half a sun's angle.
    pub(super) tangent: f32,
    pub(super) row_y: Vec3,
    pub(super) slices: u32,
    pub(super) row_z: Vec3,
    pub(super) resolution: u32,
    /// Whether every slice is written into the next one, too.
    pub(super) successors: u32,
    /// One of `FILTER_`.
    pub(super) filter_kind: u32,
    reserved: [u32; 2],
}

/// Where texels and slices are.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LayerWindow {
    /// Where the first texel begins.
    pub(super) low: Vec2,
    /// A unit of the frame.
    pub(super) texels: Vec2,
    pub(super) inverse_distance: f32,
    pub(super) slices: u32,
    pub(super) resolution: u32,
    pub(super) reserved: u32,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LayerPlaces {
    pub(super) window: LayerWindow,
    /// Depth of the far plane of every slice, ascending.
    pub(super) planes: [f32; 128],
}

impl LayerPlaces {
    /// How many slices have their far plane before a depth.
    pub(super) fn slices_before(&self, depth: f32) -> u32 {
        let (mut low, mut high) = (0, self.window.slices);
        while low < high {
            let middle = u32::midpoint(low, high);
            if self.planes[middle as usize] < depth {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }
}

pub(super) fn in_light_frame(frame: &LayerFrame, p: Vec3) -> Vec3 {
    let way = p - frame.origin;
    Vec3::new(frame.row_x.dot(way), frame.row_y.dot(way), frame.row_z.dot(way))
}

/// The projective map; for points before the light, and all of a sun.
pub(super) fn projected(q: Vec3, inverse_distance: f32) -> Vec3 {
    q / (1.0 + q.z * inverse_distance)
}
