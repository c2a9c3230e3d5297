// A corner of a triangle. Corners come sorted by position, so two triangles evaluate a shared edge with the same operands in
// the same order, and no ray slips between them even where the compiler fuses multiply and add.

struct Corner {
    position: vec3<f32>,
    triangle: u32,
}

fn triple(x: vec3<f32>, y: vec3<f32>, z: vec3<f32>) -> f32 {
    return dot(x, cross(y, z));
}

// Whether the segment from `p` along `d` crosses the triangle strictly between its ends; with `unbounded` it has no far end.
// Edges belong to the triangle. Decided by signs of determinants alone; nothing is divided.
//
// The three edges are taken relative to `p`, so that neighbours agree about the edge they share. Plane and far end are taken
// from the triangle's own edges: relative to `p` they would lose all digits for a small triangle far away.
fn triangle_blocks(v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, p: vec3<f32>, d: vec3<f32>, unbounded: bool) -> bool {
    let a = v0 - p;
    let b = v1 - p;
    let c = v2 - p;
    let ab = triple(d, a, b);
    let bc = triple(d, b, c);
    let ac = triple(d, a, c);
    let inside = (ab >= 0.0 && bc >= 0.0 && ac <= 0.0) || (ab <= 0.0 && bc <= 0.0 && ac >= 0.0);
    let normal = cross(v1 - v0, v2 - v0);
    let offset = dot(normal, a);
    let along = dot(normal, d);
    let ahead = (offset > 0.0 && along > 0.0) || (offset < 0.0 && along < 0.0);
    return inside && ahead && (unbounded || abs(offset) < abs(along));
}
