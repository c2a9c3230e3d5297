// A corner of a triangle. Corners come sorted by position, so two triangles evaluate a shared edge with the same operands in
// the same order, and no ray slips between them even where the compiler fuses multiply and add.

struct Corner {
    position: vec3<f32>,
    triangle: u32,
}

fn triple(x: vec3<f32>, y: vec3<f32>, z: vec3<f32>) -> f32 {
    return dot(x, cross(y, z));
}

// Whether the segment from the origin along `d` crosses the triangle `a b c` strictly between its ends; with `unbounded`
// it has no far end. Edges belong to the triangle; decided by signs of determinants alone, nothing is divided.
fn triangle_blocks(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>, unbounded: bool) -> bool {
    let ab = triple(d, a, b);
    let bc = triple(d, b, c);
    let ac = triple(d, a, c);
    let inside = (ab >= 0.0 && bc >= 0.0 && ac <= 0.0) || (ab <= 0.0 && bc <= 0.0 && ac >= 0.0);
    let along = ab + bc - ac;   // d · (normal of the triangle)
    let offset = triple(a, b, c);
    let ahead = (offset > 0.0 && along > 0.0) || (offset < 0.0 && along < 0.0);
    return inside && ahead && (unbounded || abs(offset) < abs(along));
}
