//! Small meshes and lights.

use softshadow_scene::{Light, LightShape};

use crate::scene::{Random, Soup};

/// A pose without rotation: a light there shines along −z.
pub(crate) fn above(shape: LightShape, [x, y, z]: [f64; 3]) -> Light {
    Light::new(shape, [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]).unwrap()
}

/// A light at `eye` that shines at `target`.
pub(crate) fn aimed(shape: LightShape, eye: [f64; 3], target: [f64; 3]) -> Light {
    Light::new(shape, softshadow_scene::look_at(eye, target, None).unwrap()).unwrap()
}

pub(crate) fn square(size: f64) -> LightShape {
    LightShape::Rectangle { width: size, height: size }
}

/// An L, concave and lopsided, so that a mirror would show.
pub(crate) fn bracket(size: f64) -> LightShape {
    let outline = [[-1.0, -1.0], [1.2, -1.0], [1.2, -0.3], [-0.2, -0.3], [-0.2, 0.9], [-1.0, 0.9]];
    LightShape::Polygon { outline: outline.map(|p| p.map(|x| x * size * 0.5)).to_vec() }
}

/// Every shape, about as large as a square of this size.
pub(crate) fn shapes(size: f64, distance: f64) -> [(&'static str, LightShape); 5] {
    [
        ("rectangle", LightShape::Rectangle { width: size, height: size * 0.8 }),
        ("disc", LightShape::Disc { radius: size * 0.5 }),
        ("polygon", bracket(size)),
        ("sphere", LightShape::Sphere { radius: size * 0.5 }),
        ("sun", LightShape::Sun { angular_diameter: 2.0 * (size * 0.5 / distance).atan() }),
    ]
}

pub(crate) type Indexed = (Vec<[f64; 3]>, Vec<[usize; 3]>);

pub(crate) fn soup((vertices, faces): &Indexed) -> Soup {
    faces.iter().map(|f| f.map(|i| vertices[i].map(|x| x as f32))).collect()
}

/// A ball of 20·4^levels triangles.
pub(crate) fn ball(center: [f64; 3], radius: f64, levels: u32) -> Indexed {
    let g = (1.0 + 5f64.sqrt()) * 0.5;
    let mut vertices: Vec<[f64; 3]> = vec![
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let mut faces: Vec<[usize; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    vertices.push(std::array::from_fn(|k| (vertices[i][k] + vertices[j][k]) * 0.5));
                    vertices.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
        for v in &mut vertices {
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            *v = v.map(|x| x / length);
        }
    }
    (vertices.iter().map(|v| std::array::from_fn(|k| center[k] + v[k] * radius)).collect(), faces)
}

/// A torus around the z axis.
pub(crate) fn torus(center: [f64; 3], major: f64, minor: f64, around: usize, across: usize) -> Indexed {
    let tau = std::f64::consts::TAU;
    let vertices = (0..around * across)
        .map(|i| {
            let (u, v) = ((i / across) as f64 / around as f64 * tau, (i % across) as f64 / across as f64 * tau);
            let reach = major + minor * v.cos();
            [center[0] + reach * u.cos(), center[1] + reach * u.sin(), center[2] + minor * v.sin()]
        })
        .collect();
    let at = |i: usize, j: usize| (i % around) * across + j % across;
    let cells = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let faces = cells
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect();
    (vertices, faces)
}

/// An axis-aligned box.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Indexed {
    let vertices = (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k] } else { low[k] })).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (vertices, quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect())
}

/// A square parallel to the light.
pub(crate) fn plate(center: [f64; 3], half: f64) -> Soup {
    let [x, y, z] = center;
    let corner = |i: f64, j: f64| [(x + i * half) as f32, (y + j * half) as f32, z as f32];
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    vec![[a, b, c], [a, c, d]]
}

/// Small triangles of all orientations in a box.
pub(crate) fn leaves(random: &mut Random, count: usize, size: f64, low: [f64; 3], high: [f64; 3]) -> Soup {
    (0..count)
        .map(|_| {
            let center = random.point(low, high);
            std::array::from_fn(|_| {
                let offset = random.direction() * random.within(0.0, size);
                std::array::from_fn(|k| center[k] + offset[k] as f32)
            })
        })
        .collect()
}
