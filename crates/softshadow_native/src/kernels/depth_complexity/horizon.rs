//! The twin of `depth_complexity/horizon.wgsl`: the receiver's own plane on the light.

use fearless_simd::{Simd, mask32x8, prelude::*};

use super::frame::{FrameView, LightFrame};
use crate::kernels::lanes::Vec3x8;

/// Samples where slope.x·x + slope.y·y + slope.z <= 0 are hidden.
#[inline(always)]
pub(super) fn horizon_slope<S: Simd>(view: &FrameView<S>, normal: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8::new(normal.dot(view.x_way), normal.dot(view.y_way), normal.dot(view.way))
}

/// Whether the whole light lies above it.
#[inline(always)]
pub(super) fn is_above_horizon<S: Simd>(frame: &LightFrame, is_surface: mask32x8<S>, slope: Vec3x8<S>) -> mask32x8<S> {
    let (low, high) = (frame.low, frame.high);
    let lowest = (slope.x * low.x).min(slope.x * high.x) + (slope.y * low.y).min(slope.y * high.y);
    !is_surface | (slope.z + lowest).simd_gt(0.0)
}
