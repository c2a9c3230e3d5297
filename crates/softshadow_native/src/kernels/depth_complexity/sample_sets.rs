//! The twin of `depth_complexity/sample_sets.wgsl`: samples of all sets one after the other, two a row.

use glam::Vec2;

use crate::kernels::records;

/// Samples of all sets.
pub(super) fn of_sets(words: &[u32]) -> &[Vec2] {
    records(words)
}
