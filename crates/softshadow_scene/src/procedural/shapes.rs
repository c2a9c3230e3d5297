//! The primitives of procedural scenes. All solids are closed, share their vertices and are wound outwards.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::leaves::{self, Leaves};

/// A shape with a transform: scaled, turned about x, then y, then z, then moved.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Placed {
    /// What is placed.
    pub shape: Shape,
    /// Where its origin goes.
    #[serde(default)]
    pub position: [f64; 3],
    /// Right-handed angles about the fixed axes.
    #[serde(default)]
    pub rotation_deg: [f64; 3],
    /// Factors along its own axes.
    #[serde(default = "ones")]
    pub scale: [f64; 3],
}

fn ones() -> [f64; 3] {
    [1.0; 3]
}

/// A primitive around the origin; round ones have Y as their axis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Shape {
    /// A cuboid.
    Box {
        /// Full lengths.
        size: [f64; 3],
    },
    /// A prism with caps, or a frustum where the top's radius differs.
    Cylinder {
        /// At the bottom, and at the top unless `top_radius` says otherwise.
        radius: f64,
        /// At the top.
        top_radius: Option<f64>,
        /// Along Y.
        height: f64,
        /// Sides of the polygon.
        segments: u32,
    },
    /// A ring.
    Torus {
        /// From the centre of the ring to the centre of the tube.
        major: f64,
        /// Of the tube.
        minor: f64,
        /// Around the ring, and around the tube.
        segments: [u32; 2],
    },
    /// An icosphere: corners on the sphere.
    Sphere {
        /// Of the sphere.
        radius: f64,
        /// How often the icosahedron's triangles are cut into four.
        subdivisions: u32,
    },
    /// A rectangle in XY that faces +Z.
    Quad {
        /// Along X and Y.
        size: [f64; 2],
    },
    /// A rectangle in XZ that faces +Y.
    Plane {
        /// Along X and Z.
        size: [f64; 2],
    },
    /// Small rectangles with random places and orientations.
    Leaves(Leaves),
    /// Copies in a centred lattice; a count of one is a group.
    Grid {
        /// Along X, Y and Z.
        count: [u32; 3],
        /// From one copy to the next.
        step: [f64; 3],
        /// What is copied.
        of: Vec<Placed>,
    },
}

/// Ten make 21 million triangles, more than a scene may have; the limit keeps the power of four in range.
const MAX_SUBDIVISIONS: u32 = 10;

/// How many triangles [`build`] will make, or what is wrong with a shape. Nothing is allocated.
pub(super) fn checked_triangle_count(placed: &[Placed]) -> Result<u64, String> {
    if placed.is_empty() {
        return Err("'of' must hold at least one shape".into());
    }
    placed.iter().try_fold(0, |sum: u64, placed| {
        if placed.scale.contains(&0.0) {
            return Err("a scale of 0 leaves nothing".into());
        }
        Ok(sum.saturating_add(placed.shape.checked_triangle_count()?))
    })
}

impl Shape {
    fn checked_triangle_count(&self) -> Result<u64, String> {
        match self {
            Self::Box { size } => positive("box size", size).map(|()| 12),
            Self::Cylinder { radius, top_radius, height, segments } => {
                positive("cylinder sizes", &[*radius, top_radius.unwrap_or(*radius), *height])?;
                at_least_three("cylinder segments", *segments).map(|n| 4 * n)
            }
            Self::Torus { major, minor, segments: [around, tube] } => {
                positive("torus sizes", &[*major, *minor])?;
                if minor >= major {
                    return Err("torus: minor must be smaller than major".into());
                }
                let around = at_least_three("torus segments", *around)?;
                Ok(around.saturating_mul(2 * at_least_three("torus segments", *tube)?))
            }
            Self::Sphere { radius, subdivisions } => {
                positive("sphere radius", &[*radius])?;
                if *subdivisions > MAX_SUBDIVISIONS {
                    return Err(format!("sphere: at most {MAX_SUBDIVISIONS} subdivisions"));
                }
                Ok(20 << (2 * subdivisions))
            }
            Self::Quad { size } => positive("quad size", size).map(|()| 2),
            Self::Plane { size } => positive("plane size", size).map(|()| 2),
            Self::Leaves(leaves) => leaves.checked_triangle_count(),
            Self::Grid { count, of, .. } => {
                if count.contains(&0) {
                    return Err("grid: counts must be at least 1".into());
                }
                let copies = count.iter().fold(1_u64, |product, &n| product.saturating_mul(u64::from(n)));
                // At least one triangle a copy, so a limit on triangles is a limit on copies.
                checked_triangle_count(of).map(|triangles| triangles.saturating_mul(copies))
            }
        }
    }
}

