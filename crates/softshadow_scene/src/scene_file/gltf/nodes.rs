//! Where the meshes of a glTF's scene stand: the node tree with its transforms in float64.

use std::path::Path;

use ::gltf::json::mesh::Mesh;
use ::gltf::json::{Index, Node, Root};
use serde::Deserialize;

use crate::error::SceneError;
use crate::scene_file::invalid;

/// An affine map, row-major, of column vectors.
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// A mesh and where a node puts it.
pub(super) struct Placement {
    pub(super) mesh: Index<Mesh>,
    pub(super) world_from_mesh: Matrix,
}

/// The nodes' transforms once more: the `gltf` crate keeps them in float32, and a translation to map coordinates
/// would lose centimetres.
#[derive(Deserialize)]
struct Transforms {
    #[serde(default)]
    nodes: Vec<Transform>,
}

#[derive(Deserialize)]
struct Transform {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// The meshes of the default scene, of all scenes if none is the default, of all nodes if there are no scenes;
/// parents before children, in the file's order.
pub(super) fn placements(path: &Path, root: &Root, json: &[u8]) -> Result<Vec<Placement>, SceneError> {
    let transforms: Transforms = serde_json::from_slice(json).map_err(|e| invalid(path, format!("JSON: {e}")))?;
    let mut visited = vec![false; root.nodes.len()];
    let mut placements = Vec::new();
    // A stack, because the tree of a hostile file can be deeper than the call stack.
    let mut stack: Vec<(Index<Node>, Matrix)> = roots(path, root)?.into_iter().rev().map(|n| (n, IDENTITY)).collect();
    while let Some((index, world_from_parent)) = stack.pop() {
        let (Some(node), Some(transform), Some(visited)) =
            (root.nodes.get(index.value()), transforms.nodes.get(index.value()), visited.get_mut(index.value()))
        else {
            return Err(invalid(path, format!("node {index} is not there")));
        };
        if std::mem::replace(visited, true) {
            return Err(invalid(path, format!("node {index} is reached twice; nodes must form trees")));
        }
        let local = transform.matrix().map_err(|reason| invalid(path, format!("node {index}: {reason}")))?;
        let world_from_node = product(&world_from_parent, &local);
        placements.extend(node.mesh.map(|mesh| Placement { mesh, world_from_mesh: world_from_node }));
        stack.extend(node.children.iter().flatten().rev().map(|&child| (child, world_from_node)));
    }
    Ok(placements)
}

/// Each root once, although scenes may share some.
fn roots(path: &Path, root: &Root) -> Result<Vec<Index<Node>>, SceneError> {
    let mut seen = vec![false; root.nodes.len()];
    if let Some(index) = root.scene {
        let scene = root.get(index).ok_or_else(|| invalid(path, format!("scene {index} is not there")))?;
        return Ok(scene.nodes.clone());
    }
    if root.scenes.is_empty() {
        let children = root.nodes.iter().filter_map(|node| node.children.as_ref()).flatten();
        for child in children {
            if let Some(is_child) = seen.get_mut(child.value()) {
                *is_child = true;
            }
        }
        return Ok((0_u32..).zip(seen).filter(|(_, is_child)| !is_child).map(|(i, _)| Index::new(i)).collect());
    }
    let mut roots = Vec::new();
    for &node in root.scenes.iter().flat_map(|scene| &scene.nodes) {
        match seen.get_mut(node.value()) {
            Some(seen) => {
                if !std::mem::replace(seen, true) {
                    roots.push(node);
                }
            }
            None => return Err(invalid(path, format!("node {node} is not there"))),
        }
    }
    Ok(roots)
}

impl Transform {
    fn matrix(&self) -> Result<Matrix, String> {
        if let Some(m) = &self.matrix {
            // glTF stores columns.
            let [[a, b, c, d], [e, f, g, h], [i, j, k, l], [m, n, o, p]] = columns(m);
            if [d, h, l, p] != [0.0, 0.0, 0.0, 1.0] {
                return Err("its matrix is not affine".into());
            }
            return Ok([[a, e, i, m], [b, f, j, n], [c, g, k, o], [d, h, l, p]]);
        }
        let [x, y, z, w] = unit(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0])).ok_or("its rotation has length 0")?;
        let [tx, ty, tz] = self.translation.unwrap_or_default();
        let [sx, sy, sz] = self.scale.unwrap_or([1.0; 3]);
        Ok([
            [(1.0 - 2.0 * (y * y + z * z)) * sx, 2.0 * (x * y - z * w) * sy, 2.0 * (x * z + y * w) * sz, tx],
            [2.0 * (x * y + z * w) * sx, (1.0 - 2.0 * (x * x + z * z)) * sy, 2.0 * (y * z - x * w) * sz, ty],
            [2.0 * (x * z - y * w) * sx, 2.0 * (y * z + x * w) * sy, (1.0 - 2.0 * (x * x + y * y)) * sz, tz],
            [0.0, 0.0, 0.0, 1.0],
        ])
    }
}

fn columns(m: &[f64; 16]) -> Matrix {
    let mut columns = [[0.0; 4]; 4];
    columns.as_flattened_mut().copy_from_slice(m);
    columns
}

/// Files hold quaternions rounded to float32; without this the mesh would be scaled by the rounding.
fn unit(quaternion: [f64; 4]) -> Option<[f64; 4]> {
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| quaternion.map(|x| x / length))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2, 3].map(|column| row.iter().zip(b).map(|(x, b_row)| x * b_row[column]).sum()))
}
