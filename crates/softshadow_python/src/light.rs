//! Area lights.

use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use softshadow::{LightShape, LightTexture, SceneError, UpAxis};

use crate::errors::{internal_exception, scene_exception};

/// A checked area light.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct Light(pub(crate) softshadow::Light);

impl Light {
    fn flat(shape: LightShape, world_from_light: [[f64; 4]; 4], radiance: [f32; 3]) -> PyResult<Self> {
        softshadow::Light::new(shape, world_from_light)
            .and_then(|light| light.with_radiance(radiance))
            .map(Self)
            .map_err(|error| scene_exception(&error))
    }
}

#[pymethods]
impl Light {
    #[staticmethod]
    fn rectangle(
        width: f64,
        height: f64,
        world_from_light: [[f64; 4]; 4],
        radiance: [f32; 3],
        texture: Option<PyReadonlyArray3<'_, f32>>,
    ) -> PyResult<Self> {
        let light = Self::flat(LightShape::Rectangle { width, height }, world_from_light, radiance)?;
        let Some(texture) = texture else { return Ok(light) };
        let texture = light_texture(&texture)?;
        light.0.with_texture(texture).map(Self).map_err(|error| scene_exception(&error))
    }

    #[staticmethod]
    fn disc(radius: f64, world_from_light: [[f64; 4]; 4], radiance: [f32; 3]) -> PyResult<Self> {
        Self::flat(LightShape::Disc { radius }, world_from_light, radiance)
    }

    #[staticmethod]
    fn sphere(radius: f64, world_from_light: [[f64; 4]; 4], radiance: [f32; 3]) -> PyResult<Self> {
        Self::flat(LightShape::Sphere { radius }, world_from_light, radiance)
    }

    #[staticmethod]
    fn polygon(outline: Vec<[f64; 2]>, world_from_light: [[f64; 4]; 4], radiance: [f32; 3]) -> PyResult<Self> {
        Self::flat(LightShape::Polygon { outline }, world_from_light, radiance)
    }

    /// `up` is `"y"` or `"z"`; angles in degrees.
    #[staticmethod]
    fn sun(azimuth: f64, elevation: f64, diameter_deg: f64, up: &str, radiance: [f32; 3]) -> PyResult<Self> {
        let up = match up {
            "y" => UpAxis::Y,
            "z" => UpAxis::Z,
            _ => return Err(internal_exception(format!("unknown up axis '{up}'"))),
        };
        softshadow::Light::sun(azimuth, elevation, diameter_deg, up)
            .and_then(|light| light.with_radiance(radiance))
            .map(Self)
            .map_err(|error| scene_exception(&error))
    }
}

fn light_texture(array: &PyReadonlyArray3<'_, f32>) -> PyResult<LightTexture> {
    let shape = array.shape();
    let (Ok(height), Ok(width), 3) = (u32::try_from(shape[0]), u32::try_from(shape[1]), shape[2]) else {
        return Err(internal_exception(format!("a texture of shape (h, w, 3) expected, got {shape:?}")));
    };
    let texels = array.as_slice()?.as_chunks().0.to_vec();
    LightTexture::new(width, height, texels).map_err(|error: SceneError| scene_exception(&error))
}
