// Which triangles can hide the light from any receiver at all, and how far these reach.
//#import shared/triangle.wgsl
//#import occlusion_layers/outline.wgsl

struct CasterRange {
    box_center: vec3<f32>,        // of all receivers
    inverse_distance: f32,
    box_half: vec3<f32>,
    farthest: f32,                // projected depth of the farthest receiver
    hull_low: vec2<f32>,          // of all that lies between light and receivers, projected
    hull_high: vec2<f32>,
    light: array<vec4<f32>, 4>,   // corners of a box around the light and 1, or directions towards a sun and 0
    light_reach: f32,             // radius of a ball around each of them
    extent: f32,                  // largest coordinate of any vertex
    is_square: u32,               // whether texels are as wide as high in half sizes of the light
    reserved: u32,
}

// Bounds over the casters, as keys that only grow, so that zero is where they begin; areas in units of 2^-22 of the receivers' box.
struct CasterBounds {
    low: array<atomic<u32>, 3>,
    high: array<atomic<u32>, 3>,
    count: atomic<u32>,
    edge_on: atomic<u32>,   // area of the casters that the projection sees from the side
    area: atomic<u32>,      // of all casters
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

// A key that is greater for a greater number.
fn key_of(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn number_of(key: u32) -> f32 {
    return bitcast<f32>(select(~key, key & 0x7fffffffu, (key & 0x80000000u) != 0u));
}

// A triangle hides something from somebody only if its plane has part of the light on one side and a receiver on the other: a floor under
// all receivers, and the walls around them, do not. What rounding and a receiver's lift can do is no side.
fn can_hide(range: CasterRange, p0: vec3<f32>, normal: vec3<f32>) -> bool {
    let size = length(normal);
    let middle = dot(normal, range.box_center - p0);
    let reach = dot(abs(normal), range.box_half);
    let receiver_slack = 32.0 * 5.9604645e-8 * size * (largest(range.box_center) + largest(range.box_half) + range.extent);
    let receivers = vec2<f32>(middle - reach + receiver_slack, middle + reach - receiver_slack);
    var light = vec2<f32>(1e30, -1e30);
    var slack = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let corner = range.light[k];
        let side = dot(normal, corner.xyz - p0 * corner.w);
        light = vec2<f32>(min(light.x, side), max(light.y, side));
        slack = max(slack, 32.0 * 5.9604645e-8 * size * (largest(corner.xyz) + range.extent));
    }
    light += vec2<f32>(slack - range.light_reach * size, range.light_reach * size - slack);
    // Both on one side, or in the plane.
    let all_above = receivers.x >= 0.0 && light.x >= 0.0;
    let all_below = receivers.y <= 0.0 && light.y <= 0.0;
    return !all_above && !all_below;
}

fn largest(v: vec3<f32>) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}
