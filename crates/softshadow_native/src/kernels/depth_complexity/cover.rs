//! The twin of `depth_complexity/cover.wgsl`: how often a face covers the reference point of eight receivers, its side times how often the
//! loop of its edges' images turns around that point.

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

    /// With one more image.
    #[inline(always)]
    pub(super) fn add(&mut self, simd: S, image: &EdgeImage<S>, is_forward: bool) {
        let [low, high] = image.directions(simd);
        let zero = f32x8::splat(simd, 0.0);
        let forward = mask32x8::splat(simd, is_forward);
        let (low_is_ahead, high_is_ahead) = (image.low.z.simd_gt(zero), image.high.z.simd_gt(zero));
        let is_ahead = low_is_ahead | high_is_ahead;
        let is_right = image.left ^ forward;
        self.has_left |= is_ahead & !is_right;
        self.has_right |= is_ahead & is_right;
        self.has_wide |= is_ahead & dot2(low, high).simd_lt(zero);
        let passes = low_is_ahead ^ high_is_ahead;
        if passes.any_true() {
            let infinite = select2(low_is_ahead, high, low);
            let returns = low_is_ahead ^ forward;
            self.outward = select2(passes & !returns, infinite, self.outward);
            self.homeward = select2(passes & returns, infinite, self.homeward);
            self.leaves |= passes & !returns;
            self.returns |= passes & returns;
        }
    }
}

/// The face's side times how often the loop turns around the reference point.
#[inline(always)]
pub(super) fn cover<S: Simd>(simd: S, view: &FrameView<S>, face: &Face, border: &Loop<S>) -> i32x8<S> {
    let int = |value| i32x8::splat(simd, value);
    let zero = f32x8::splat(simd, 0.0);
    let side = side_of_plane(simd, face.normal, face.point, face.flatness, view.position);
    let all_left = border.has_left & !border.has_right;
    let all_right = border.has_right & !border.has_left;
    let either = all_left.select(int(1), all_right.select(int(-1), int(0)));
    let mut turns = either;
    let is_open = border.leaves & border.returns;
    if is_open.any_true() {
        let across = border.outward[0] * border.homeward[1] - border.outward[1] * border.homeward[0];
        let arc = across.simd_ge(zero).select(int(1), int(-1));
        let if_all_arc = either.simd_eq(arc).select(arc, int(0));
        let half_turn = arc.simd_eq(side).select(if_all_arc, either.simd_eq(-side).select(int(0), side));
        let no_length = border.has_wide.select(either, int(0));
        let length = |v: Vec2x8<S>| dot2(v, v).sqrt();
        let clear = across.abs().simd_gt(length(border.outward) * NO_TURN * length(border.homeward));
        let same_way = dot2(border.outward, border.homeward).simd_gt(zero);
        let of_open = clear.select(if_all_arc, same_way.select(no_length, half_turn));
        turns = is_open.select(of_open, turns);
    }
    let covers = side * turns;
    if !view.limited {
        return covers;
    }
    // height / slope · dot(towards, way) < limit, without dividing.
    let normal = Vec3x8::splat(simd, face.normal);
    let height = normal.dot(Vec3x8::splat(simd, face.point) - view.position);
    let slope = normal.dot(view.way);
    let one = f32x8::splat(simd, 1.0);
    let sign = slope.simd_gt(zero).select(one, slope.simd_lt(zero).select(-one, zero));
    let before = (height * sign * view.towards.dot(view.way)).simd_lt(view.limit * slope.abs());
    before.select(covers, int(0))
}
