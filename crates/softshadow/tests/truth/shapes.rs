//! Geometry for tests, as lists of triangles: corners that coincide have equal bits.

use std::f64::consts::TAU;

use softshadow::{Material, Mesh, Scene};

pub(crate) type Point = [f64; 3];
pub(crate) type Triangle = [Point; 3];

/// One mesh without shared vertices.
pub(crate) fn scene(triangles: &[Triangle]) -> Scene {
    let vertices: Vec<Point> = triangles.as_flattened().to_vec();
    let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Scene::new(vec![Mesh::new("soup", vertices, indices, Material::default()).unwrap()]).unwrap()
}

/// Every triangle of a scene with its corners, in the order of the caller's ids.
pub(crate) fn triangles_of(scene: &Scene) -> Vec<Triangle> {
    let corners = |m: &Mesh| m.triangles.iter().map(|t| t.map(|v| m.vertices[v as usize])).collect::<Vec<_>>();
    scene.meshes().iter().flat_map(corners).collect()
}

pub(crate) fn quad(a: Point, b: Point, c: Point, d: Point) -> Vec<Triangle> {
    vec![[a, b, c], [a, c, d]]
}

/// An axis-aligned rectangle at height `z`.
pub(crate) fn plate(x: [f64; 2], y: [f64; 2], z: f64) -> Vec<Triangle> {
    quad([x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z])
}

pub(crate) fn cuboid(low: Point, high: Point) -> Vec<Triangle> {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
    let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    sides.iter().flat_map(|s| quad(corner(s[0]), corner(s[1]), corner(s[2]), corner(s[3]))).collect()
}

/// A regular polygon of `sides` corners on a horizontal circle.
pub(crate) fn disc(center: Point, radius: f64, sides: u32) -> Vec<Triangle> {
    let rim = |i: u32| {
        let (sine, cosine) = (TAU * f64::from(i % sides) / f64::from(sides)).sin_cos();
        [center[0] + radius * cosine, center[1] + radius * sine, center[2]]
    };
    (0..sides).map(|i| [center, rim(i), rim(i + 1)]).collect()
}

/// Triangles with their corners on a sphere: an octahedron whose triangles are quartered `levels` times.
pub(crate) fn sphere(center: Point, radius: f64, levels: u32) -> Vec<Triangle> {
    let unit = |p: Point| p.map(|x| x / length(p));
    let mut faces: Vec<Triangle> = (0..8)
        .map(|i| [0, 1, 2].map(|k| [0, 1, 2].map(|a| if a == k { f64::from(1 - 2 * (i >> k & 1)) } else { 0.0 })))
        .collect();
    for _ in 0..levels {
        // Addition commutes, so both triangles at an edge find the same middle.
        let middle = |a: Point, b: Point| unit([0, 1, 2].map(|k| a[k] + b[k]));
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    faces.iter().map(|t| t.map(|p| [0, 1, 2].map(|k| center[k] + radius * p[k]))).collect()
}

/// Radius of the largest ball around `center` that the planes of all triangles leave free: for corners on a sphere it lies
/// inside the polyhedron, as the polyhedron lies inside the sphere.
pub(crate) fn inner_radius(triangles: &[Triangle], center: Point) -> f64 {
    let distance = |t: &Triangle| {
        let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
        (dot(normal, sub(t[0], center)) / length(normal)).abs()
    };
    triangles.iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// A ring around the z axis.
pub(crate) fn torus(major: f64, minor: f64, around: u32, tube: u32) -> Vec<Triangle> {
    let at = |i: u32, j: u32| {
        let (sine, cosine) = (TAU * f64::from(i % around) / f64::from(around)).sin_cos();
        let (up, out) = (TAU * f64::from(j % tube) / f64::from(tube)).sin_cos();
        let radius = major + minor * out;
        [radius * cosine, radius * sine, minor * up]
    };
    let cells = (0..around).flat_map(|i| (0..tube).map(move |j| (i, j)));
    cells.flat_map(|(i, j)| quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))).collect()
}

pub(crate) fn map(triangles: &[Triangle], place: impl Fn(Point) -> Point) -> Vec<Triangle> {
    triangles.iter().map(|t| t.map(&place)).collect()
}

/// Turned about x and then about z.
pub(crate) fn turned(p: Point, about_x: f64, about_z: f64) -> Point {
    let (sx, cx) = about_x.sin_cos();
    let (sz, cz) = about_z.sin_cos();
    let (x, y, z) = (p[0], p[1] * cx - p[2] * sx, p[1] * sx + p[2] * cx);
    [x * cz - y * sz, x * sz + y * cz, z]
}

pub(crate) fn add(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] + b[k])
}

pub(crate) fn sub(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

#[test]
fn solids_are_closed_and_the_ball_fits() {
    for solid in [sphere([1.0, 2.0, 3.0], 0.5, 3), torus(1.0, 0.3, 12, 7), cuboid([0.0; 3], [1.0, 2.0, 3.0])] {
        let bits = |p: Point| p.map(f64::to_bits);
        let mut edges = std::collections::BTreeMap::new();
        for t in &solid {
            for k in 0..3 {
                let mut edge = [bits(t[k]), bits(t[(k + 1) % 3])];
                edge.sort_unstable();
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&count| count == 2));
    }
    let inner = inner_radius(&sphere([1.0, 2.0, 3.0], 0.5, 3), [1.0, 2.0, 3.0]);
    assert!(inner < 0.5 && inner > 0.48, "{inner}");
}
