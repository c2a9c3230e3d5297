// A receiver where the ray through a pixel's centre meets the triangle that the pixel sees.
// Recomputed from the corners rather than interpolated, so that the point lies on the triangle to rounding.
//#import shared/receiver.wgsl
//#import shared/triangle.wgsl

struct CameraRays {
    eye: vec3<f32>,
    scene_extent: f32,
    corner: vec3<f32>,
    width: u32,
    step_x: vec3<f32>,
    first_pixel: u32,
    step_y: vec3<f32>,
    reserved: u32,
}

struct SubScene {
    first_triangle: u32,
    triangle_count: u32,
}

fn no_receiver() -> Receiver {
    return Receiver(vec3<f32>(0.0), NO_TRIANGLE, vec3<f32>(0.0), RECEIVER_NONE);
}

fn pixel_of(rays: CameraRays, index: u32) -> vec2<u32> {
    let pixel = rays.first_pixel + index;
    return vec2<u32>(pixel % rays.width, pixel / rays.width);
}

// The way of a pixel's ray; 1 along the camera's axis.
fn way_of(rays: CameraRays, pixel: vec2<u32>) -> vec3<f32> {
    let center = vec2<f32>(pixel) + 0.5;
    return rays.corner + rays.step_x * center.x + rays.step_y * center.y;
}

fn receiver_on(rays: CameraRays, d: vec3<f32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, triangle: u32) -> Receiver {
    let a = v0 - rays.eye;
    let b = v1 - rays.eye;
    let c = v2 - rays.eye;
    // The rasteriser snaps vertices, so the ray may miss by a hair: weights below zero are moved to the border.
    var weights = vec3<f32>(triple(d, b, c), -triple(d, a, c), triple(d, a, b));
    let facing = select(-1.0, 1.0, weights.x + weights.y + weights.z >= 0.0);
    weights = max(weights * facing, vec3<f32>(0.0));
    let sum = weights.x + weights.y + weights.z;
    weights = select(vec3<f32>(1.0 / 3.0), weights / sum, sum > 0.0);
    let position = v0 * weights.x + v1 * weights.y + v2 * weights.z;
    // Edges are scaled first: the cross product of two short ones must not underflow.
    let scale = max(largest_component(v1 - v0), largest_component(v2 - v0));
    let raw = cross((v1 - v0) / scale, (v2 - v0) / scale);
    let toward_camera = raw * select(-1.0, 1.0, dot(raw, a) < 0.0);
    let normal = toward_camera / max(length(toward_camera), 1e-30);
    let lifted = receiver_lift(position, normal, rays.scene_extent);
    // A triangle that is a line in float32 has no normal, and so no horizon.
    let has_normal = dot(toward_camera, toward_camera) > 0.0;
    return Receiver(lifted, triangle, normal, select(RECEIVER_POINT, RECEIVER_SURFACE, has_normal));
}
