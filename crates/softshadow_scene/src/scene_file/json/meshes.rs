//! The meshes that a `scene.json` names, each file read once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::check_unit;
use super::model::{MaterialFields, MeshFields};
use super::placement::world_from_mesh;
use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Material, Mesh};
use crate::scene::Scene;
use crate::scene_file::{Format, MAX_FILE_BYTES, MAX_MESHES, RegularFile, check_limit, invalid};

/// The most vertices: as many as all triangles of a scene can use.
const MAX_VERTICES: u64 = 3 * MAX_TRIANGLES;

pub(super) fn read_all(path: &Path, fields: &[MeshFields], meters_per_unit: f64) -> Result<Scene, SceneError> {
    let mut files = Files::default();
    let (mut meshes, mut triangles, mut vertices) = (Vec::new(), 0, 0);
    for (index, fields) in fields.iter().enumerate() {
        let broken = |reason: String| invalid(path, format!("meshes[{index}]: {reason}"));
        let placed = Placed::new(fields, path, meters_per_unit).map_err(broken)?;
        let parts = files.read(&placed)?;
        let is_alone = parts.len() == 1;
        for part in parts {
            triangles += part.triangles.len() as u64;
            vertices += part.vertices.len() as u64;
            check_limit("triangles of the scene", triangles, MAX_TRIANGLES)?;
            check_limit("vertices of the scene", vertices, MAX_VERTICES)?;
            check_limit("meshes of the scene", meshes.len() as u64 + 1, MAX_MESHES)?;
            meshes.push(placed.mesh(part, is_alone).map_err(|error| broken(error.to_string()))?);
        }
    }
    if triangles == 0 {
        return Err(invalid(path, "it has no meshes with triangles"));
    }
    Ok(files.notes.into_iter().fold(Scene::new(meshes)?, Scene::with_note))
}

/// What has been read: a model that stands in many places is read once.
#[derive(Default)]
struct Files {
    meshes: HashMap<PathBuf, Vec<Mesh>>,
    bytes: u64,
    notes: Vec<String>,
}

impl Files {
    fn read(&mut self, placed: &Placed) -> Result<&[Mesh], SceneError> {
        if !self.meshes.contains_key(&placed.path) {
            let file = RegularFile::open(&placed.path)?;
            self.bytes = self.bytes.saturating_add(file.length);
            check_limit("bytes of the files of all meshes", self.bytes, MAX_FILE_BYTES)?;
            let scene = placed.format.parse(&placed.path, &file.read(MAX_FILE_BYTES)?)?.scene;
            let name = placed.path.file_name().unwrap_or_default().to_string_lossy();
            self.notes.extend(scene.notes().iter().map(|note| format!("{name}: {note}")));
            self.meshes.insert(placed.path.clone(), scene.meshes().to_vec());
        }
        Ok(self.meshes.get(&placed.path).map_or(&[], Vec::as_slice))
    }
}

/// An entry that has been checked.
struct Placed<'a> {
    fields: &'a MeshFields,
    path: PathBuf,
    format: Format,
    world_from_mesh: [[f64; 4]; 4],
}

impl<'a> Placed<'a> {
    fn new(fields: &'a MeshFields, scene_path: &Path, meters_per_unit: f64) -> Result<Self, String> {
        let path = scene_path.parent().unwrap_or(Path::new("")).join(&fields.path);
        let format = Format::of(&path).map_err(|error| format!("path: {error}"))?;
        if format == Format::Json {
            return Err("path: a scene cannot hold another scene.json; name its meshes".into());
        }
        let own = match (fields.meters_per_unit, format) {
            (Some(own), _) => own,
            // Section 3.2 of the specification: all units of length are metres.
            (None, Format::Gltf) => 1.0,
            (None, _) => meters_per_unit,
        };
        check_unit(own).map_err(|reason| format!("meters_per_unit: {reason}"))?;
        let mut matrix = world_from_mesh(fields)?;
        // A ratio of 1 changes no bit.
        let ratio = own / meters_per_unit;
        matrix.iter_mut().for_each(|row| row[..3].iter_mut().for_each(|x| *x *= ratio));
        check_material(fields)?;
        Ok(Self { fields, path, format, world_from_mesh: matrix })
    }

    fn mesh(&self, part: &Mesh, is_alone: bool) -> Result<Mesh, SceneError> {
        let name = match &self.fields.name {
            None => part.name.clone(),
            Some(name) if is_alone => name.clone(),
            Some(name) => format!("{name}/{}", part.name),
        };
        let mesh = Mesh { name, material: self.material(part.material), ..part.clone() };
        mesh.transformed(&self.world_from_mesh)
    }

    /// The file's own material, where the entry says nothing else.
    fn material(&self, own: Material) -> Material {
        let given = self.fields.material.as_ref();
        Material {
            base_color: given.and_then(|m| m.base_color).unwrap_or(own.base_color),
            roughness: given.and_then(|m| m.roughness).unwrap_or(own.roughness),
            specular: given.and_then(|m| m.specular).unwrap_or(own.specular),
            opacity: self.fields.opacity.unwrap_or(own.opacity),
        }
    }
}

fn check_material(fields: &MeshFields) -> Result<(), String> {
    let share = |what: &str, value: Option<f32>| match value {
        Some(value) if !(0.0..=1.0).contains(&value) => Err(format!("{what}: must lie between 0 and 1, got {value}")),
        _ => Ok(()),
    };
    share("opacity", fields.opacity)?;
    let Some(MaterialFields { base_color, roughness, specular }) = &fields.material else { return Ok(()) };
    share("material.roughness", *roughness)?;
    share("material.specular", *specular)?;
    base_color.iter().flatten().try_for_each(|channel| share("material.base_color", Some(*channel)))
}
