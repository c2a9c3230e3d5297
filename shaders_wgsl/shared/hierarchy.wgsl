// The hierarchy of one sub-scene, in depth-first order: a node whose box is missed, and a leaf that is done, says where to go on.

struct BvhNode {
    low: vec3<f32>,
    skip: u32,
    high: vec3<f32>,
    leaf: u32,
}

const LEAF_BITS: u32 = 3u;

// The reciprocal of a component that may be zero. Local coordinates are of the order of 1, so what is replaced is far below
// the smallest step of any ray.
fn safe_reciprocal(x: vec3<f32>) -> vec3<f32> {
    let tiny = vec3<f32>(1e-20);
    let signed_tiny = select(tiny, -tiny, x < vec3<f32>(0.0));
    return 1.0 / select(x, signed_tiny, abs(x) < tiny);
}

// How much boxes are widened, so that none hides a triangle that a float32 test would meet.
fn box_pad(receiver: vec3<f32>) -> f32 {
    let p = abs(receiver);
    return 16.0 * 5.9604645e-8 * (max(p.x, max(p.y, p.z)) + 1.0);
}
