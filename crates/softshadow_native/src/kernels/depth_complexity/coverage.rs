//! The twin of `depth_complexity/coverage.wgsl`: which samples the edge of eight receivers covers.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

use super::edge::{EdgeImage, Vec2x8};
use crate::kernels::lanes::Vec3x8;

/// What decides whether the way to a sample crosses an edge. Ends stand in the order in which the sector goes round.
#[derive(Clone, Copy)]
pub(super) struct Crossing<S: Simd> {
    pub(super) from: Vec2x8<S>,
    pub(super) to: Vec2x8<S>,
    pub(super) line: Vec3x8<S>,
    /// Whether the reference point lies on the left of the line.
    pub(super) beyond_left: mask32x8<S>,
}

/// The same of one receiver.
#[derive(Clone, Copy)]
pub(super) struct CrossingOfOne {
    pub(super) from: [f32; 2],
    pub(super) to: [f32; 2],
    pub(super) line: [f32; 3],
    pub(super) beyond_left: bool,
}

impl<S: Simd> Crossing<S> {
    #[inline(always)]
    pub(super) fn of(simd: S, image: &EdgeImage<S>) -> Self {
        let [low, high] = image.directions(simd);
        let left = image.left;
        Self {
            from: [left.select(low[0], high[0]), left.select(low[1], high[1])],
            to: [left.select(high[0], low[0]), left.select(high[1], low[1])],
            line: image.line,
            beyond_left: image.line_left(simd, [low, high]),
        }
    }

    /// Whether the ways of eight receivers to a sample each cross it.
    #[inline(always)]
    pub(super) fn crosses(&self, simd: S, [x, y]: Vec2x8<S>) -> mask32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let starts = (self.from[0] * y - self.from[1] * x).simd_ge(zero);
        let ends = (self.to[0] * y - self.to[1] * x).simd_lt(zero);
        let is_left = (self.line.x * x + self.line.y * y + self.line.z).simd_ge(zero);
        starts & ends & (is_left ^ self.beyond_left)
    }

    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> CrossingOfOne {
        let of = |v: &Vec2x8<S>| [v[0].as_slice()[k], v[1].as_slice()[k]];
        CrossingOfOne {
            from: of(&self.from),
            to: of(&self.to),
            line: self.line.lane(k).to_array(),
            beyond_left: self.beyond_left.test(k),
        }
    }
}

impl CrossingOfOne {
    #[inline(always)]
    pub(super) fn crosses(&self, [x, y]: [f32; 2]) -> bool {
        let in_sector = (self.from[0] * y - self.from[1] * x >= 0.0) & (self.to[0] * y - self.to[1] * x < 0.0);
        in_sector & ((self.line[0] * x + self.line[1] * y + self.line[2] >= 0.0) != self.beyond_left)
    }
}
