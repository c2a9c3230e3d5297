//! The twin of `depth_complexity/walk.wgsl`. Its bounds of steps are a software driver's affair: here every walk ends.

/// Strides in which a pass takes its groups.
const STRIDES: usize = 32;

/// The block of work of a group: of as many blocks, rounded up to whole strides, or none where there are fewer.
pub(super) fn scattered(group: usize, blocks: usize) -> usize {
    let rows = blocks.div_ceil(STRIDES).max(1);
    (group % rows) * STRIDES + group / rows
}
