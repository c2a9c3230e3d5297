//! glTF 2.0, Khronos Group 2021: the triangles of the default scene, in world space.
//!
//! The JSON is read by the `gltf` crate's types, the bytes by `accessors.rs` here: the crate's readers panic on some
//! broken files. Images are never opened.

mod accessors;
mod container;
mod materials;
mod nodes;

use std::collections::BTreeSet;
use std::path::Path;

use ::gltf::json::Root;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;

use self::accessors::Buffers;
use self::nodes::Placement;
use super::{check_limit, invalid};
use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Mesh};
use crate::scene::Scene;

/// The most primitives after instancing. Points and lines count too: without the limit a small file could ask for
/// endless work that makes no triangle.
const MAX_PRIMITIVES: u64 = 1 << 20;
/// The most vertices after instancing: as many as all triangles of a scene can use.
const MAX_VERTICES: u64 = 3 * MAX_TRIANGLES;

/// The most objects of the JSON, counted by their brackets: one of three bytes, an empty node, takes 900 bytes when it is read.
const MAX_OBJECTS: u64 = 1 << 22;

/// Extensions that may be required of a reader and change nothing that is read here.
const HARMLESS_EXTENSIONS: [&str; 5] =
    ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_punctual", "KHR_xmp"];

/// One mesh a primitive and node, in the order of the node tree.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    let container = container::split(bytes).map_err(|reason| invalid(path, reason))?;
    let objects = container.json.iter().filter(|byte| **byte == b'{').count() as u64;
    check_limit(&format!("objects in the JSON of {}", path.display()), objects, MAX_OBJECTS)?;
    let root: Root = Root::from_slice(container.json).map_err(|e| invalid(path, format!("JSON: {e}")))?;
    if !(root.asset.version == "2" || root.asset.version.starts_with("2.")) {
        return Err(invalid(path, format!("glTF version {} cannot be read; 2.0 can", root.asset.version)));
    }
    for name in &root.extensions_required {
        if !HARMLESS_EXTENSIONS.iter().any(|harmless| name.starts_with(harmless)) {
            return Err(invalid(path, format!("it requires the extension {name}; export it without")));
        }
    }
    let placements = nodes::placements(path, &root, container.json)?;
    let buffers = Buffers::read(path, &root, container.binary)?;
    let mut reader =
        Reader { path, root: &root, buffers, notes: document_notes(&root), primitives: 0, vertices: 0, triangles: 0 };
    let meshes = reader.read_all(&placements)?;
    if meshes.iter().all(|mesh| mesh.triangles.is_empty()) {
        return Err(invalid(path, "its scene has no triangles"));
    }
    let notes = reader.notes;
    Ok(notes.into_iter().fold(Scene::new(meshes)?, Scene::with_note))
}

/// What a document holds beside meshes, whether or not its scene uses it.
fn document_notes(root: &Root) -> BTreeSet<String> {
    let mut notes: BTreeSet<String> =
        [("animations", root.animations.len()), ("cameras", root.cameras.len()), ("skins", root.skins.len())]
            .iter()
            .filter(|(_, count)| *count > 0)
            .map(|(what, count)| format!("{count} {what} left out"))
            .collect();
    notes.extend(root.extensions_used.iter().map(|name| format!("extension {name} left out")));
    notes
}

struct Reader<'a> {
    path: &'a Path,
    root: &'a Root,
    buffers: Buffers<'a>,
    notes: BTreeSet<String>,
    primitives: u64,
    vertices: u64,
    triangles: u64,
}

