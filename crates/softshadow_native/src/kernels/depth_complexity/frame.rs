//! The twin of `depth_complexity/frame.wgsl`: eight receivers' projections at a time.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{Vec2, Vec3};

use crate::kernels::lanes::Vec3x8;

pub(super) const FRAME_FLAT: u32 = 0;
pub(super) const FRAME_SPHERE: u32 = 1;
pub(super) const FRAME_SUN: u32 = 2;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LightFrame {
    pub(super) origin: Vec3,
    pub(super) kind: u32,
    pub(super) x_row: Vec3,
    pub(super) size: f32,
    pub(super) y_row: Vec3,
    pub(super) area: f32,
    pub(super) z_row: Vec3,
    pub(super) outline_count: u32,
    pub(super) x_way: Vec3,
    pub(super) sample_count: u32,
    pub(super) y_way: Vec3,
    /// Standard silhouettes: the reference point says on which side of a face an edge is.
    pub(super) weighs_from_light: u32,
    pub(super) reference: Vec2,
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    reserved1: Vec2,
}

/// How eight receivers see the light: an image is `rows·(v − p)`, relative to the reference point, homogeneous.
#[derive(Clone, Copy)]
pub(super) struct FrameView<S: Simd> {
    pub(super) position: Vec3x8<S>,
    /// False behind a flat light, and inside a sphere.
    pub(super) exists: mask32x8<S>,
    pub(super) x_row: Vec3x8<S>,
    pub(super) y_row: Vec3x8<S>,
    pub(super) z_row: Vec3x8<S>,
    /// A sphere: geometry counts where `towards·(v − p) < limit`.
    pub(super) limited: bool,
    pub(super) limit: f32x8<S>,
    pub(super) cap: f32x8<S>,
    pub(super) tangent: f32x8<S>,
    pub(super) inside: mask32x8<S>,
    pub(super) x_way: Vec3x8<S>,
    pub(super) y_way: Vec3x8<S>,
    /// To the reference point; on sun and sphere its direction.
    pub(super) way: Vec3x8<S>,
    pub(super) towards: Vec3x8<S>,
}

/// How far a point of the unit disc, at squared radius `share`, is moved off the axis at distance 1, so that equal areas become
/// equal solid angles.
#[inline(always)]
fn cap_reach<S: Simd>(cap: f32x8<S>, share: f32x8<S>) -> f32x8<S> {
    (cap * (2.0 - share * cap)).sqrt() / (1.0 - share * cap)
}

impl LightFrame {
    /// What eight receivers see of the light.
    #[inline(always)]
    pub(super) fn view<S: Simd>(&self, simd: S, position: Vec3x8<S>) -> FrameView<S> {
        let c = self.reference;
        let zero = f32x8::splat(simd, 0.0);
        let x_row = Vec3x8::splat(simd, self.x_row);
        let y_row = Vec3x8::splat(simd, self.y_row);
        let z_row = Vec3x8::splat(simd, self.z_row);
        match self.kind {
            FRAME_FLAT => {
                let from_light = position - Vec3x8::splat(simd, self.origin);
                let height = z_row.dot(from_light);
                FrameView {
                    position,
                    exists: height.simd_gt(zero),
                    x_row: x_row.scale(height) - z_row.scale(x_row.dot(from_light) - c.x),
                    y_row: y_row.scale(height) - z_row.scale(y_row.dot(from_light) - c.y),
                    z_row: Vec3x8::splat(simd, -self.z_row),
                    limited: false,
                    limit: zero,
                    cap: zero,
                    tangent: zero,
                    inside: mask32x8::splat(simd, false),
                    x_way: Vec3x8::splat(simd, self.x_way),
                    y_way: Vec3x8::splat(simd, self.y_way),
                    way: Vec3x8::splat(simd, self.x_way * c.x + self.y_way * c.y) - from_light,
                    towards: Vec3x8::splat(simd, -self.z_row),
                }
            }
            FRAME_SUN => angular_view(simd, position, [x_row, y_row, z_row], f32x8::splat(simd, self.size), c),
            _ => {
                let way = Vec3x8::splat(simd, self.origin) - position;
                let one = f32x8::splat(simd, 1.0);
                let squared = way.dot(way).max(f32x8::splat(simd, 1e-37));
                let sine_squared = f32x8::splat(simd, self.size * self.size) / squared;
                let distance = squared.sqrt();
                let towards = Vec3x8::new(way.x / distance, way.y / distance, way.z / distance);
                let outside = (1.0 - sine_squared).max(zero);
                let cap = (sine_squared / (1.0 + outside.sqrt())).min(f32x8::splat(simd, 0.999));
                let reach = cap_reach(cap, one);
                let tangent = reach.simd_gt(zero).select(reach, one);
                // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
                let s = towards.z.simd_ge(zero).select(one, -one);
                let a = -1.0 / (s + towards.z);
                let b = towards.x * towards.y * a;
                let x = Vec3x8::new(1.0 + s * towards.x * towards.x * a, s * b, -s * towards.x);
                let y = Vec3x8::new(b, s + towards.y * towards.y * a, -towards.y);
                let view = angular_view(simd, position, [x, Vec3x8::new(-y.x, -y.y, -y.z), towards], tangent, c);
                let inside = sine_squared.simd_ge(one);
                let limit = distance * outside;
                FrameView { exists: !inside, inside, limited: true, limit, cap, tangent: reach, ..view }
            }
        }
    }

    /// Where a sample lies relative to the reference point. Those of a sphere are points of the unit disc that move with the receiver.
    #[inline(always)]
    pub(super) fn placed_sample<S: Simd>(&self, simd: S, view: &FrameView<S>, sample: [f32x8<S>; 2]) -> [f32x8<S>; 2] {
        if self.kind != FRAME_SPHERE {
            return sample;
        }
        let [x, y] = sample;
        let zero = f32x8::splat(simd, 0.0);
        let stretch = cap_reach(view.cap, x * x + y * y) / view.tangent;
        let stretch = view.tangent.simd_gt(zero).select(stretch, zero);
        [x * stretch - self.reference.x, y * stretch - self.reference.y]
    }
}

#[inline(always)]
fn angular_view<S: Simd>(
    simd: S,
    position: Vec3x8<S>,
    [x, y, towards]: [Vec3x8<S>; 3],
    tangent: f32x8<S>,
    c: Vec2,
) -> FrameView<S> {
    let zero = f32x8::splat(simd, 0.0);
    let (cx, cy) = (f32x8::splat(simd, c.x), f32x8::splat(simd, c.y));
    let depth = towards.scale(tangent);
    FrameView {
        position,
        exists: mask32x8::splat(simd, true),
        x_row: x - depth.scale(cx),
        y_row: y - depth.scale(cy),
        z_row: depth,
        limited: false,
        limit: zero,
        cap: zero,
        tangent: zero,
        inside: mask32x8::splat(simd, false),
        x_way: x.scale(tangent),
        y_way: y.scale(tangent),
        way: towards + (x.scale(cx) + y.scale(cy)).scale(tangent),
        towards,
    }
}

impl<S: Simd> FrameView<S> {
    #[inline(always)]
    pub(super) fn project(&self, way: Vec3x8<S>) -> Vec3x8<S> {
        Vec3x8::new(self.x_row.dot(way), self.y_row.dot(way), self.z_row.dot(way))
    }
}
