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
// Everything is measured along the triangle's own edges: products of corners relative to `p` would lose all digits for a
// small triangle far away. Corners are sorted, so neighbours evaluate a shared edge with the same operands.
fn triangle_blocks(v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, p: vec3<f32>, d: vec3<f32>, unbounded: bool) -> bool {
    let a = v0 - p;
    let edge01 = v1 - v0;
    let edge02 = v2 - v0;
    let across = cross(d, a);
    let ab = dot(across, edge01);
    let ac = dot(across, edge02);
    let bc = dot(cross(d, v1 - p), v2 - v1);
    let inside = (ab >= 0.0 && bc >= 0.0 && ac <= 0.0) || (ab <= 0.0 && bc <= 0.0 && ac >= 0.0);
    let normal = cross(edge01, edge02);
    let offset = dot(normal, a);
    let along = dot(normal, d);
    let ahead = (offset > 0.0 && along > 0.0) || (offset < 0.0 && along < 0.0);
    return inside && ahead && (unbounded || abs(offset) < abs(along));
}
