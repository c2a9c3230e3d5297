//! A scene as the kernels read it: local float32 triangles in a canonical order, cut into sub-scenes with a hierarchy each.
//!
//! Canonical means: the corners of a triangle are sorted by position, and so are the triangles. Two triangles that share an edge
//! then evaluate it with the same operands in the same order, so that no ray slips between them whatever the compiler fuses;
//! and the order in which a caller gives his triangles changes no bit of a result.

use glam::DVec3;

use crate::bvh::{Bvh, BvhNode};
use crate::frame::LocalFrame;
use crate::mesh::Material;
use crate::scene::Scene;

/// A corner of a triangle as the kernels read it.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Corner {
    /// Local float32 position.
    pub position: [f32; 3],
    /// Index of the triangle in [`LocalScene::triangles`], the same in all three corners.
    pub triangle: u32,
}

/// A run of triangles with its own hierarchy, small enough for one storage binding.
#[derive(Debug, Clone, PartialEq)]
pub struct SubScene {
    /// Index of its first triangle in [`LocalScene::triangles`].
    pub first_triangle: u32,
    /// Corners, three a triangle.
    pub corners: Vec<Corner>,
    /// Hierarchy; leaves count triangles from the sub-scene's first.
    pub nodes: Vec<BvhNode>,
    /// The hierarchy's expected work when it was built; a refit is judged by it.
    pub built_cost: f64,
}

/// What was left out of the local scene, and why it casts no shadow.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Triangles without area: repeated or collinear corners.
    pub zero_area: usize,
    /// Triangles whose corners coincide once rounded to local float32.
    pub below_resolution: usize,
    /// Triangles of opacity 0: nobody sees them, and they hide nothing.
    pub invisible: usize,
}

/// A scene in its local frame.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalScene {
    /// How world coordinates became local ones.
    pub frame: LocalFrame,
    /// Largest absolute local coordinate of any vertex.
    pub extent: f32,
    /// The triangles, cut to the size of a binding. Empty without triangles.
    pub sub_scenes: Vec<SubScene>,
    /// For each local triangle the caller's triangle id.
    pub caller_ids: Vec<u32>,
    /// For each local triangle the index of its mesh.
    pub mesh_ids: Vec<u32>,
    /// For each local triangle the caller's vertices, counted through the meshes, in the order of its corners.
    pub vertex_ids: Vec<[u32; 3]>,
    /// One material a mesh.
    pub materials: Vec<Material>,
    /// For each local triangle its opacity; empty where all are opaque.
    pub opacities: Vec<f32>,
    /// Triangles that were left out.
    pub dropped: Dropped,
}

impl LocalScene {
    /// Moves a scene to its local frame, rounds it, and builds the hierarchies.
    ///
    /// `frame_points` are further points that the frame should cover where the scene has no vertex at all.
    /// `max_binding_bytes` is the largest storage binding of the host.
    ///
    /// Every local coordinate lies in `[-1, 1]`, so none overflows.
    #[must_use]
    pub fn new(scene: &Scene, frame_points: Option<([f64; 3], [f64; 3])>, max_binding_bytes: u64) -> Self {
        let frame = LocalFrame::around(occluder_bounds(scene).or(frame_points));
        let (mut rows, dropped) = placed(scene, &frame);
        // Triangles in one place stand in the order of their opacities: what passes them is multiplied in this order.
        rows.sort_by(|a, b| triangle_order(&a.corners, &b.corners).then(a.opacity.total_cmp(&b.opacity)));
        let mut built = Self {
            frame,
            extent: extent(&rows),
            sub_scenes: Vec::new(),
            caller_ids: Vec::with_capacity(rows.len()),
            mesh_ids: Vec::with_capacity(rows.len()),
            vertex_ids: Vec::with_capacity(rows.len()),
            materials: scene.meshes().iter().map(|m| m.material).collect(),
            opacities: Vec::new(),
            dropped,
        };
        for chunk in rows.chunks(triangles_per_binding(max_binding_bytes)) {
            built.append(chunk);
        }
        if built.opacities.iter().all(|opacity| *opacity >= 1.0) {
            built.opacities = Vec::new();
        }
        built
    }

