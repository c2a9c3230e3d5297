// Turns the number of candidates into the size of an indirect dispatch, in rows where one row would exceed the limit.
//#import shared/slice.wgsl
//#import ray_traced/hierarchy.wgsl

const LARGEST_ROW: u32 = 65535u;

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> trace_range: TraceRange;
@group(0) @binding(2) var<storage, read_write> candidates: CandidateList;
@group(0) @binding(3) var<storage, read_write> dispatch_size: array<u32, 3>;

@compute @workgroup_size(1)
fn count_groups() {
    let groups = (atomicLoad(&candidates.count) * chunks_of(trace_range) + GROUP - 1u) / GROUP * slice.count;
    let rows = (groups + LARGEST_ROW - 1u) / LARGEST_ROW;
    dispatch_size[0] = min(groups, LARGEST_ROW);
    dispatch_size[1] = rows;
    dispatch_size[2] = 1u;
}
