//! The twin of `occlusion_layers/casters.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct CasterRange {
    /// Of all receivers.
    pub(super) box_center: Vec3,
    pub(super) inverse_distance: f32,
    pub(super) box_half: Vec3,
    /// Projected depth of the farthest receiver.
    pub(super) farthest: f32,
    /// Of all that lies between light and receivers, projected.
    pub(super) hull_low: Vec2,
    pub(super) hull_high: Vec2,
    /// Corners of a box around the light and 1, or directions towards a sun and 0.
    light: [Vec4; 4],
    /// Radius of a ball around each of them.
    light_reach: f32,
    /// Largest coordinate of any vertex.
    extent: f32,
    /// Whether texels are as wide as high in half sizes of the light.
    pub(super) is_square: u32,
    reserved: u32,
}

/// Words of `CasterBounds`.
pub(super) mod bound {
    pub(in super::super) const LOW: usize = 0;
    pub(in super::super) const HIGH: usize = 3;
    pub(in super::super) const COUNT: usize = 6;
    pub(in super::super) const EDGE_ON: usize = 7;
    pub(in super::super) const AREA: usize = 8;
}

/// A key that is greater for a greater number.
pub(super) fn key_of(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits & 0x8000_0000 == 0 { bits | 0x8000_0000 } else { !bits }
}

pub(super) fn number_of(key: u32) -> f32 {
    f32::from_bits(if key & 0x8000_0000 == 0 { !key } else { key & 0x7fff_ffff })
}

/// Whether a triangle's plane has part of the light on one side and a receiver on the other.
pub(super) fn can_hide(range: &CasterRange, p0: Vec3, normal: Vec3) -> bool {
    const SLACK: f32 = 32.0 * 5.960_464_5e-8;
    let size = normal.length();
    let middle = normal.dot(range.box_center - p0);
    let reach = normal.abs().dot(range.box_half);
    let receiver_slack = SLACK * size * (largest(range.box_center) + largest(range.box_half) + range.extent);
    let receivers = [middle - reach + receiver_slack, middle + reach - receiver_slack];
    let (mut low, mut high, mut slack) = (1e30_f32, -1e30_f32, 0.0_f32);
    for corner in range.light {
        let side = normal.dot(corner.xyz() - p0 * corner.w);
        (low, high) = (low.min(side), high.max(side));
        slack = slack.max(SLACK * size * (largest(corner.xyz()) + range.extent));
    }
    low += slack - range.light_reach * size;
    high += range.light_reach * size - slack;
    let all_above = receivers[0] >= 0.0 && low >= 0.0;
    let all_below = receivers[1] <= 0.0 && high <= 0.0;
    !all_above && !all_below
}

fn largest(v: Vec3) -> f32 {
    v.abs().max_element()
}
