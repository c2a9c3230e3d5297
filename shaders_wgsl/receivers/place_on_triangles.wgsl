// Receivers of a camera: where the ray through the pixel's centre meets the triangle that the pixel sees.
// Recomputed from the corners rather than interpolated by the rasteriser, so that the point lies on the triangle to rounding.
//#import shared/slice.wgsl
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

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> camera_rays: CameraRays;
@group(0) @binding(2) var<uniform> sub_scene: SubScene;
@group(0) @binding(3) var triangle_ids: texture_2d<u32>;
@group(0) @binding(4) var<storage, read> corners: array<Corner>;
@group(0) @binding(5) var<storage, read_write> receivers: array<Receiver>;

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let pixel = camera_rays.first_pixel + index;
    let at = vec2<u32>(pixel % camera_rays.width, pixel / camera_rays.width);
    let id = textureLoad(triangle_ids, at, 0).x;
    if (id == 0u) {
        receivers[index] = Receiver(vec3<f32>(0.0), NO_TRIANGLE, vec3<f32>(0.0), RECEIVER_NONE);
        return;
    }
    let within = id - 1u - sub_scene.first_triangle;   // wraps to a large number before the first
    if (within >= sub_scene.triangle_count) {
        return;
    }
    let v0 = corners[3u * within].position;
    let v1 = corners[3u * within + 1u].position;
    let v2 = corners[3u * within + 2u].position;
    let a = v0 - camera_rays.eye;
    let b = v1 - camera_rays.eye;
    let c = v2 - camera_rays.eye;
    let center = vec2<f32>(at) + 0.5;
    let d = camera_rays.corner + camera_rays.step_x * center.x + camera_rays.step_y * center.y;
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
    let lifted = receiver_lift(position, normal, camera_rays.scene_extent);
    // A triangle that is a line in float32 has no normal, and so no horizon.
    let has_normal = dot(toward_camera, toward_camera) > 0.0;
    receivers[index] = Receiver(lifted, id - 1u, normal, select(RECEIVER_POINT, RECEIVER_SURFACE, has_normal));
}
