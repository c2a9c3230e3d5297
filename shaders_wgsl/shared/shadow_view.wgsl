// One view from a light's centre: a perspective face, or the parallel view of a sun. Depth is reversed: near / distance, or
// 1 at the near plane falling to 0 at the far one.

struct ShadowView {
    eye: vec3<f32>,
    near: f32,          // distance of the near plane (perspective), or the depth of the parallel view
    clip_x: vec3<f32>,  // clip coordinates of p are dot(clip_x, p - eye) ...
    perspective: f32,   // 1 for a face, 0 for a parallel view
    clip_y: vec3<f32>,
    resolution: f32,
    forward: vec3<f32>,
    texel: f32,         // half the width of a texel at distance 1 (perspective), or everywhere (parallel)
}

struct ShadowViews {
    views: array<ShadowView, 6>,
    count: u32,
    channels: u32,
    reserved0: u32,
    reserved1: u32,
}
