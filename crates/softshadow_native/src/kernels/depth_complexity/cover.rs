//! The twin of `depth_complexity/cover.wgsl`: how often a face covers the reference point of eight receivers.

use fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

use super::edge::{EdgeImage, Vec2x8};
use super::frame::FrameView;
use super::occluders::{Face, side_of_plane};
use crate::kernels::lanes::Vec3x8;

/// Two directions with a smaller sine between them are one, or opposite.
const NO_TURN: f32 = 1e-6;

/// The images of the edges seen so far, in the order of the winding.
#[derive(Clone, Copy)]
pub(super) struct Loop<S: Simd> {
    has_left: mask32x8<S>,
    has_right: mask32x8<S>,
    has_wide: mask32x8<S>,
    leaves: mask32x8<S>,
    returns: mask32x8<S>,
    outward: Vec2x8<S>,
    homeward: Vec2x8<S>,
}

#[inline(always)]
fn select2<S: Simd>(mask: mask32x8<S>, yes: Vec2x8<S>, no: Vec2x8<S>) -> Vec2x8<S> {
    [mask.select(yes[0], no[0]), mask.select(yes[1], no[1])]
}

#[inline(always)]
fn dot2<S: Simd>(a: Vec2x8<S>, b: Vec2x8<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1]
}

impl<S: Simd> Loop<S> {
    #[inline(always)]
    pub(super) fn empty(simd: S) -> Self {
        let (none, zero) = (mask32x8::splat(simd, false), f32x8::splat(simd, 0.0));
        Self {
            has_left: none,
            has_right: none,
            has_wide: none,
            leaves: none,
            returns: none,
            outward: [zero; 2],
            homeward: [zero; 2],
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, simd: S, image: &EdgeImage<S>, is_forward: bool) {
        let zero = f32x8::splat(simd, 0.0);
        let (low_is_ahead, high_is_ahead) = (image.low.z.simd_gt(zero), image.high.z.simd_gt(zero));
        let counts = low_is_ahead | high_is_ahead;
        let [low, high] = image.directions(simd);
        let is_left = if is_forward { image.left } else { !image.left };
        self.has_left |= counts & is_left;
        self.has_right |= counts & !is_left;
        self.has_wide |= counts & dot2(low, high).simd_lt(zero);
        let crosses = low_is_ahead ^ high_is_ahead;
        if crosses.any_true() {
            let infinite = select2(low_is_ahead, high, low);
            let goes_out = if is_forward { low_is_ahead } else { !low_is_ahead };
            self.outward = select2(crosses & goes_out, infinite, self.outward);
            self.homeward = select2(crosses & !goes_out, infinite, self.homeward);
            self.leaves |= crosses & goes_out;
            self.returns |= crosses & !goes_out;
        }
    }
}

/// The face's side times how often the loop turns around the reference point.
#[inline(always)]
pub(super) fn cover<S: Simd>(simd: S, view: &FrameView<S>, face: &Face, border: &Loop<S>) -> i32x8<S> {
    let side = side_of_plane(simd, face.normal, face.point, face.flatness, view.position);
    let (zero, one, minus_one) = (i32x8::splat(simd, 0), i32x8::splat(simd, 1), i32x8::splat(simd, -1));
    let all_left = border.has_left & !border.has_right;
    let all_right = border.has_right & !border.has_left;
    let either = all_left.select(one, all_right.select(minus_one, zero));
    let mut turns = either;
    let passes_behind = border.leaves & border.returns;
    if passes_behind.any_true() {
        let (out, home) = (border.outward, border.homeward);
        let across = out[0] * home[1] - out[1] * home[0];
        let arc = across.simd_ge(0.0).select(one, minus_one);
        let if_all_arc = either.simd_eq(arc).select(arc, zero);
        let half_turn = arc.simd_eq(side).select(if_all_arc, either.simd_eq(zero - side).select(zero, side));
        let no_length = border.has_wide.select(either, zero);
        let clear = across.abs().simd_gt(NO_TURN * dot2(out, out).sqrt() * dot2(home, home).sqrt());
        let same_way = dot2(out, home).simd_gt(0.0);
        let closed = clear.select(if_all_arc, same_way.select(no_length, half_turn));
        turns = passes_behind.select(closed, turns);
    }
    let times = side * turns;
    if !view.limited {
        return times;
    }
    // height / slope · dot(towards, way) < limit, without dividing.
    let normal = Vec3x8::splat(simd, face.normal);
    let height = normal.dot(Vec3x8::splat(simd, face.point) - view.position);
    let slope = normal.dot(view.way);
    let (no, yes) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let sign = slope.simd_gt(no).select(yes, slope.simd_lt(no).select(-yes, no));
    let before = (height * sign * view.towards.dot(view.way)).simd_lt(view.limit * slope.abs());
    before.select(times, zero)
}
