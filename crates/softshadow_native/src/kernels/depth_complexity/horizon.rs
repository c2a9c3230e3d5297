//! The twin of `depth_complexity/horizon.wgsl`: the receivers' own planes on the light. Samples where `slope.x·x + slope.y·y + slope.z ≤ 0` are
//! hidden.

use fearless_simd::{Simd, mask32x8, prelude::*};

use super::frame::{FrameView, LightFrame};
use crate::kernels::lanes::Vec3x8;

#[inline(always)]
pub(super) fn horizon_slope<S: Simd>(view: &FrameView<S>, normal: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8::new(normal.dot(view.x_way), normal.dot(view.y_way), normal.dot(view.way))
}

/// Where the whole light lies above the horizon of those that have one.
#[inline(always)]
pub(super) fn is_above_horizon<S: Simd>(frame: &LightFrame, slope: Vec3x8<S>) -> mask32x8<S> {
    let lowest =
        (slope.x * frame.low.x).min(slope.x * frame.high.x) + (slope.y * frame.low.y).min(slope.y * frame.high.y);
    (slope.z + lowest).simd_gt(0.0)
}
