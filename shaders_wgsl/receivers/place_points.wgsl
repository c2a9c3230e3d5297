// Receivers at given points. Points with a normal are lifted off their surface like those of a camera; others stay.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl

struct LocalPoint {
    position: vec3<f32>,
    has_normal: u32,
    normal: vec3<f32>,
    unused: u32,
}

struct PointRange {
    scene_extent: f32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> point_range: PointRange;
@group(0) @binding(2) var<storage, read> points: array<LocalPoint>;
@group(0) @binding(3) var<storage, read_write> receivers: array<Receiver>;

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let point = points[index];
    let lifted = receiver_lift(point.position, point.normal, point_range.scene_extent);
    let has_normal = point.has_normal != 0u;
    let kind = select(RECEIVER_POINT, RECEIVER_SURFACE, has_normal);
    receivers[index] = Receiver(select(point.position, lifted, has_normal), NO_TRIANGLE, point.normal, kind);
}
