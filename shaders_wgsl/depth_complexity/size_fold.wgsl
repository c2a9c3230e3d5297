// Turns the number of parts with edges into the size of an indirect dispatch: one group a part, one row 64 samples.
//#import shared/slice.wgsl
//#import depth_complexity/frame.wgsl
//#import depth_complexity/tiles.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<storage, read_write> counts: ListCounts;
@group(0) @binding(3) var<storage, read_write> dispatch_size: array<u32, 3>;

const LARGEST_ROW: u32 = 65535u;

@compute @workgroup_size(1)
fn size_fold() {
    let groups = atomicLoad(&counts.parts) * slice.count;
    dispatch_size[0] = min(groups, LARGEST_ROW);
    dispatch_size[1] = (groups + LARGEST_ROW - 1u) / LARGEST_ROW;
    dispatch_size[2] = (light_frame.sample_count + 63u) / 64u;
}
