//! The twin of `depth_complexity/shaft.wgsl`, and of the box tests of `tiles.wgsl`: the shafts of eight groups of receivers at a time, and one
//! shaft against a box or eight.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{Vec3, Vec4};

use super::frame::{FRAME_SPHERE, FRAME_SUN, LightFrame};
use crate::kernels::lanes::{LANES, Vec3x8};

/// A side that would need more than this slope bounds nothing worth while.
const STEEPEST: f32 = 1e4;

/// Outside of which `plane.xyz · v > plane.w`: four sides and the back.
pub(super) type Planes = [Vec4; 5];

/// What the ways lead to: right, left, top and bottom of it, each outwards.
pub(super) type Target = [f32; 4];

impl LightFrame {
    /// All of the light.
    pub(super) fn whole_light(&self) -> Target {
        if self.kind == FRAME_SPHERE {
            return [self.size; 4];
        }
        let (low, high) = (self.low + self.reference, self.high + self.reference);
        [high.x, -low.x, high.y, -low.y]
    }

    /// A ball's reference point moves with the receiver; the ball holds it.
    pub(super) fn reference_point(&self) -> Target {
        let c = self.reference;
        if self.kind == FRAME_SPHERE { [self.size; 4] } else { [c.x, -c.x, c.y, -c.y] }
    }
}

/// The shafts between eight groups of receivers and one target.
pub(super) struct Shafts<'a, S: Simd> {
    frame: &'a LightFrame,
    target: Target,
    x: Vec3x8<S>,
    y: Vec3x8<S>,
    z: Vec3x8<S>,
}

/// How far the receivers seen so far reach: slopes of the four sides, or on a sun their distances, and the back.
pub(super) struct Reach<S: Simd> {
    pub(super) sides: [f32x8<S>; 4],
    pub(super) back: f32x8<S>,
}

impl<S: Simd> Reach<S> {
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let least = f32x8::splat(simd, -1e30);
        Self { sides: [least; 4], back: least }
    }

    /// The farthest of all lanes, in all lanes.
    #[inline(always)]
    pub(super) fn reduced(mut self, simd: S) -> Self {
        for side in &mut self.sides {
            *side = f32x8::splat(simd, side.reduce_max());
        }
        self.back = f32x8::splat(simd, self.back.reduce_max());
        self
    }
}

