//! The twin of `depth_complexity/size_fold.wgsl`.

use super::tiles::{BUNDLES, count};
use crate::engine::Call;

const LARGEST_ROW: u32 = 65_535;

pub(super) fn size_fold(call: &mut Call) {
    let items = call.items.len() as u32;
    let [counts, dispatch_size, narrow_size] = call.buffers(["counts", "dispatch_size", "narrow_size"]);
    let groups = counts[count::PARTS] * items;
    let sizes = |groups: u32| [groups.min(LARGEST_ROW), groups.div_ceil(LARGEST_ROW), 1];
    dispatch_size.copy_from_slice(&sizes(groups));
    narrow_size.copy_from_slice(&sizes((groups * BUNDLES as u32).div_ceil(64)));
}