impl Reader<'_> {
    fn read_all(&mut self, placements: &[Placement]) -> Result<Vec<Mesh>, SceneError> {
        let mut meshes = Vec::new();
        for placement in placements {
            let index = placement.mesh.value();
            let mesh = self
                .root
                .get(placement.mesh)
                .ok_or_else(|| invalid(self.path, format!("a node refers to mesh {index}, which is not there")))?;
            let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {index}"));
            for (primitive_index, primitive) in mesh.primitives.iter().enumerate() {
                let name = match mesh.primitives.len() {
                    1 => name.clone(),
                    _ => format!("{name} primitive {primitive_index}"),
                };
                self.primitives += 1;
                check_limit("primitives of the scene", self.primitives, MAX_PRIMITIVES)?;
                if let Some(mesh) = self.read_primitive(name, primitive)? {
                    meshes.push(mesh.transformed(&placement.world_from_mesh)?);
                }
            }
        }
        Ok(meshes)
    }

    /// A primitive's mesh in its own space, or `None` for points and lines.
    fn read_primitive(&mut self, name: String, primitive: &Primitive) -> Result<Option<Mesh>, SceneError> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Checked::Valid(_) => {
                self.notes.insert("points and lines left out".into());
                return Ok(None);
            }
            Checked::Invalid => return Err(invalid(self.path, format!("mesh '{name}': unknown primitive mode"))),
        };
        let material = self.material(&name, primitive)?;
        let broken = |reason: String| invalid(self.path, format!("mesh '{name}': {reason}"));
        let Some(&positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            return Err(broken("it has no POSITION attribute".into()));
        };
        let positions = self.buffers.positions(self.root, positions).map_err(&broken)?;
        let indices = match primitive.indices {
            Some(accessor) => Some(self.buffers.indices(self.root, accessor).map_err(&broken)?),
            None => None,
        };
        let corner_count = indices.as_ref().map_or(positions.len(), |indices| indices.len());
        let triangle_count = triangle_count(mode, corner_count).map_err(&broken)?;
        self.vertices += positions.len();
        self.triangles += triangle_count;
        check_limit("vertices of the scene", self.vertices, MAX_VERTICES)?;
        check_limit("triangles of the scene", self.triangles, MAX_TRIANGLES)?;

        let corners: Vec<u32> = match indices {
            Some(indices) => indices.iter().collect(),
            // The limit on vertices keeps the count in 32 bits.
            None => (0..corner_count as u32).collect(),
        };
        Mesh::new(name, positions.iter().collect(), assemble(mode, &corners), material).map(Some)
    }

    fn material(&mut self, name: &str, primitive: &Primitive) -> Result<crate::mesh::Material, SceneError> {
        let attributes = &primitive.attributes;
        if attributes.keys().any(|key| matches!(key, Checked::Valid(Semantic::Colors(_)))) {
            self.notes.insert("vertex colours left out".into());
        }
        if primitive.targets.is_some() {
            self.notes.insert("morph targets left out".into());
        }
        let Some(index) = primitive.material else { return Ok(crate::mesh::Material::default()) };
        let material = self.root.get(index).ok_or_else(|| {
            invalid(self.path, format!("mesh '{name}' refers to material {index}, which is not there"))
        })?;
        Ok(materials::read(material, &mut self.notes))
    }
}

fn triangle_count(mode: Mode, corners: u64) -> Result<u64, String> {
    match mode {
        Mode::TriangleStrip | Mode::TriangleFan => Ok(corners.saturating_sub(2)),
        _ if corners.is_multiple_of(3) => Ok(corners / 3),
        _ => Err(format!("{corners} corners are no whole number of triangles")),
    }
}

/// Triangles in the corner order that section 3.7.2.1 of the specification gives.
fn assemble(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match (mode, corners) {
        (Mode::TriangleStrip, [_, second @ ..]) => {
            let thirds = second.iter().skip(1);
            let triangles = corners.iter().zip(second).zip(thirds).enumerate();
            triangles.map(|(i, ((&a, &b), &c))| if i % 2 == 0 { [a, b, c] } else { [a, c, b] }).collect()
        }
        (Mode::TriangleFan, [centre, rim @ ..]) => {
            rim.iter().zip(rim.iter().skip(1)).map(|(&a, &b)| [a, b, *centre]).collect()
        }
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}
