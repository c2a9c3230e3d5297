// Depth of the nearest occluder as seen from the light's centre.
//#import shared/shadow_view.wgsl

@group(0) @binding(0) var<uniform> shadow_view: ShadowView;

@vertex
fn draw(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    let p = position - shadow_view.eye;
    let distance = dot(shadow_view.forward, p);
    let w = select(1.0, distance, shadow_view.perspective > 0.0);
    let depth = select(1.0 - distance / shadow_view.near, shadow_view.near, shadow_view.perspective > 0.0);
    return vec4<f32>(dot(shadow_view.clip_x, p), dot(shadow_view.clip_y, p), depth, w);
}

// Written from the distance (the fragment's w is its reciprocal): GL would squeeze a reversed depth through -1 ... 1 and lose
// nearly all of it.
@fragment
fn write_depth(@builtin(position) at: vec4<f32>) -> @builtin(frag_depth) f32 {
    return select(at.z, shadow_view.near * at.w, shadow_view.perspective > 0.0);
}