impl<'a, S: Simd> Shafts<'a, S> {
    /// With the axes along which the sides lie; those of a ball look at the receivers' centre.
    #[inline(always)]
    pub(super) fn new(simd: S, frame: &'a LightFrame, target: Target, center: Vec3x8<S>) -> Self {
        let splat = |v| Vec3x8::splat(simd, v);
        if frame.kind != FRAME_SPHERE {
            return Self { frame, target, x: splat(frame.x_row), y: splat(frame.y_row), z: splat(frame.z_row) };
        }
        let way = center - splat(frame.origin);
        let length = way.dot(way).sqrt().max(f32x8::splat(simd, 1e-30));
        let z = Vec3x8::new(way.x / length, way.y / length, way.z / length);
        let one = f32x8::splat(simd, 1.0);
        let s = z.z.simd_ge(f32x8::splat(simd, 0.0)).select(one, -one);
        let a = -1.0 / (s + z.z);
        let b = z.x * z.y * a;
        let x = Vec3x8::new(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
        let y = Vec3x8::new(b, s + z.y * z.y * a, -z.y);
        Self { frame, target, x, y, z }
    }

    /// Normal of a sun's side.
    #[inline(always)]
    fn sun_side(&self, simd: S, side: usize) -> Vec3x8<S> {
        let across = if side > 1 { self.y } else { self.x };
        let outward = if side & 1 == 1 { negated(across) } else { across };
        outward - self.z.scale(f32x8::splat(simd, self.target[side] * self.frame.size))
    }

    /// Takes one more receiver of each group in, where `counts`.
    #[inline(always)]
    pub(super) fn reach_with(&self, simd: S, before: &mut Reach<S>, p: Vec3x8<S>, counts: mask32x8<S>) {
        if self.frame.kind == FRAME_SUN {
            for (side, most) in before.sides.iter_mut().enumerate() {
                *most = most_of(*most, self.sun_side(simd, side).dot(p), counts);
            }
            before.back = most_of(before.back, -self.z.dot(p), counts);
            return;
        }
        let way = p - Vec3x8::splat(simd, self.frame.origin);
        let (x, y, depth) = (self.x.dot(way), self.y.dot(way), self.z.dot(way));
        let has_slope = depth.simd_gt(0.0);
        let divisor = depth.max(f32x8::splat(simd, 1e-37));
        for ((most, across), target) in before.sides.iter_mut().zip([x, -x, y, -y]).zip(self.target) {
            let slope = has_slope.select((across - target) / divisor, f32x8::splat(simd, STEEPEST * 2.0));
            *most = most_of(*most, slope, counts);
        }
        before.back = most_of(before.back, depth, counts);
    }

    /// The planes of all eight; `extent` is how far receivers lie from the origin.
    #[inline(always)]
    pub(super) fn planes(&self, simd: S, reach: &Reach<S>, extent: Vec3x8<S>) -> [Planes; LANES] {
        let origin = self.frame.origin;
        let from_origin = origin.abs();
        let size = (1.0 + extent.x.max(extent.y.max(extent.z))) + (from_origin.x + from_origin.y + from_origin.z);
        let origin = Vec3x8::splat(simd, origin);
        if self.frame.kind == FRAME_SUN {
            let mut planes = [widened(negated(self.z), reach.back, size); 5];
            for (side, plane) in planes[..4].iter_mut().enumerate() {
                *plane = widened(self.sun_side(simd, side), reach.sides[side], size);
            }
            return lane_by_lane(&planes);
        }
        let is_sphere = self.frame.kind == FRAME_SPHERE;
        let radius = f32x8::splat(simd, self.frame.size);
        let across = [self.x, negated(self.x), self.y, negated(self.y)];
        // Receivers around a ball do not reach as far as the ball itself.
        let farthest = if is_sphere { reach.back.max(radius) } else { reach.back };
        let mut planes = [widened(self.z, farthest + self.z.dot(origin), size); 5];
        for (k, found) in planes[..4].iter_mut().enumerate() {
            let slope = reach.sides[k];
            let plane = across[k] - self.z.scale(slope);
            // A ball reaches beyond its centre's plane: to r·sqrt(1 + slope²) across a sloping side.
            let bound =
                if is_sphere { radius * (1.0 + slope * slope).sqrt() } else { f32x8::splat(simd, self.target[k]) };
            let (plane, bound) = widened(plane, bound + plane.dot(origin), size);
            let usable = slope.simd_lt(STEEPEST);
            let nowhere = (Vec3x8::splat(simd, Vec3::ZERO), f32x8::splat(simd, 1.0));
            *found = (Vec3x8::select(usable, plane, nowhere.0), usable.select(bound, nowhere.1));
        }
        lane_by_lane(&planes)
    }
}

#[inline(always)]
fn most_of<S: Simd>(most: f32x8<S>, value: f32x8<S>, counts: mask32x8<S>) -> f32x8<S> {
    counts.select(most.max(value), most)
}

#[inline(always)]
fn negated<S: Simd>(v: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8::new(-v.x, -v.y, -v.z)
}

#[inline(always)]
fn widened<S: Simd>(plane: Vec3x8<S>, bound: f32x8<S>, size: f32x8<S>) -> (Vec3x8<S>, f32x8<S>) {
    (plane, bound + 4e-6 * (bound.abs() + plane.abs().sum() * size))
}

#[inline(always)]
fn lane_by_lane<S: Simd>(planes: &[(Vec3x8<S>, f32x8<S>); 5]) -> [Planes; LANES] {
    let mut found = [[Vec4::ZERO; 5]; LANES];
    for (k, (normal, bound)) in planes.iter().enumerate() {
        let rows = [normal.x.to_array(), normal.y.to_array(), normal.z.to_array(), bound.to_array()];
        for (lane, planes) in found.iter_mut().enumerate() {
            planes[k] = Vec4::new(rows[0][lane], rows[1][lane], rows[2][lane], rows[3][lane]);
        }
    }
    found
}

/// The planes of one shaft, one a lane, to test one box at a time.
pub(super) struct PlanesInLanes<S: Simd> {
    normal: Vec3x8<S>,
    size: Vec3x8<S>,
    bound: f32x8<S>,
}

impl<S: Simd> PlanesInLanes<S> {
    /// Lanes without a plane exclude nothing.
    #[inline(always)]
    pub(super) fn new(simd: S, planes: &Planes) -> Self {
        let plane = |k: usize| planes.get(k).copied().unwrap_or(Vec4::W);
        let normal = Vec3x8::from_fn(simd, |k| plane(k).truncate());
        Self { normal, size: normal.abs(), bound: f32x8::from_fn(simd, |k| plane(k).w) }
    }

    #[inline(always)]
    pub(super) fn meets_box(&self, simd: S, low: Vec3, high: Vec3) -> bool {
        let (middle, half) = middle_and_half(simd, Vec3x8::splat(simd, low), Vec3x8::splat(simd, high));
        !(self.normal.dot(middle) - self.size.dot(half)).simd_gt(self.bound).any_true()
    }
}

/// Which of eight boxes the shaft of these planes meets.
#[inline(always)]
pub(super) fn shaft_meets_boxes<S: Simd>(simd: S, planes: &Planes, low: Vec3x8<S>, high: Vec3x8<S>) -> mask32x8<S> {
    let (middle, half) = middle_and_half(simd, low, high);
    let mut excluded = mask32x8::splat(simd, false);
    for plane in planes {
        let normal = Vec3x8::splat(simd, plane.truncate());
        excluded |= (normal.dot(middle) - normal.abs().dot(half)).simd_gt(plane.w);
    }
    !excluded
}

#[inline(always)]
fn middle_and_half<S: Simd>(simd: S, low: Vec3x8<S>, high: Vec3x8<S>) -> (Vec3x8<S>, Vec3x8<S>) {
    let share = f32x8::splat(simd, 0.5);
    ((low + high).scale(share), (high - low).scale(share))
}
