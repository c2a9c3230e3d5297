//! The twin of `ray_traced/bundle.wgsl`: eight receivers, each with the interval of all its rays to the light.
//!
//! A border divides by zero, or faces away, where its end of the interval does not reach it. Then a factor of 0 takes it out of the way in,
//! and an end of 1e30 out of the way out; no lane branches.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::hierarchy::{BvhNode, box_pad, safe_reciprocal};
use crate::kernels::shared::light::{LIGHT_SUN, Light, WayBounds, light_view, light_way_bounds};
use crate::kernels::shared::receiver::{RECEIVER_SURFACE, Receiver};

/// Share of the pad by which a box may lie below the receiver's plane and still count: 6.4 u, more than rounding costs, and less
/// than the receiver's lift, so that what lies in its own plane stays below.
pub(super) const HORIZON_SLACK: f32 = 0.4;

const ENDLESS: f32 = 1e30;

/// What the ways of eight receivers have to do with one border of a box.
struct Border<S: Simd> {
    enter: Vec3x8<S>,
    leave: Vec3x8<S>,
    leave_end: Vec3x8<S>,
}

impl<S: Simd> Border<S> {
    /// `way` is the end of the interval that reaches the border first on the side it `enters`.
    #[inline(always)]
    fn new(simd: S, way: &[Vec3; LANES], enters: impl Fn(f32) -> bool, leaves: impl Fn(f32) -> bool) -> Self {
        let inverse = way.map(safe_reciprocal);
        let of = |k: usize, wanted: &dyn Fn(f32) -> bool, no: f32, yes: Vec3| {
            let pick = |i: usize| if wanted(way[k][i]) { yes[i] } else { no };
            Vec3::new(pick(0), pick(1), pick(2))
        };
        Self {
            enter: Vec3x8::from_fn(simd, |k| of(k, &enters, 0.0, inverse[k])),
            leave: Vec3x8::from_fn(simd, |k| of(k, &leaves, 0.0, inverse[k])),
            leave_end: Vec3x8::from_fn(simd, |k| of(k, &leaves, ENDLESS, Vec3::ZERO)),
        }
    }
}

/// The rays of eight receivers.
pub(super) struct Bundles<S: Simd> {
    pub(super) origin: Vec3x8<S>,
    pub(super) normal: Vec3x8<S>,
    pub(super) low: Vec3x8<S>,
    pub(super) high: Vec3x8<S>,
    /// How far below its plane a receiver looks: anywhere, where it has none.
    pub(super) horizon: f32x8<S>,
    pad: f32x8<S>,
    end: f32x8<S>,
    at_low: Border<S>,
    at_high: Border<S>,
}

impl<S: Simd> Bundles<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, light: &Light, receivers: &[Receiver; LANES]) -> Self {
        let ways: [WayBounds; LANES] = receivers.map(|r| {
            let view = light_view(light, r.position);
            light_way_bounds(light, &view, r.position)
        });
        let horizon = |r: &Receiver| match r.kind {
            RECEIVER_SURFACE => -HORIZON_SLACK * box_pad(r.position),
            _ => f32::NEG_INFINITY,
        };
        let end = if light.kind == LIGHT_SUN { ENDLESS } else { 1.0 };
        Self {
            origin: Vec3x8::from_fn(simd, |k| receivers[k].position),
            normal: Vec3x8::from_fn(simd, |k| receivers[k].normal),
            low: Vec3x8::from_fn(simd, |k| ways[k].low),
            high: Vec3x8::from_fn(simd, |k| ways[k].high),
            horizon: f32x8::from_fn(simd, |k| horizon(&receivers[k])),
            pad: f32x8::from_fn(simd, |k| box_pad(receivers[k].position)),
            end: f32x8::splat(simd, end),
            at_low: Border::new(simd, &ways.map(|w| w.high), |way| way > 0.0, |way| way < 0.0),
            at_high: Border::new(simd, &ways.map(|w| w.low), |way| way < 0.0, |way| way > 0.0),
        }
    }

    /// Whether any ray of the bundle can meet the box, above the receiver's own plane.
    ///
    /// No bundle meets a box that meets not the box around it: every step rounds, but none changes an order.
    #[inline(always)]
    pub(super) fn meet(&self, simd: S, node: &BvhNode) -> mask32x8<S> {
        let low = Vec3x8::splat(simd, node.low) - self.origin;
        let high = Vec3x8::splat(simd, node.high) - self.origin;
        let pad = Vec3x8::new(self.pad, self.pad, self.pad);
        let (to_low, to_high) = (low - pad, high + pad);
        let enter = (to_low * self.at_low.enter).max(to_high * self.at_high.enter);
        let leave_low = to_low * self.at_low.leave + self.at_low.leave_end;
        let leave_high = to_high * self.at_high.leave + self.at_high.leave_end;
        let leave = leave_low.min(leave_high);
        let begin = enter.x.max(enter.y).max(enter.z.max(f32x8::splat(simd, 0.0)));
        let end = leave.x.min(leave.y).min(leave.z.min(self.end));
        let top = (self.normal * low).max(self.normal * high);
        let top = top.x + top.y + top.z;
        begin.simd_le(end * f32x8::splat(simd, 1.00001)) & top.simd_ge(self.horizon)
    }
}
