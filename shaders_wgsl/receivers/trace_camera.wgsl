// Receivers of a camera, where the host draws no triangles: one ray a pixel, sub-scene after sub-scene. What is nearest so far stands in
// `distances`, and its receiver in its place.
//#import shared/slice.wgsl
//#import receivers/place.wgsl
//#import shared/hierarchy.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> camera_rays: CameraRays;
@group(0) @binding(2) var<uniform> sub_scene: SubScene;
@group(0) @binding(3) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(4) var<storage, read> corners: array<Corner>;
@group(0) @binding(5) var<storage, read_write> distances: array<f32>;
@group(0) @binding(6) var<storage, read_write> receivers: array<Receiver>;

// Nothing nearer to the eye than this is seen.
const NEAR: f32 = 1.0 / 1048576.0;
const FAR: f32 = 1e30;

// How far along `d` the ray from the eye meets a triangle, or FAR.
fn distance_to(d: vec3<f32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> f32 {
    let a = v0 - camera_rays.eye;
    let edge01 = v1 - v0;
    let edge02 = v2 - v0;
    let across = cross(d, a);
    let ab = dot(across, edge01);
    let ac = dot(across, edge02);
    let bc = dot(cross(d, v1 - camera_rays.eye), v2 - v1);
    let inside = (ab >= 0.0 && bc >= 0.0 && ac <= 0.0) || (ab <= 0.0 && bc <= 0.0 && ac >= 0.0);
    let normal = cross(edge01, edge02);
    let along = dot(normal, d);
    let distance = dot(normal, a) / select(1.0, along, along != 0.0);
    return select(FAR, distance, inside && along != 0.0 && distance >= NEAR);
}

@compute @workgroup_size(64)
fn trace_camera(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    var nearest = FAR;
    if (sub_scene.first_triangle == 0u) {
        receivers[index] = no_receiver();
    } else {
        nearest = distances[index];
    }
    let d = way_of(camera_rays, pixel_of(camera_rays, index));
    let inverse = safe_reciprocal(d);
    let pad = vec3<f32>(box_pad(camera_rays.eye));
    let to_low = (-camera_rays.eye - pad) * inverse;
    let to_high = (-camera_rays.eye + pad) * inverse;
    let rising = inverse >= vec3<f32>(0.0);
    let end = arrayLength(&nodes);
    var node = 0u;
    var found = NO_TRIANGLE;
    while (node < end) {
        let box = nodes[node];
        let near = select(box.high * inverse + to_high, box.low * inverse + to_low, rising);
        let far = select(box.low * inverse + to_low, box.high * inverse + to_high, rising);
        let enter = max(max(near.x, near.y), max(near.z, 0.0));
        let leave = min(min(far.x, far.y), min(far.z, nearest));
        let met = enter <= leave;
        node = select(box.skip, node + 1u, met && box.leaf == 0u);
        let first = box.leaf >> LEAF_BITS;
        let count = select(0u, box.leaf & ((1u << LEAF_BITS) - 1u), met);
        for (var k = first; k < first + count; k++) {
            let at = distance_to(d, corners[3u * k].position, corners[3u * k + 1u].position, corners[3u * k + 2u].position);
            // Of two at one distance the first counts, in whatever order they are met.
            let nearer = at < nearest || (at == nearest && at < FAR && k < found);
            found = select(found, k, nearer);
            nearest = min(nearest, at);
        }
    }
    distances[index] = nearest;
    if (found != NO_TRIANGLE) {
        let v0 = corners[3u * found].position;
        let v1 = corners[3u * found + 1u].position;
        let v2 = corners[3u * found + 2u].position;
        receivers[index] = receiver_on(camera_rays, d, v0, v1, v2, sub_scene.first_triangle + found);
    }
}
