// A receiver: the point whose visibility is asked for. Written once, by a kernel of `receivers/`; every technique starts there.

const RECEIVER_NONE: u32 = 0u;     // the camera sees nothing
const RECEIVER_SURFACE: u32 = 1u;  // has a normal: its own plane blocks what lies below it
const RECEIVER_POINT: u32 = 2u;    // has no normal and no horizon

const NO_TRIANGLE: u32 = 0xffffffffu;

struct Receiver {
    position: vec3<f32>,
    triangle: u32,
    normal: vec3<f32>,
    kind: u32,
}

fn largest_component(v: vec3<f32>) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// Moves a point off its own surface by what rounding can have cost: 14 u (|p| + largest |vertex|), u = 2^-24.
// Homogeneous in the coordinates: no length is built in.
fn receiver_lift(position: vec3<f32>, normal: vec3<f32>, scene_extent: f32) -> vec3<f32> {
    let distance = 14.0 * 5.9604645e-8 * (largest_component(position) + scene_extent);
    return position + normal * distance;
}
