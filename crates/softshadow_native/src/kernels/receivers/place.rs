//! The twin of `receivers/place.wgsl`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::receiver::{LIFT, NO_TRIANGLE, RECEIVER_NONE, RECEIVER_POINT, RECEIVER_SURFACE, Receiver};

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

    /// Where eight rays along `d` meet a triangle each.
    #[inline(always)]
    pub(super) fn receivers_on<S: Simd>(
        &self,
        simd: S,
        d: Vec3x8<S>,
        [v0, v1, v2]: [Vec3x8<S>; 3],
        triangles: [u32; LANES],
    ) -> [Receiver; LANES] {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let eye = Vec3x8::splat(simd, self.eye);
        let (a, b, c) = (v0 - eye, v1 - eye, v2 - eye);
        let [mut u, mut v, mut w] = [d.dot(b.cross(c)), -d.dot(a.cross(c)), d.dot(a.cross(b))];
        let facing = (u + v + w).simd_ge(zero).select(one, -one);
        [u, v, w] = [(u * facing).max(zero), (v * facing).max(zero), (w * facing).max(zero)];
        let sum = u + v + w;
        let has_sum = sum.simd_gt(zero);
        let third = f32x8::splat(simd, 1.0 / 3.0);
        [u, v, w] = [has_sum.select(u / sum, third), has_sum.select(v / sum, third), has_sum.select(w / sum, third)];
        let position = v0.scale(u) + v1.scale(v) + v2.scale(w);
        let (side1, side2) = (v1 - v0, v2 - v0);
        let scale = side1.largest_component().max(side2.largest_component());
        let raw = side1.over(scale).cross(side2.over(scale));
        let toward_camera = raw.scale(raw.dot(a).simd_lt(zero).select(one, -one));
        let squared = toward_camera.dot(toward_camera);
        let normal = toward_camera.over(squared.sqrt().max(f32x8::splat(simd, 1e-30)));
        let lift = (position.largest_component() + self.scene_extent) * LIFT;
        let lifted = position + normal.scale(lift);
        let has_normal = squared.simd_gt(zero).to_bitmask();
        let mut receivers = [NOTHING; LANES];
        for (k, receiver) in receivers.iter_mut().enumerate() {
            let kind = if has_normal >> k & 1 == 1 { RECEIVER_SURFACE } else { RECEIVER_POINT };
            *receiver = Receiver { position: lifted.lane(k), triangle: triangles[k], normal: normal.lane(k), kind };
        }
        receivers
    }
}
