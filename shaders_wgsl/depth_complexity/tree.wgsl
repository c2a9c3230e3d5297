// A hierarchy over faces, in depth-first order, and the way to the reference point through it.
//#import depth_complexity/walk.wgsl

struct TreeNode {
    low: vec3<f32>,
    skip: u32,
    high: vec3<f32>,
    leaf: u32,
}

const LEAF_BITS: u32 = 3u;

const SLACK: f32 = 4e-6;

// Whether the line from the receiver along `way`, ahead of it, may meet a box: separating axes, widened by more than rounding.
fn way_meets(position: vec3<f32>, way: vec3<f32>, node: TreeNode) -> bool {
    let low = node.low - position;
    let high = node.high - position;
    let middle = (low + high) * 0.5;
    let half = (high - low) * 0.5;
    let wide = half + (abs(middle) + half) * SLACK;
    let size = abs(way);
    let across = abs(cross(middle, way));
    let reach = wide.yzx * size.zxy + wide.zxy * size.yzx;
    return dot(middle, way) + dot(wide, size) >= 0.0 && all(across <= reach);
}
