//! `scene.json`: meshes from other files with their transforms and materials, lights, a camera and a unit of length.
//!
//! Paths of meshes are relative to the folder of the file. Unlike a glTF's buffers they may leave it, because scenes share models; but
//! they must name regular files of a format that this module's neighbours read, so nothing else of a reader's disk is opened.

mod light;
mod meshes;
mod model;
mod placement;

use std::collections::BTreeSet;
use std::path::Path;

use serde::de::DeserializeOwned;

use self::model::{CameraFields, Document, VERSION, Version};
use super::{FileCamera, FileLight, SceneFile, invalid};
use crate::camera::Camera;
use crate::error::SceneError;

/// The longest text that is read: lists of paths and lights, no geometry.
pub(super) const MAX_BYTES: u64 = 64 << 20;

/// The scene with its lights and its camera.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<SceneFile, SceneError> {
    let needed = bytes.len() as u64;
    if needed > MAX_BYTES {
        let what = format!("bytes of {}", path.display());
        return Err(SceneError::TooLarge { what, needed, limit: MAX_BYTES });
    }
    let version: Version = typed(bytes).map_err(|reason| invalid(path, reason))?;
    match version.softshadow {
        Some(number) if number.as_u64() == Some(VERSION) => {}
        Some(number) => {
            return Err(invalid(path, format!("softshadow: version {number} cannot be read; {VERSION} can")));
        }
        None => return Err(invalid(path, format!("it is no scene: \"softshadow\": {VERSION} is missing"))),
    }
    let document: Document = typed(bytes).map_err(|reason| invalid(path, reason))?;
    check_unit(document.meters_per_unit).map_err(|reason| invalid(path, format!("meters_per_unit: {reason}")))?;
    let lights = read_lights(&document).map_err(|reason| invalid(path, reason))?;
    let camera = document.camera.map(read_camera).transpose();
    let camera = camera.map_err(|error| invalid(path, format!("camera: {error}")))?;
    let scene = meshes::read_all(path, &document.meshes, document.meters_per_unit)?;
    Ok(SceneFile { scene, lights, camera, meters_per_unit: Some(document.meters_per_unit) })
}

/// The place of what is wrong comes first: `lights[1].width: invalid type …`.
fn typed<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut json).map_err(|error| match error.path().to_string() {
        place if place == "." => error.inner().to_string(),
        place => format!("{place}: {}", error.inner()),
    })?;
    json.end().map_err(|error| error.to_string())?;
    Ok(value)
}

fn check_unit(meters_per_unit: f64) -> Result<(), String> {
    if meters_per_unit > 0.0 && meters_per_unit.is_finite() {
        return Ok(());
    }
    Err(format!("must be positive and finite, got {meters_per_unit}"))
}

/// Names are what files of results call their columns and channels, so each light has its own.
fn read_lights(document: &Document) -> Result<Vec<FileLight>, String> {
    let mut names = BTreeSet::new();
    let lights = document.lights.iter().enumerate().map(|(index, fields)| {
        let name = fields.name.clone().unwrap_or_default();
        if !name.is_empty() && !names.insert(name.clone()) {
            return Err(format!("lights[{index}].name: a second light '{name}'"));
        }
        let light = light::build(fields).map_err(|reason| format!("lights[{index}]: {reason}"))?;
        Ok(FileLight { name, light })
    });
    lights.collect()
}

fn read_camera(fields: CameraFields) -> Result<FileCamera, SceneError> {
    let CameraFields { eye, target, up, fov_y_deg, size } = fields;
    Camera::look_at(eye, target, up, fov_y_deg, size)?;
    Ok(FileCamera { eye, target, up, fov_y_deg, size })
}

#[cfg(test)]
mod tests;