    /// How many triangles there are.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.caller_ids.len()
    }

    /// Opacity of a triangle.
    #[must_use]
    pub fn opacity(&self, triangle: usize) -> f32 {
        self.opacities.get(triangle).copied().unwrap_or(1.0)
    }

    /// All triangles in order, as three positions each.
    pub fn triangles(&self) -> impl Iterator<Item = [[f32; 3]; 3]> + '_ {
        self.sub_scenes.iter().flat_map(|s| s.corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|c| c.position)))
    }

    fn append(&mut self, rows: &[Row]) {
        let positions: Vec<[[f32; 3]; 3]> = rows.iter().map(|r| r.corners).collect();
        let bvh = Bvh::build(&positions);
        let first_triangle = self.caller_ids.len() as u32;
        let mut corners = Vec::with_capacity(rows.len() * 3);
        for (&old, triangle) in bvh.order.iter().zip(first_triangle..) {
            let row = &rows[old as usize];
            corners.extend(row.corners.map(|position| Corner { position, triangle }));
            self.caller_ids.push(row.caller_id);
            self.mesh_ids.push(row.mesh_id);
            self.vertex_ids.push(row.vertex_ids);
            self.opacities.push(row.opacity);
        }
        self.sub_scenes.push(SubScene { first_triangle, corners, nodes: bvh.nodes, built_cost: bvh.built_cost });
    }
}

/// A triangle that casts a shadow, in the local frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// Sorted by position.
    pub(crate) corners: [[f32; 3]; 3],
    /// The caller's vertices at the corners, counted through the meshes.
    pub(crate) vertex_ids: [u32; 3],
    pub(crate) caller_id: u32,
    pub(crate) mesh_id: u32,
    pub(crate) opacity: f32,
}

/// The triangles of a scene in a frame, in the caller's order, and what is left out of them.
pub(crate) fn placed(scene: &Scene, frame: &LocalFrame) -> (Vec<Row>, Dropped) {
    let mut dropped = Dropped::default();
    let mut rows = Vec::with_capacity(scene.triangle_count());
    let (mut caller_id, mut first_vertex) = (0u32, 0u32);
    for (mesh_id, mesh) in scene.meshes().iter().enumerate() {
        // Adding +0 turns −0 into +0: equal positions must be equal bits.
        let rounded = |v: &[f64; 3]| (frame.local_from_world(*v).as_vec3() + glam::Vec3::ZERO).to_array();
        let local: Vec<[f32; 3]> = mesh.vertices.iter().map(rounded).collect();
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let id = caller_id;
            caller_id += 1;
            if is_flat(triangle.map(|v| DVec3::from(mesh.vertices[v as usize]))) {
                dropped.zero_area += 1;
                continue;
            }
            let mut pairs = triangle.map(|v| (local[v as usize], first_vertex + v));
            pairs.sort_by(|a, b| position_order(&a.0, &b.0));
            let (corners, vertex_ids) = (pairs.map(|p| p.0), pairs.map(|p| p.1));
            if corners[0] == corners[1] || corners[1] == corners[2] {
                dropped.below_resolution += 1;
                continue;
            }
            let opacity = mesh.opacity(index);
            if opacity <= 0.0 {
                dropped.invisible += 1;
                continue;
            }
            rows.push(Row { corners, vertex_ids, caller_id: id, mesh_id: mesh_id as u32, opacity });
        }
        first_vertex += mesh.vertices.len() as u32;
    }
    (rows, dropped)
}

/// The largest absolute coordinate.
pub(crate) fn extent(rows: &[Row]) -> f32 {
    rows.iter().flat_map(|r| r.corners.as_flattened()).fold(0f32, |m, x| m.max(x.abs()))
}

/// A hierarchy has at most two nodes a triangle, of 32 bytes, beside the 48 bytes of its corners: nodes fill a binding first.
fn triangles_per_binding(max_binding_bytes: u64) -> usize {
    (max_binding_bytes / (2 * size_of::<BvhNode>() as u64)).clamp(1, 1 << 27) as usize
}

