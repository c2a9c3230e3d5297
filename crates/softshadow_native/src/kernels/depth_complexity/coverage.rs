//! The twin of `depth_complexity/coverage.wgsl`: which samples an edge covers, those in the sector of its ends, beyond its line.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

use super::edge::{EdgeImage, Vec2x8};
use crate::kernels::lanes::Vec3x8;

/// What decides whether the way to a sample crosses an edge. Ends stand in the order in which the sector goes round.
#[derive(Clone, Copy)]
pub(super) struct Crossing<S: Simd> {
    from: Vec2x8<S>,
    to: Vec2x8<S>,
    line: Vec3x8<S>,
    /// Whether the reference point lies on the left of the line.
    beyond_left: mask32x8<S>,
}

impl<S: Simd> Crossing<S> {
    #[inline(always)]
    pub(super) fn of(simd: S, image: &EdgeImage<S>) -> Self {
        let [low, high] = image.directions(simd);
        let choose =
            |yes: Vec2x8<S>, no: Vec2x8<S>| [image.left.select(yes[0], no[0]), image.left.select(yes[1], no[1])];
        Self {
            from: choose(low, high),
            to: choose(high, low),
            line: image.line,
            beyond_left: image.line_left(simd, [low, high]),
        }
    }

    #[inline(always)]
    pub(super) fn crosses(&self, simd: S, [x, y]: Vec2x8<S>) -> mask32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let turn = |from: Vec2x8<S>| from[0] * y - from[1] * x;
        let in_sector = turn(self.from).simd_ge(zero) & turn(self.to).simd_lt(zero);
        in_sector & ((self.line.x * x + self.line.y * y + self.line.z).simd_ge(zero) ^ self.beyond_left)
    }
}
