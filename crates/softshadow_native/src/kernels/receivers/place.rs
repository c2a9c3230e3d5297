//! The twin of `receivers/place.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::kernels::shared::receiver::{
    NO_TRIANGLE, RECEIVER_NONE, RECEIVER_POINT, RECEIVER_SURFACE, Receiver, receiver_lift,
};
use crate::kernels::shared::triangle::triple;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct CameraRays {
    pub(super) eye: Vec3,
    scene_extent: f32,
    corner: Vec3,
    width: u32,
    step_x: Vec3,
    first_pixel: u32,
    step_y: Vec3,
    reserved: u32,
}

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SubScene {
    pub(super) first_triangle: u32,
    triangle_count: u32,
}

pub(super) const NOTHING: Receiver =
    Receiver { position: Vec3::ZERO, triangle: NO_TRIANGLE, normal: Vec3::ZERO, kind: RECEIVER_NONE };

impl CameraRays {
    /// The way of a pixel's ray; 1 along the camera's axis.
    pub(super) fn way_of(&self, index: u32) -> Vec3 {
        let pixel = self.first_pixel + index;
        let (x, y) = ((pixel % self.width) as f32 + 0.5, (pixel / self.width) as f32 + 0.5);
        self.corner + self.step_x * x + self.step_y * y
    }

    /// Where the ray along `d` meets a triangle.
    pub(super) fn receiver_on(&self, d: Vec3, [v0, v1, v2]: [Vec3; 3], triangle: u32) -> Receiver {
        let [a, b, c] = [v0, v1, v2].map(|v| v - self.eye);
        let weights = Vec3::new(triple(d, b, c), -triple(d, a, c), triple(d, a, b));
        let facing = if weights.x + weights.y + weights.z >= 0.0 { 1.0 } else { -1.0 };
        let weights = (weights * facing).max(Vec3::ZERO);
        let sum = weights.x + weights.y + weights.z;
        let weights = if sum > 0.0 { weights / sum } else { Vec3::splat(1.0 / 3.0) };
        let position = v0 * weights.x + v1 * weights.y + v2 * weights.z;
        let scale = (v1 - v0).abs().max_element().max((v2 - v0).abs().max_element());
        let raw = ((v1 - v0) / scale).cross((v2 - v0) / scale);
        let toward_camera = raw * if raw.dot(a) < 0.0 { 1.0 } else { -1.0 };
        let normal = toward_camera / toward_camera.length().max(1e-30);
        let kind = if toward_camera.dot(toward_camera) > 0.0 { RECEIVER_SURFACE } else { RECEIVER_POINT };
        Receiver { position: receiver_lift(position, normal, self.scene_extent), triangle, normal, kind }
    }
}
