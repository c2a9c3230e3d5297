// Receivers of a camera, from the triangles that a rasteriser drew.
//#import shared/slice.wgsl
//#import receivers/place.wgsl

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
    let pixel = pixel_of(camera_rays, index);
    let id = textureLoad(triangle_ids, pixel, 0).x;
    if (id == 0u) {
        receivers[index] = no_receiver();
        return;
    }
    let within = id - 1u - sub_scene.first_triangle;   // wraps to a large number before the first
    if (within >= sub_scene.triangle_count) {
        return;
    }
    let v0 = corners[3u * within].position;
    let v1 = corners[3u * within + 1u].position;
    let v2 = corners[3u * within + 2u].position;
    receivers[index] = receiver_on(camera_rays, way_of(camera_rays, pixel), v0, v1, v2, id - 1u);
}
