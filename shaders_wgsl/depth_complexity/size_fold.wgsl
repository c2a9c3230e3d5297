// Turns the number of parts with edges into the sizes of two indirect dispatches: a group for the bundles of eight parts, and a group a
// part and 64 samples.
//#import shared/slice.wgsl
//#import depth_complexity/frame.wgsl
//#import depth_complexity/tiles.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<storage, read_write> counts: ListCounts;
@group(0) @binding(3) var<storage, read_write> dispatch_size: array<u32, 3>;
@group(0) @binding(4) var<storage, read_write> narrow_size: array<u32, 3>;

const LARGEST_ROW: u32 = 65535u;

fn rows(groups: u32) -> u32 {
    return (groups + LARGEST_ROW - 1u) / LARGEST_ROW;
}

@compute @workgroup_size(1)
fn size_fold() {
    let groups = atomicLoad(&counts.parts) * slice.count;
    dispatch_size[0] = min(groups, LARGEST_ROW);
    dispatch_size[1] = rows(groups);
    dispatch_size[2] = (light_frame.sample_count + 63u) / 64u;
    let narrow_groups = (groups * BUNDLES + 63u) / 64u;
    narrow_size[0] = min(narrow_groups, LARGEST_ROW);
    narrow_size[1] = rows(narrow_groups);
    narrow_size[2] = 1u;
}