fn positive(what: &str, values: &[f64]) -> Result<(), String> {
    if values.iter().all(|&x| x > 0.0) { Ok(()) } else { Err(format!("{what} must be positive")) }
}

fn at_least_three(what: &str, count: u32) -> Result<u64, String> {
    if count >= 3 { Ok(u64::from(count)) } else { Err(format!("{what} must be at least 3")) }
}

/// The triangles of checked shapes in their order.
pub(super) fn build(placed: &[Placed]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut surface = Surface::default();
    for placed in placed {
        surface.add_placed(placed);
    }
    (surface.vertices, surface.triangles)
}

/// Vertices and triangles so far; primitives append to it.
#[derive(Default)]
pub(super) struct Surface {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    fn add_placed(&mut self, placed: &Placed) {
        let first = self.vertices.len();
        self.add_shape(&placed.shape);
        let rotation = placed.rotation_deg.map(|degrees| degrees.to_radians().sin_cos());
        for vertex in &mut self.vertices[first..] {
            let [[x, y, z], s, t] = [*vertex, placed.scale, placed.position];
            let [x, y, z] = rotated([x * s[0], y * s[1], z * s[2]], rotation);
            *vertex = [x + t[0], y + t[1], z + t[2]];
        }
    }

    fn add_shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Box { size } => self.add_box(size.map(|x| x / 2.0)),
            Shape::Cylinder { radius, top_radius, height, segments } => {
                self.add_cylinder([*radius, top_radius.unwrap_or(*radius)], height / 2.0, *segments);
            }
            Shape::Torus { major, minor, segments } => self.add_torus(*major, *minor, *segments),
            Shape::Sphere { radius, subdivisions } => self.add_sphere(*radius, *subdivisions),
            Shape::Quad { size: [x, y] } => {
                let [x, y] = [x / 2.0, y / 2.0];
                self.add_quad([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]]);
            }
            Shape::Plane { size: [x, z] } => {
                let [x, z] = [x / 2.0, z / 2.0];
                self.add_quad([[-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z], [-x, 0.0, -z]]);
            }
            Shape::Leaves(leaves) => leaves::add(self, leaves),
            Shape::Grid { count, step, of } => self.add_grid(*count, *step, of),
        }
    }

    /// Four corners around a rectangle.
    pub(super) fn add_quad(&mut self, corners: [[f64; 3]; 4]) {
        self.add(&corners, &[[0, 1, 2], [0, 2, 3]]);
    }

    /// Triangles with indices into the vertices beside them.
    fn add(&mut self, vertices: &[[f64; 3]], triangles: &[[u32; 3]]) {
        // Checked scenes stay far below 2^32 vertices: none has more than three a triangle.
        let first = self.vertices.len() as u32;
        self.vertices.extend_from_slice(vertices);
        self.triangles.extend(triangles.iter().map(|t| t.map(|corner| corner + first)));
    }

    fn add_box(&mut self, half: [f64; 3]) {
        let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { half[axis] } else { -half[axis] });
        let corners: [_; 8] = std::array::from_fn(corner);
        let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        self.add(&corners, sides.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).as_flattened());
    }

    fn add_cylinder(&mut self, [bottom, top]: [f64; 2], half_height: f64, segments: u32) {
        let mut vertices = vec![[0.0, -half_height, 0.0], [0.0, half_height, 0.0]];
        let mut triangles = Vec::new();
        for i in 0..segments {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(segments)).sin_cos();
            vertices.push([bottom * cos, -half_height, bottom * sin]);
            vertices.push([top * cos, half_height, top * sin]);
            let [a, b] = [2 + 2 * i, 2 + 2 * ((i + 1) % segments)];
            triangles.extend([[0, a, b], [1, b + 1, a + 1], [a, a + 1, b + 1], [a, b + 1, b]]);
        }
        self.add(&vertices, &triangles);
    }

    fn add_torus(&mut self, major: f64, minor: f64, [around, tube]: [u32; 2]) {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..around {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
            for j in 0..tube {
                let (height, outwards) = (TAU * f64::from(j) / f64::from(tube)).sin_cos();
                let distance = major + minor * outwards;
                vertices.push([distance * cos, minor * height, distance * sin]);
                let [next_i, next_j] = [(i + 1) % around, (j + 1) % tube];
                let [a, b, c, d] = [i * tube + j, i * tube + next_j, next_i * tube + next_j, next_i * tube + j];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        self.add(&vertices, &triangles);
    }

    fn add_sphere(&mut self, radius: f64, subdivisions: u32) {
        let (mut vertices, mut triangles) = icosahedron();
        for _ in 0..subdivisions {
            (vertices, triangles) = subdivided(vertices, &triangles);
        }
        for vertex in &mut vertices {
            *vertex = vertex.map(|x| x * radius);
        }
        self.add(&vertices, &triangles);
    }

    fn add_grid(&mut self, count: [u32; 3], step: [f64; 3], of: &[Placed]) {
        let (vertices, triangles) = build(of);
        let offset = |axis: usize, i: u32| step[axis] * (f64::from(i) - f64::from(count[axis] - 1) / 2.0);
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let [x, y, z] = [offset(0, i), offset(1, j), offset(2, k)];
                    let moved: Vec<_> = vertices.iter().map(|v| [v[0] + x, v[1] + y, v[2] + z]).collect();
                    self.add(&moved, &triangles);
                }
            }
        }
    }
}

