//! Random numbers and the meshes made of them, for tests inside the crate.

use crate::Triangle;
use crate::vector::{Vec3, add, length, scale, sub};

/// A few generators are enough to place triangles at random; no dependency for that.
pub(crate) fn uniforms(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (state ^ (state >> 29)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (mixed >> 11) as f64 / (1_u64 << 53) as f64
    }
}

pub(crate) fn float32_vector(next: &mut impl FnMut() -> f64, size: f64) -> Vec3 {
    std::array::from_fn(|_| f64::from(((next() - 0.5) * size) as f32))
}

/// Small and large, near and far, slivers, edge-on and touching triangles around the origin.
pub(crate) fn hostile_mesh(next: &mut impl FnMut() -> f64, count: usize) -> Vec<Triangle> {
    (0..count)
        .map(|index| {
            let size = 10_f64.powf(next() * 5.0 - 4.0);
            let center = float32_vector(next, 6.0);
            let mut corners: Triangle = std::array::from_fn(|_| vertex(add_offset(center, next, size)));
            match index % 7 {
                0 => corners[2] = corners[1],
                1 => corners.iter_mut().for_each(|corner| corner[2] = 0.0),
                2 => corners[0] = [0.0; 3],
                _ => {}
            }
            corners
        })
        .collect()
}

pub(crate) fn add_offset(center: Vec3, next: &mut impl FnMut() -> f64, size: f64) -> Vec3 {
    add(center, float32_vector(next, size))
}

/// Twice as far as the middle of an edge.
pub(crate) fn beyond_an_edge([from, to, _]: &Triangle, origin: Vec3) -> Vec3 {
    sub(add(*from, *to), origin)
}

pub(crate) fn vertex(at: Vec3) -> Vec3 {
    at.map(|value| f64::from(value as f32))
}

/// A closed mesh: an octahedron, each face cut into four `levels` times, pushed out to a sphere.
pub(crate) fn sphere_mesh(center: Vec3, radius: f64, levels: usize) -> Vec<Triangle> {
    let mut faces: Vec<Triangle> = (0..8)
        .map(|octant| {
            let side = |bit: usize| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
            [[side(0), 0.0, 0.0], [0.0, side(1), 0.0], [0.0, 0.0, side(2)]]
        })
        .collect();
    for _ in 0..levels {
        faces = faces.iter().flat_map(quarters).collect();
    }
    let place = |corner: Vec3| vertex(add(center, scale(corner, radius / length(corner))));
    faces.into_iter().map(|face| face.map(place)).collect()
}

fn quarters([a, b, c]: &Triangle) -> [Triangle; 4] {
    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(x, y)| scale(add(*x, *y), 0.5));
    [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
}
