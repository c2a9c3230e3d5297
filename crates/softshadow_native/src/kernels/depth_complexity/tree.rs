//! The twin of `depth_complexity/tree.wgsl`: a hierarchy over faces, and the walk through it that its users share.
//!
//! Walks have no budget of steps: that is for drivers which end loops without a word.

use std::ops::{ControlFlow, Range};

use fearless_simd::Simd;

use super::shaft::PlanesInLanes;
pub(super) use crate::kernels::shared::hierarchy::BvhNode as TreeNode;

/// Hands the faces of every leaf in a shaft to `visit`, until that breaks.
#[inline(always)]
pub(super) fn walk<S: Simd>(
    simd: S,
    tree: &[TreeNode],
    shaft: &PlanesInLanes<S>,
    mut visit: impl FnMut(Range<usize>) -> ControlFlow<()>,
) {
    let mut node = 0;
    while let Some(here) = tree.get(node) {
        let met = shaft.meets_box(simd, here.low, here.high);
        node = if met { node + 1 } else { here.skip as usize };
        if met && here.leaf != 0 && visit(here.triangles()).is_break() {
            return;
        }
    }
}
