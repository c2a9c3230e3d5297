//! Files that hold lights and a camera beside their meshes.

use std::path::PathBuf;

use pyo3::prelude::*;
use softshadow::scene_file::{FileCamera, FileLight};
use softshadow::{Error, LightShape};

use crate::detached::detached;
use crate::scene::Scene;

#[derive(IntoPyObject)]
pub(crate) struct SceneFile {
    scene: Scene,
    lights: Vec<LightFields>,
    camera: Option<CameraFields>,
    meters_per_unit: Option<f64>,
}

#[derive(IntoPyObject)]
struct LightFields {
    name: String,
    shape: &'static str,
    sizes: Vec<f64>,
    world_from_light: [[f64; 4]; 4],
    radiance: [f32; 3],
}

#[derive(IntoPyObject)]
struct CameraFields {
    eye: [f64; 3],
    target: [f64; 3],
    up: Option<[f64; 3]>,
    fov_y_deg: f64,
    size: [u32; 2],
}

impl From<FileLight> for LightFields {
    fn from(FileLight { name, light }: FileLight) -> Self {
        let (shape, sizes) = match light.shape() {
            LightShape::Rectangle { width, height } => ("rectangle", vec![*width, *height]),
            LightShape::Disc { radius } => ("disc", vec![*radius]),
            LightShape::Sphere { radius } => ("sphere", vec![*radius]),
            LightShape::Polygon { outline } => ("polygon", outline.concat()),
            LightShape::Sun { angular_diameter } => ("sun", vec![angular_diameter.to_degrees()]),
        };
        Self { name, shape, sizes, world_from_light: light.world_from_light(), radiance: light.radiance() }
    }
}

impl From<FileCamera> for CameraFields {
    fn from(FileCamera { eye, target, up, fov_y_deg, size }: FileCamera) -> Self {
        Self { eye, target, up, fov_y_deg, size }
    }
}

/// Everything that a file holds.
#[pyfunction]
pub(crate) fn load_scene_file(py: Python<'_>, path: PathBuf) -> PyResult<SceneFile> {
    detached(py, || {
        let file = softshadow::scene_file::load_all(&path).map_err(Error::Scene)?;
        Ok(SceneFile {
            scene: Scene(file.scene),
            lights: file.lights.into_iter().map(LightFields::from).collect(),
            camera: file.camera.map(CameraFields::from),
            meters_per_unit: file.meters_per_unit,
        })
    })
}