/// Turned about x, then y, then z; the angles as sine and cosine.
fn rotated([x, y, z]: [f64; 3], [(sx, cx), (sy, cy), (sz, cz)]: [(f64, f64); 3]) -> [f64; 3] {
    let [y, z] = [cx * y - sx * z, sx * y + cx * z];
    let [z, x] = [cy * z - sy * x, sy * z + cy * x];
    [cz * x - sz * y, sz * x + cz * y, z]
}

fn icosahedron() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices = Vec::new();
    // Three golden rectangles, one a coordinate plane.
    for axis in 0..3 {
        for (one, long) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
            let mut vertex = [0.0, one, long];
            vertex.rotate_right(axis);
            vertices.push(normalized(vertex));
        }
    }
    // Five around each corner: every triple of corners at the shortest distance, wound outwards.
    let is_near = |a: [f64; 3], b: [f64; 3]| dot(a, b) > 0.4;
    let mut triangles = Vec::new();
    for (a, &p) in (0_u32..).zip(&vertices) {
        for (b, &q) in (0_u32..).zip(&vertices).skip(a as usize + 1) {
            for (c, &r) in (0_u32..).zip(&vertices).skip(b as usize + 1) {
                if is_near(p, q) && is_near(q, r) && is_near(r, p) {
                    triangles.push(if dot(p, cross(q, r)) > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (vertices, triangles)
}

/// Each triangle cut into four, the new corners shared and on the unit sphere.
fn subdivided(mut vertices: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut midpoints = std::collections::BTreeMap::new();
    let mut midpoint = |a: u32, b: u32| {
        *midpoints.entry([a.min(b), a.max(b)]).or_insert_with_key(|&[low, high]| {
            let [p, q] = [vertices[low as usize], vertices[high as usize]];
            vertices.push(normalized([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
            vertices.len() as u32 - 1
        })
    };
    let cut = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [midpoint(a, b), midpoint(b, c), midpoint(c, a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let triangles = triangles.iter().flat_map(cut).collect();
    (vertices, triangles)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalized(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}
