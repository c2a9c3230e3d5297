//! The twin of `depth_complexity/area.wgsl`: how much of the light lies beyond an edge, for eight receivers.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::Vec2;

use super::coverage::Crossing;
use super::edge::{EdgeImage, Vec2x8};
use crate::kernels::lanes::Vec3x8;

/// The sector and line of an edge, as areas take them: the reference point lies left of the line.
#[derive(Clone, Copy)]
pub(super) struct Beyond<S: Simd> {
    line: Vec3x8<S>,
    from: Vec2x8<S>,
    to: Vec2x8<S>,
}

/// A side of the light that does not point at the reference point, in the order in which that sees its ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// Corners, by their places.
    start: usize,
    end: usize,
    is_forward: bool,
    /// The turn from start to end.
    turn: f32,
}

/// The outline of a light.
pub(super) enum Outline {
    Polygon {
        corners: Vec<Vec2>,
        sides: Vec<Side>,
    },
    /// The middle of a disc of radius 1.
    Disc(Vec2),
}

fn turn(a: Vec2, b: Vec2) -> f32 {
    a.x * b.y - a.y * b.x
}

#[inline(always)]
fn turn8<S: Simd>(a: Vec2x8<S>, b: Vec2x8<S>) -> f32x8<S> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn dot8<S: Simd>(a: Vec2x8<S>, b: Vec2x8<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn splat2<S: Simd>(simd: S, v: Vec2) -> Vec2x8<S> {
    [f32x8::splat(simd, v.x), f32x8::splat(simd, v.y)]
}

#[inline(always)]
fn select2<S: Simd>(mask: mask32x8<S>, yes: Vec2x8<S>, no: Vec2x8<S>) -> Vec2x8<S> {
    [mask.select(yes[0], no[0]), mask.select(yes[1], no[1])]
}

/// `a + (b − a)·share`.
#[inline(always)]
fn between<S: Simd>(a: Vec2x8<S>, b: Vec2x8<S>, share: f32x8<S>) -> Vec2x8<S> {
    [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
}

/// The first of two parts as a share of both; 0 where they are nothing together.
#[inline(always)]
fn share<S: Simd>(simd: S, part: f32x8<S>, other: f32x8<S>) -> f32x8<S> {
    let (zero, whole) = (f32x8::splat(simd, 0.0), part + other);
    whole.simd_gt(zero).select(part / whole.max(f32x8::splat(simd, 1e-37)), zero)
}

/// Where the circle of radius 1 around `center`, which holds the origin, is met in a direction.
#[inline(always)]
fn on_circle<S: Simd>(simd: S, center: Vec2x8<S>, direction: Vec2x8<S>) -> Vec2x8<S> {
    let size = dot8(direction, direction).sqrt().max(f32x8::splat(simd, 1e-37));
    let d = [direction[0] / size, direction[1] / size];
    let along = dot8(d, center);
    let rest = (along * along + 1.0 - dot8(center, center)).max(f32x8::splat(simd, 0.0)).sqrt();
    [d[0] * (along + rest), d[1] * (along + rest)]
}

impl Outline {
    pub(super) fn polygon(corners: Vec<Vec2>) -> Self {
        let count = corners.len();
        let side = |corner: usize| {
            let (a, b) = ((corner + count - 1) % count, corner);
            let facing = turn(corners[a], corners[b]);
            let (start, end) = if facing > 0.0 { (a, b) } else { (b, a) };
            let turn = turn(corners[start], corners[end]);
            (facing != 0.0).then_some(Side { start, end, is_forward: facing > 0.0, turn })
        };
        let sides = (0..count).filter_map(side).collect();
        Self::Polygon { corners, sides }
    }
}

impl<S: Simd> Beyond<S> {
    #[inline(always)]
    pub(super) fn of(image: &EdgeImage<S>, crossing: &Crossing<S>) -> Self {
        let line = image.line;
        let turned = Vec3x8::new(-line.x, -line.y, -line.z);
        Self { line: Vec3x8::select(crossing.beyond_left, line, turned), from: crossing.from, to: crossing.to }
    }

    /// The area of the light beyond the edge; of lanes that are not wanted it may be any.
    #[inline(always)]
    pub(super) fn area(&self, simd: S, outline: &Outline, wanted: mask32x8<S>) -> f32x8<S> {
        match outline {
            Outline::Polygon { corners, sides } => {
                let mut sum = f32x8::splat(simd, 0.0);
                for side in sides {
                    sum += self.beyond_side(simd, corners, side, wanted);
                }
                sum
            }
            Outline::Disc(center) => self.beyond_arc(simd, *center, wanted),
        }
    }

    /// The part between the origin and one side of the light; negative for a side that turns away.
    ///
    /// Turns between corners and directions come in pairs of opposite sign, and rounding is symmetric: each is computed once.
    #[inline(always)]
    fn beyond_side(&self, simd: S, corners: &[Vec2], side: &Side, wanted: mask32x8<S>) -> f32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let (start, end) = (splat2(simd, corners[side.start]), splat2(simd, corners[side.end]));
        let (from_start, from_end) = (turn8(self.from, start), turn8(self.from, end));
        let (start_to, end_to) = (turn8(start, self.to), turn8(end, self.to));
        let start_inside = from_start.simd_ge(zero) & start_to.simd_ge(zero);
        let end_inside = from_end.simd_ge(zero) & end_to.simd_ge(zero);
        let exists = (start_inside | (from_start.simd_le(zero) & from_end.simd_ge(zero)))
            & (end_inside | (start_to.simd_ge(zero) & end_to.simd_le(zero)));
        if !(exists & wanted).any_true() {
            return zero;
        }
        let turn = f32x8::splat(simd, side.turn);
        let first = share(simd, start_inside.select(zero, -from_start), start_inside.select(turn, from_end));
        let last = share(simd, end_inside.select(turn, start_to), end_inside.select(zero, -end_to));
        let (p, q) = (between(start, end, first), between(start, end, last));
        let (at_p, at_q) = (self.height(p), self.height(q));
        let span = at_p - at_q;
        let crossing = between(p, q, at_p / span.simd_ne(zero).select(span, f32x8::splat(simd, 1.0)));
        let (p_beyond, q_beyond) = (at_p.simd_lt(zero), at_q.simd_lt(zero));
        let (p, q) = (select2(p_beyond, p, crossing), select2(q_beyond, q, crossing));
        let beyond = turn8(p, q) * 0.5 * (1.0 - self.share_before(simd, p) * self.share_before(simd, q));
        let counts = exists & (p_beyond | q_beyond);
        counts.select(if side.is_forward { beyond } else { -beyond }, zero)
    }

    #[inline(always)]
    fn height(&self, p: Vec2x8<S>) -> f32x8<S> {
        self.line.x * p[0] + self.line.y * p[1] + self.line.z
    }

    /// The share of the way from the origin to a point beyond the line, or on it, that lies before the line.
    #[inline(always)]
    fn share_before(&self, simd: S, p: Vec2x8<S>) -> f32x8<S> {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let fall = -(self.line.x * p[0] + self.line.y * p[1]);
        let share = (self.line.z / fall.max(f32x8::splat(simd, 1e-37))).max(zero).min(one);
        fall.simd_gt(zero).select(share, one)
    }

    #[inline(always)]
    fn beyond_arc(&self, simd: S, center: Vec2, wanted: mask32x8<S>) -> f32x8<S> {
        let (zero, tiny) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1e-37));
        let c = splat2(simd, center);
        let size = (self.line.x * self.line.x + self.line.y * self.line.y).sqrt().max(tiny);
        let normal = [self.line.x / size, self.line.y / size];
        let depth = dot8(normal, c) + self.line.z / size;
        let half_chord = (1.0 - depth * depth).max(zero).sqrt();
        let middle = [c[0] - normal[0] * depth, c[1] - normal[1] * depth];
        let along = [-normal[1] * half_chord, normal[0] * half_chord];
        let less = [middle[0] - along[0], middle[1] - along[1]];
        let more = [middle[0] + along[0], middle[1] + along[1]];
        let ordered = turn8(less, more).simd_ge(zero);
        let (start, end) = (select2(ordered, less, more), select2(ordered, more, less));
        let (from_start, from_end) = (turn8(self.from, start), turn8(self.from, end));
        let (start_to, end_to) = (turn8(start, self.to), turn8(end, self.to));
        let start_inside = from_start.simd_ge(zero) & start_to.simd_ge(zero);
        let end_inside = from_end.simd_ge(zero) & end_to.simd_ge(zero);
        let counts = (start_inside | (from_start.simd_le(zero) & from_end.simd_ge(zero)))
            & (end_inside | (start_to.simd_ge(zero) & end_to.simd_le(zero)))
            & half_chord.simd_gt(zero);
        if !(counts & wanted).any_true() {
            return zero;
        }
        let p = on_circle(simd, c, select2(start_inside, start, self.from));
        let q = on_circle(simd, c, select2(end_inside, end, self.to));
        let (x, y) = ([p[0] - c[0], p[1] - c[1]], [q[0] - c[0], q[1] - c[1]]);
        let (across, ahead) = (turn8(x, y), dot8(x, y));
        let angle = f32x8::from_fn(simd, |k| across.as_slice()[k].atan2(ahead.as_slice()[k]));
        let swept =
            angle.simd_lt(zero).select(angle + std::f32::consts::TAU, angle) + turn8(c, [q[0] - p[0], q[1] - p[1]]);
        let hidden = turn8(p, q) * self.share_before(simd, p) * self.share_before(simd, q);
        counts.select((swept - hidden) * 0.5, zero)
    }
}
