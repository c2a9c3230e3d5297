//! The next frame of occluders that no light cuts: who shares which edge is kept; planes, ends and boxes are made anew.

use std::collections::{HashMap, HashSet};

use super::build::{flatness, unit_normal};
use super::{BoundaryEffect, Face, LightBoundary, NO_SIDE, Occluders};
use crate::bvh::{Bvh, box_around, cost, refit};
use crate::local::LocalScene;
use crate::moved::{Rebuild, STRETCH_LIMIT};

impl Occluders {
    /// What these occluders of `from` become in `to`, a later frame of it, for a light with this effect on `to`.
    ///
    /// The set of edges with their faces is that of occluders made anew; only their order is that of the earlier frame.
    ///
    /// # Errors
    /// [`Rebuild`] says why they have to be made anew.
    pub fn moved(&self, from: &LocalScene, to: &LocalScene, effect: &BoundaryEffect) -> Result<Self, Rebuild> {
        if self.cut > 0 || !self.touching.is_empty() || effect.boundary != LightBoundary::None {
            return Err(Rebuild::Boundary);
        }
        if from.caller_ids != to.caller_ids {
            return Err(Rebuild::Order);
        }
        let triangles: Vec<[[f32; 3]; 3]> = to.triangles().collect();
        self.check_faces(&triangles, &effect.behind)?;
        check_welding(from, to)?;
        let mut moved = self.clone();
        for face in &mut moved.faces {
            let corners = &triangles[face.triangle as usize];
            face.normal = unit_normal(corners).ok_or(Rebuild::Triangles)?;
            (face.point, face.flatness) = (corners[0], flatness(face.normal, corners));
            face.sides = turned(face, from, to);
            let [ab, bc, ca, _] = face.sides.map(|side| (side >> 1) as usize);
            // All faces at an edge agree, because the welding is the old one.
            for (edge, [low, high]) in [(ab, [0, 1]), (bc, [1, 2]), (ca, [0, 2])] {
                (moved.edges[edge].low, moved.edges[edge].high) = (corners[low], corners[high]);
            }
        }
        for (edge, index) in moved.edges.iter().zip(0u32..) {
            let first = edge.first_incidence as usize;
            for incidence in &mut moved.incidences[first..first + edge.incidence_count as usize] {
                // Corners are sorted, so only the last side, from the last corner to the first, runs backward.
                let is_last = moved.faces[(*incidence >> 1) as usize].sides[2] >> 1 == index;
                *incidence = *incidence & !1 | u32::from(is_last);
            }
        }
        let (faces, edges) = (&moved.faces, &moved.edges);
        let corners = |face: &Face| &triangles[face.triangle as usize];
        refit(&mut moved.face_tree.nodes, |leaf| box_around(faces[leaf].iter().flat_map(corners)));
        refit(&mut moved.edge_tree.nodes, |leaf| box_around(edges[leaf].iter().flat_map(|e| [&e.low, &e.high])));
        let is_stretched = |tree: &Bvh| cost(&tree.nodes) > STRETCH_LIMIT * tree.built_cost;
        if is_stretched(&moved.face_tree) || is_stretched(&moved.edge_tree) {
            return Err(Rebuild::Stretched);
        }
        Ok(moved)
    }

    /// Exactly the triangles in front that have an area have a face.
    fn check_faces(&self, triangles: &[[[f32; 3]; 3]], behind: &[u32]) -> Result<(), Rebuild> {
        let mut is_left_out = vec![true; triangles.len()];
        for face in &self.faces {
            is_left_out[face.triangle as usize] = false;
        }
        if behind.iter().any(|&triangle| !is_left_out[triangle as usize]) {
            return Err(Rebuild::Boundary);
        }
        if self.faces.len() + behind.len() < triangles.len() {
            behind.iter().for_each(|&triangle| is_left_out[triangle as usize] = false);
            let mut missing = triangles.iter().zip(is_left_out).filter(|(_, is_left_out)| *is_left_out);
            if missing.any(|(corners, _)| unit_normal(corners).is_some()) {
                // It was flat, or behind the light.
                return Err(if self.behind == behind.len() { Rebuild::Triangles } else { Rebuild::Boundary });
            }
        }
        Ok(())
    }
}

/// The sides of a whole triangle after its corners were sorted anew.
fn turned(face: &Face, from: &LocalScene, to: &LocalScene) -> [u32; 4] {
    let (old, new) = (from.vertex_ids[face.triangle as usize], to.vertex_ids[face.triangle as usize]);
    let was = new.map(|vertex| old.iter().position(|&v| v == vertex).unwrap_or_default());
    // Sides run from corner 0 to 1 to 2 to 0: the sum of the two corners, 1, 3 or 2, tells the side.
    let edge = |a: usize, b: usize| face.sides[[0, 0, 2, 1][was[a] + was[b]]] >> 1;
    [edge(0, 1) << 1, edge(1, 2) << 1, edge(2, 0) << 1 | 1, NO_SIDE]
}

/// Vertices of triangles lie in one place after the move exactly where they did before.
fn check_welding(from: &LocalScene, to: &LocalScene) -> Result<(), Rebuild> {
    let (before, after) = (positions(from), positions(to));
    let mut first_at: HashMap<[u32; 3], usize> = HashMap::with_capacity(before.len() / 2);
    let mut seen: HashSet<[u32; 3]> = HashSet::with_capacity(before.len() / 2);
    for (vertex, place) in before.iter().enumerate() {
        let Some(place) = place else { continue };
        let first = *first_at.entry(*place).or_insert(vertex);
        let is_new = first == vertex;
        if is_new && !after[vertex].is_some_and(|place| seen.insert(place)) || after[first] != after[vertex] {
            return Err(Rebuild::Welding);
        }
    }
    Ok(())
}

/// Bits of the position of every vertex that a triangle uses.
fn positions(scene: &LocalScene) -> Vec<Option<[u32; 3]>> {
    let count = scene.vertex_ids.as_flattened().iter().max().map_or(0, |last| *last as usize + 1);
    let mut positions = vec![None; count];
    let corners = scene.sub_scenes.iter().flat_map(|sub_scene| &sub_scene.corners);
    for (vertex, corner) in scene.vertex_ids.as_flattened().iter().zip(corners) {
        positions[*vertex as usize] = Some(corner.position.map(f32::to_bits));
    }
    positions
}
