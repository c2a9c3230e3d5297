//! The twin of `occlusion_layers/kernel.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use super::layers::{LAYERS_SPHERE, LAYERS_SUN, LayerFrame, LayerWindow, in_light_frame, projected};
use crate::kernels::shared::receiver::{RECEIVER_SURFACE, Receiver};

/// The light as boxes of a rectangle's frame: centre and half sizes, and what share of the light each has in every channel.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LightParts {
    boxes: [Vec4; 64],
    weights: [Vec4; 64],
    pub(super) whole: Vec4,
    count: u32,
    pub(super) channels: u32,
    pub(super) combine: u32,
    reserved: u32,
}

pub(super) const COMBINE_MAXIMUM: u32 = 1;
pub(super) const COMBINE_SUM: u32 = 2;

impl LightParts {
    pub(super) fn boxes(&self) -> &[Vec4] {
        &self.boxes[..self.count as usize]
    }

    pub(super) fn weights(&self) -> &[Vec4] {
        &self.weights[..self.count as usize]
    }
}

/// A receiver in the projected frame, and what of the light's frame it sees.
#[derive(Clone, Copy)]
pub(super) struct LayerView {
    pub(super) at: Vec3,
    light_center: Vec2,
    light_scale: Vec2,
    pub(super) is_sun: bool,
}

pub(super) fn layer_view(frame: &LayerFrame, inverse_distance: f32, receiver: Vec3) -> LayerView {
    let q = in_light_frame(frame, receiver);
    let is_sun = frame.kind == LAYERS_SUN;
    let light_scale = Vec2::splat(if is_sun { frame.tangent } else { 1.0 });
    let at = projected(q, inverse_distance);
    let mut view = LayerView { at, light_center: Vec2::ZERO, light_scale, is_sun };
    if frame.kind == LAYERS_SPHERE {
        // A ball of radius 1 across, seen from here: its outline on the plane through its middle, axis by axis.
        let depth = q.z * frame.tangent;
        for axis in 0..2 {
            let a = q[axis];
            let squared = (a * a + depth * depth).max(1.0001);
            let sine = 1.0 / squared.sqrt();
            let cosine = (1.0 - sine * sine).max(0.0).sqrt();
            let plus = (a * cosine + depth * sine) / (depth * cosine - a * sine).max(1e-6);
            let minus = (a * cosine - depth * sine) / (depth * cosine + a * sine).max(1e-6);
            view.light_center[axis] = a - depth * 0.5 * (plus + minus);
            view.light_scale[axis] = depth * 0.5 * (plus - minus);
        }
    }
    view
}

/// Lowest and highest corner of the part's image on the plane at a depth before the receiver, in texels.
pub(super) fn kernel_box(view: &LayerView, window: &LayerWindow, part: Vec4, depth: f32) -> [Vec2; 2] {
    let share = depth / view.at.z.max(1e-30);
    let (reach, base) =
        if view.is_sun { (view.at.z - depth, view.at.truncate()) } else { (1.0 - share, view.at.truncate() * share) };
    let center = base + reach * (view.light_center + view.light_scale * part.xy());
    let half_size = reach * view.light_scale * part.zw();
    let middle = (center - window.low) * window.texels;
    // Less than a texel is not known: the share is that of a texel in the same place.
    let half_texels = (half_size * window.texels).max(Vec2::splat(0.5));
    [middle - half_texels, middle + half_texels]
}

/// The share of a box of the light that lies above a line: offset + slope·s >= 0 over [-half, half].
fn share_above(offset: f32, slope: Vec2) -> f32 {
    let (long, short) = (slope.abs().max_element(), slope.abs().min_element());
    if offset >= long + short {
        return 1.0;
    }
    if offset <= -long - short {
        return 0.0;
    }
    let to_corner = long + short - offset.abs();
    let smaller = if to_corner < 2.0 * short {
        to_corner * to_corner / (8.0 * long * short).max(1e-30)
    } else {
        0.5 - offset.abs() / (2.0 * long).max(1e-30)
    };
    if offset < 0.0 { smaller } else { 1.0 - smaller }
}

/// The way from a receiver to a place on the light; towards a sun as long as it is for one unit of depth.
pub(super) fn way_to(frame: &LayerFrame, receiver: &Receiver, view: &LayerView, place: Vec2) -> Vec3 {
    let begin = if view.is_sun { -frame.row_z } else { frame.origin - receiver.position };
    let at = view.light_center + view.light_scale * place;
    begin + frame.row_x * (at.x / frame.row_x.dot(frame.row_x)) + frame.row_y * (at.y / frame.row_y.dot(frame.row_y))
}

/// The share of a part of the light that lies above the receiver's own plane.
pub(super) fn horizon_share(frame: &LayerFrame, receiver: &Receiver, view: &LayerView, part: Vec4) -> f32 {
    if receiver.kind != RECEIVER_SURFACE {
        return 1.0;
    }
    let way = if view.is_sun { -frame.row_z } else { frame.origin - receiver.position };
    let slope = Vec2::new(
        receiver.normal.dot(frame.row_x) / frame.row_x.dot(frame.row_x),
        receiver.normal.dot(frame.row_y) / frame.row_y.dot(frame.row_y),
    );
    let middle = view.light_center + view.light_scale * part.xy();
    share_above(receiver.normal.dot(way) + slope.dot(middle), slope * view.light_scale * part.zw())
}
