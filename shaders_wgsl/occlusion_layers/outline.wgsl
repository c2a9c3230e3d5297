// The part of a triangle before the light, projected: its sides, each the same for both triangles that share it.
//#import occlusion_layers/layers.wgsl

// A side from one end to the other: a corner comes first, and of two the one that comes first in the triangle.
struct Side {
    a: vec3<f32>,
    b: vec3<f32>,
    exists: bool,
}

struct Outline {
    sides: array<Side, 4>,   // three of the triangle, and where the light's plane cuts it
    low: vec3<f32>,
    high: vec3<f32>,
    exists: bool,
}

// What of a side lies before the light, and where it ends there.
fn front_of(a: vec3<f32>, b: vec3<f32>, unbounded: bool) -> Side {
    let is_front = vec2<bool>(unbounded || a.z >= 0.0, unbounded || b.z >= 0.0);
    var side = Side(a, b, is_front.x || is_front.y);
    if (is_front.x != is_front.y) {
        let end = a + (b - a) * (a.z / (a.z - b.z));
        side.b = vec3<f32>(end.xy, 0.0);
        side.a = select(b, a, is_front.x);
    }
    return side;
}

fn outline_of(frame: LayerFrame, inverse_distance: f32, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>) -> Outline {
    let unbounded = frame.kind == LAYERS_SUN;
    let q0 = in_light_frame(frame, p0);
    let q1 = in_light_frame(frame, p1);
    let q2 = in_light_frame(frame, p2);
    var outline: Outline;
    outline.sides[0] = front_of(q0, q1, unbounded);
    outline.sides[1] = front_of(q0, q2, unbounded);
    outline.sides[2] = front_of(q1, q2, unbounded);
    let cut0 = (q0.z < 0.0) != (q1.z < 0.0);
    let cut1 = (q0.z < 0.0) != (q2.z < 0.0);
    let cut2 = (q1.z < 0.0) != (q2.z < 0.0);
    // Two sides are cut, or none.
    let first = select(1u, 0u, cut0);
    let second = select(1u, 2u, cut2);
    outline.sides[3] = Side(outline.sides[first].b, outline.sides[second].b, !unbounded && (cut0 || cut1 || cut2));
    outline.low = vec3<f32>(1e30);
    outline.high = vec3<f32>(-1e30);
    for (var k = 0u; k < 4u; k++) {
        var side = outline.sides[k];
        if (side.exists) {
            side.a = projected(side.a, inverse_distance);
            side.b = projected(side.b, inverse_distance);
            outline.sides[k] = side;
            outline.low = min(outline.low, min(side.a, side.b));
            outline.high = max(outline.high, max(side.a, side.b));
            outline.exists = true;
        }
    }
    return outline;
}