/// Without area: repeated or collinear corners. Edges are scaled first, so that tiny triangles do not underflow, and a height below
/// a few roundings of the longest edge is none.
fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let (e, f) = (b - a, c - a);
    let scale = e.abs().max(f.abs()).max_element();
    scale == 0.0 || (e / scale).cross(f / scale).length() <= 1e-15
}

/// The smallest box around everything that can cast a shadow: vertices of triangles with an area. A vertex that no triangle uses
/// must not decide about the scene's frame.
#[must_use]
pub fn occluder_bounds(scene: &Scene) -> Option<([f64; 3], [f64; 3])> {
    let mut bounds: Option<(DVec3, DVec3)> = None;
    for mesh in scene.meshes() {
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]));
            if !is_flat(corners) {
                for corner in corners {
                    bounds = Some(bounds.map_or((corner, corner), |(low, high)| (low.min(corner), high.max(corner))));
                }
            }
        }
    }
    bounds.map(|(low, high)| (low.to_array(), high.to_array()))
}

fn position_order(a: &[f32; 3], b: &[f32; 3]) -> std::cmp::Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
}

fn triangle_order(a: &[[f32; 3]; 3], b: &[[f32; 3]; 3]) -> std::cmp::Ordering {
    position_order(&a[0], &b[0]).then_with(|| position_order(&a[1], &b[1])).then_with(|| position_order(&a[2], &b[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    const ROOMY: u64 = 128 << 20;

    fn grid(n: u32, scale: f64, offset: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let point = |i: u32, j: u32| {
            let (x, z) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            [x, 0.3 * (x * 7.0).sin() * z, z].map(|c| c * scale)
        };
        let vertices = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| point(i, j));
        let vertices = vertices.map(|p| [0, 1, 2].map(|k| p[k] + offset[k])).collect();
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let triangles = cells
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect();
        (vertices, triangles)
    }

    fn local(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> LocalScene {
        let mesh = Mesh::new("grid", vertices, triangles, Material::default()).unwrap();
        LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, ROOMY)
    }

    #[test]
    fn permuted_and_rewound_triangles_give_the_same_bits() {
        let (vertices, triangles) = grid(9, 1.0, [0.0; 3]);
        let base = local(vertices.clone(), triangles.clone());
        let mut shuffled: Vec<[u32; 3]> = triangles.iter().map(|t| [t[2], t[0], t[1]]).collect();
        shuffled.reverse();
        shuffled.swap(3, 77);
        assert_eq!(base.sub_scenes, local(vertices.clone(), shuffled).sub_scenes);
        let mut moved = vertices;
        moved[5][1] += 1e-3;
        assert_ne!(base.sub_scenes, local(moved, triangles).sub_scenes);
    }

    #[test]
    fn powers_of_two_and_dyadic_offsets_change_no_bit() {
        let (vertices, triangles) = grid(9, 1.0, [0.0; 3]);
        let base = local(vertices, triangles.clone());
        for scale in [2f64.powi(20), 2f64.powi(-20)] {
            assert_eq!(base.sub_scenes, local(grid(9, scale, [0.0; 3]).0, triangles.clone()).sub_scenes);
        }
        let dyadic: Vec<[f64; 3]> =
            grid(8, 1.0, [0.0; 3]).0.iter().map(|v| v.map(|x| (x * 4096.0).round() / 4096.0)).collect();
        let moved = dyadic.iter().map(|v| [v[0] + 524_288.0, v[1] + 4_194_304.0, v[2]]).collect();
        let triangles = grid(8, 1.0, [0.0; 3]).1;
        assert_eq!(local(dyadic, triangles.clone()).sub_scenes, local(moved, triangles).sub_scenes);
    }

    #[test]
    fn degenerate_triangles_are_dropped_and_counted_and_ids_stay_the_callers() {
        let (vertices, mut triangles) = grid(2, 1.0, [0.0; 3]);
        triangles.insert(0, [1, 1, 2]);
        triangles.insert(3, [0, 3, 3]);
        let scene = local(vertices, triangles);
        assert_eq!(scene.dropped, Dropped { zero_area: 2, ..Dropped::default() });
        let mut ids = scene.caller_ids.clone();
        ids.sort_unstable();
        assert_eq!(ids, [1, 2, 4, 5, 6, 7, 8, 9]);

        let tiny = vec![[0.0; 3], [1e-12, 0.0, 0.0], [0.0, 1e-12, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let scene = local(tiny, vec![[0, 1, 2], [0, 3, 4]]);
        assert_eq!(scene.dropped, Dropped { below_resolution: 1, ..Dropped::default() });
    }

    #[test]
    fn opacities_go_with_their_triangles_and_the_invisible_are_left_out() {
        let (vertices, triangles) = grid(9, 1.0, [0.0; 3]);
        let mesh = Mesh::new("grid", vertices, triangles, Material::default()).unwrap();
        let of = |opacity: &dyn Fn(usize) -> f32| {
            let opacities = (0..162).map(opacity).collect();
            let mesh = mesh.clone().with_opacities(opacities).unwrap();
            LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, 64 * 30)
        };
        // Opaque scenes carry none.
        let opaque = of(&|_| 1.0);
        assert!(opaque.opacities.is_empty() && opaque.opacity(3) == 1.0);
        let graded = of(&|index| index as f32 / 200.0);
        assert_eq!((graded.dropped.invisible, graded.triangle_count()), (1, 161));
        for (triangle, id) in graded.caller_ids.iter().enumerate() {
            assert_eq!(graded.opacity(triangle), *id as f32 / 200.0);
        }
        // In whichever order triangles in one place are given.
        let doubled = |opacities: Vec<f32>| {
            let (vertices, triangle) = (grid(1, 1.0, [0.0; 3]).0, [[0, 1, 2]]);
            let mesh = Mesh::new("pane", vertices, triangle.repeat(opacities.len()), Material::default()).unwrap();
            let scene = Scene::new(vec![mesh.with_opacities(opacities).unwrap()]).unwrap();
            LocalScene::new(&scene, None, ROOMY).opacities
        };
        assert_eq!(doubled(vec![0.3, 0.9, 0.1, 1.0, 0.7]), doubled(vec![1.0, 0.1, 0.7, 0.3, 0.9]));
        let holes = of(&|index| if index % 3 == 0 { 0.0 } else { 1.0 });
        assert!(holes.opacities.is_empty() && holes.triangle_count() == 108);
    }

    #[test]
    fn vertices_that_nothing_uses_do_not_move_the_frame() {
        let (mut vertices, triangles) = grid(9, 1.0, [0.0; 3]);
        let base = local(vertices.clone(), triangles.clone());
        vertices.push([1e9, -1e300, 3.0]);
        assert_eq!(base, local(vertices, triangles));
    }

    #[test]
    fn collinear_corners_have_no_area_at_any_scale() {
        let line = |scale: f64| [0.1, 0.4, 0.7].map(|t| DVec3::new(0.3 + t / 3.0, 0.2 - t * 0.7, t) * scale);
        for scale in [1e-200, 1.0, 1e200] {
            assert!(is_flat(line(scale)), "{scale}");
            let [a, b, c] = line(scale);
            assert!(!is_flat([a, b + DVec3::X * (1e-9 * scale), c]), "{scale}");
        }
    }

    #[test]
    fn a_scene_over_the_binding_limit_is_cut() {
        let (vertices, triangles) = grid(20, 1.0, [0.0; 3]);
        let mesh = Mesh::new("grid", vertices, triangles, Material::default()).unwrap();
        let scene = Scene::new(vec![mesh]).unwrap();
        let cut = LocalScene::new(&scene, None, 64 * 100);
        assert_eq!(cut.sub_scenes.len(), 8);
        assert!(cut.sub_scenes.iter().all(|s| s.corners.len() * 16 <= 6400 && s.nodes.len() * 32 <= 6400));
        let mut whole: Vec<_> = LocalScene::new(&scene, None, ROOMY).triangles().collect();
        let mut parts: Vec<_> = cut.triangles().collect();
        whole.sort_by(triangle_order);
        parts.sort_by(triangle_order);
        assert_eq!(whole, parts);
    }
}
