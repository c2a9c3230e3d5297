//! Lights and meshes that several tests use.

use softshadow_measure::{AxisRectangle, RectangleLight, Triangle};

/// The square light of side 1 at height 3 over the origin, looking down.
pub(crate) const LIGHT: AxisRectangle = AxisRectangle { x: [-0.5, 0.5], y: [-0.5, 0.5], z: 3.0 };

/// The same rectangle as the exact union wants it.
pub(crate) fn as_light(rectangle: &AxisRectangle) -> RectangleLight {
    let middle = |range: [f64; 2]| (range[0] + range[1]) / 2.0;
    let half = |range: [f64; 2]| (range[1] - range[0]) / 2.0;
    RectangleLight::new(
        [middle(rectangle.x), middle(rectangle.y), rectangle.z],
        [half(rectangle.x), 0.0, 0.0],
        [0.0, half(rectangle.y), 0.0],
        [0.0, 0.0, -1.0],
    )
    .unwrap()
}

pub(crate) fn rectangle(shape: &AxisRectangle) -> [Triangle; 2] {
    let corner = |x: usize, y: usize| [shape.x[x], shape.y[y], shape.z];
    [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]]
}

/// An octahedron, each face split into 4^levels and blown up on to the sphere: 8·4^levels triangles.
pub(crate) fn sphere(center: [f64; 3], radius: f64, levels: u32) -> Vec<Triangle> {
    let mut faces: Vec<Triangle> = Vec::new();
    for signs in 0..8 {
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        faces.push([[sign(0), 0.0, 0.0], [0.0, sign(1), 0.0], [0.0, 0.0, sign(2)]]);
    }
    for _ in 0..levels {
        faces = faces.iter().flat_map(split).collect();
    }
    faces.iter().map(|face| face.map(|corner| std::array::from_fn(|k| center[k] + radius * corner[k]))).collect()
}

fn split(face: &Triangle) -> [Triangle; 4] {
    let middle = |i: usize, j: usize| {
        let sum: [f64; 3] = std::array::from_fn(|axis| face[i][axis] + face[j][axis]);
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
        sum.map(|x| x / length)
    };
    let (ab, bc, ca) = (middle(0, 1), middle(1, 2), middle(2, 0));
    [[face[0], ab, ca], [ab, face[1], bc], [ca, bc, face[2]], [ab, bc, ca]]
}

/// Float32 rounding of every coordinate, as a caller that owns float32 data would pass it.
pub(crate) fn as_float32(triangles: &[Triangle]) -> Vec<Triangle> {
    let round = |point: [f64; 3]| point.map(|value| f64::from(value as f32));
    triangles.iter().map(|face| face.map(round)).collect()
}
