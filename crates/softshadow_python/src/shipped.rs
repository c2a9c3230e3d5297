//! The scenes that come with the library.

use pyo3::prelude::*;
use softshadow::Error;
use softshadow::procedural::{self, CameraDescription, LightDescription, LightShape};

use crate::detached::detached;
use crate::scene::Scene;

#[derive(IntoPyObject)]
pub(crate) struct ShippedScene {
    description: String,
    scene: Scene,
    light: ShippedLight,
    camera: ShippedCamera,
}

#[derive(IntoPyObject)]
struct ShippedLight {
    shape: &'static str,
    sizes: Vec<f64>,
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    radiance: [f64; 3],
}

#[derive(IntoPyObject)]
struct ShippedCamera {
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov_y_deg: f64,
    size: [u32; 2],
}

impl From<&LightDescription> for ShippedLight {
    fn from(light: &LightDescription) -> Self {
        let (shape, sizes) = match light.shape {
            LightShape::Rectangle { width, height } => ("rectangle", vec![width, height]),
            LightShape::Disc { radius } => ("disc", vec![radius]),
            LightShape::Sphere { radius } => ("sphere", vec![radius]),
            LightShape::Sun { angular_diameter_deg } => ("sun", vec![angular_diameter_deg]),
        };
        let LightDescription { position, target, up, radiance, .. } = *light;
        Self { shape, sizes, position, target, up, radiance }
    }
}

impl From<&CameraDescription> for ShippedCamera {
    fn from(camera: &CameraDescription) -> Self {
        let CameraDescription { eye, target, up, fov_y_deg, size } = *camera;
        Self { eye, target, up, fov_y_deg, size }
    }
}

/// Names of the shipped scenes, sorted.
#[pyfunction]
pub(crate) fn shipped_names() -> Vec<&'static str> {
    procedural::names().to_vec()
}

/// A shipped scene with the light and the camera that it is meant for.
#[pyfunction]
pub(crate) fn shipped_scene(py: Python<'_>, name: &str) -> PyResult<ShippedScene> {
    detached(py, || {
        let source = procedural::shipped(name).map_err(Error::Scene)?;
        Ok(ShippedScene {
            description: source.description().to_owned(),
            scene: Scene(source.build().map_err(Error::Scene)?),
            light: source.light().into(),
            camera: source.camera().into(),
        })
    })
}
