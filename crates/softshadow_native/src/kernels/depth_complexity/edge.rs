//! The twin of `depth_complexity/edge.wgsl`: an edge's image as eight receivers see it.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

use super::frame::{FrameView, LightFrame};
use super::occluders::OccluderEdge;
use crate::kernels::lanes::Vec3x8;

/// Eight vectors of two.
pub(super) type Vec2x8<S> = [f32x8<S>; 2];

#[derive(Clone, Copy)]
pub(super) struct EdgeImage<S: Simd> {
    pub(super) low: Vec3x8<S>,
    pub(super) high: Vec3x8<S>,
    /// `line·(x, y, 1)` is positive left of it.
    pub(super) line: Vec3x8<S>,
    /// Whether the reference point lies left of it.
    pub(super) left: mask32x8<S>,
}

// Closures in these functions would be functions of their own without the processor's vectors: small functions stand in their place.

#[inline(always)]
fn high_half<S: Simd>(simd: S, v: f32x8<S>) -> f32x8<S> {
    f32x8::from_bits(v.to_bits() & u32x8::splat(simd, 0xffff_f000))
}

/// Sum of the sizes along the axes.
#[inline(always)]
fn size<S: Simd>(v: Vec3x8<S>) -> f32x8<S> {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// What a rounded product leaves out, exactly: halves of twelve bits have products without rounding.
#[inline(always)]
fn product_error<S: Simd>(simd: S, a: f32x8<S>, b: f32x8<S>, rounded: f32x8<S>) -> f32x8<S> {
    let (a_high, b_high) = (high_half(simd, a), high_half(simd, b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// Whether b lies left of a, or in line with it: the exact sign.
#[inline(always)]
fn is_left<S: Simd>(simd: S, a: Vec2x8<S>, b: Vec2x8<S>) -> mask32x8<S> {
    let p = a[0] * b[1];
    let q = a[1] * b[0];
    let ties = p.simd_eq(q);
    if !ties.any_true() {
        return p.simd_gt(q);
    }
    let exact = product_error(simd, a[0], b[1], p).simd_ge(product_error(simd, a[1], b[0], q));
    ties.select(exact, p.simd_gt(q))
}

#[inline(always)]
pub(super) fn edge_image<S: Simd>(simd: S, view: &FrameView<S>, edge: &OccluderEdge) -> EdgeImage<S> {
    let low = view.project(Vec3x8::splat(simd, edge.low) - view.position);
    let high = view.project(Vec3x8::splat(simd, edge.high) - view.position);
    let nearer = Vec3x8::select(size(low).simd_le(size(high)), low, high);
    let line = nearer.cross(view.project(Vec3x8::splat(simd, edge.high - edge.low)));
    EdgeImage { low, high, line, left: is_left(simd, [low.x, low.y], [high.x, high.y]) }
}

/// Whether the image can be crossed on the way from the reference point to the light at all.
#[inline(always)]
pub(super) fn image_matters<S: Simd>(simd: S, frame: &LightFrame, image: &EdgeImage<S>) -> mask32x8<S> {
    let (a, b) = (image.low, image.high);
    let beyond = (a.x.simd_gt(a.z * frame.high.x) & b.x.simd_gt(b.z * frame.high.x))
        | (a.x.simd_lt(a.z * frame.low.x) & b.x.simd_lt(b.z * frame.low.x))
        | (a.y.simd_gt(a.z * frame.high.y) & b.y.simd_gt(b.z * frame.high.y))
        | (a.y.simd_lt(a.z * frame.low.y) & b.y.simd_lt(b.z * frame.low.y));
    let zero = f32x8::splat(simd, 0.0);
    !beyond & (a.z.simd_gt(zero) | b.z.simd_gt(zero))
}

/// The part before a sphere's disc; nothing of it lies ahead when there is none.
#[inline(always)]
pub(super) fn before_limit<S: Simd>(
    simd: S,
    view: &FrameView<S>,
    edge: &OccluderEdge,
    image: EdgeImage<S>,
) -> EdgeImage<S> {
    if !view.limited {
        return image;
    }
    let low = view.towards.dot(Vec3x8::splat(simd, edge.low) - view.position);
    let high = view.towards.dot(Vec3x8::splat(simd, edge.high) - view.position);
    let (low_is_before, high_is_before) = (low.simd_lt(view.limit), high.simd_lt(view.limit));
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let span = high - low;
    let t = (view.limit - low) / span.simd_eq(zero).select(one, span);
    let cut = image.low + (image.high - image.low).scale(t);
    let nothing = Vec3x8::new(zero, zero, zero);
    EdgeImage {
        low: Vec3x8::select(low_is_before, image.low, Vec3x8::select(high_is_before, cut, nothing)),
        high: Vec3x8::select(high_is_before, image.high, Vec3x8::select(low_is_before, cut, nothing)),
        ..image
    }
}

impl<S: Simd> EdgeImage<S> {
    #[inline(always)]
    fn along(&self) -> Vec2x8<S> {
        [self.high.x * self.low.z - self.low.x * self.high.z, self.high.y * self.low.z - self.low.y * self.high.z]
    }

    /// Directions of the ends from the reference point, low first. An end behind the receiver is replaced by where the edge crosses the
    /// plane through the receiver along the light, infinitely far: a direction.
    #[inline(always)]
    pub(super) fn directions(&self, simd: S) -> [Vec2x8<S>; 2] {
        let zero = f32x8::splat(simd, 0.0);
        let [x, y] = self.along();
        let (low_ahead, high_ahead) = (self.low.z.simd_gt(zero), self.high.z.simd_gt(zero));
        [
            [low_ahead.select(self.low.x, -x), low_ahead.select(self.low.y, -y)],
            [high_ahead.select(self.high.x, x), high_ahead.select(self.high.y, y)],
        ]
    }

    /// On which side of the line the reference point counts.
    #[inline(always)]
    pub(super) fn line_left(&self, simd: S, [low, high]: [Vec2x8<S>; 2]) -> mask32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let opposite = (low[0] * high[0] + low[1] * high[1]).simd_lt(zero);
        opposite.select(self.left, self.line.z.simd_ge(zero))
    }
}
