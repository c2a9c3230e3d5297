// A hierarchy over faces, in depth-first order.
//#import shared/occluders.wgsl
//#import depth_complexity/walk.wgsl

struct TreeNode {
    low: vec3<f32>,
    skip: u32,
    high: vec3<f32>,
    leaf: u32,
}

fn node_of(words: EightWords) -> TreeNode {
    return TreeNode(
        bitcast<vec3<f32>>(words.first.xyz), words.first.w, bitcast<vec3<f32>>(words.second.xyz), words.second.w,
    );
}

const LEAF_BITS: u32 = 3u;
