//! The twin of `ray_traced/count_groups.wgsl`. The twins that follow take their size from the list, but the buffer is an output.

use super::hierarchy::{GROUP, SAMPLES_PER_INVOCATION, TraceRange};
use crate::engine::Call;

const LARGEST_ROW: u32 = 65535;

pub(super) fn count_groups(call: &mut Call) {
    let range: TraceRange = call.uniform("trace_range");
    let [candidates, size] = call.buffers(["candidates", "dispatch_size"]);
    let chunks = (range.end_sample - range.first_sample).div_ceil(SAMPLES_PER_INVOCATION);
    let groups = (candidates[0] * chunks).div_ceil(GROUP);
    size[..3].copy_from_slice(&[groups.min(LARGEST_ROW), groups.div_ceil(LARGEST_ROW), 1]);
}
