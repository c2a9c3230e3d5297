//! The pinhole camera.

use pyo3::prelude::*;

use crate::errors::scene_exception;

/// A checked pinhole camera.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct Camera(pub(crate) softshadow::Camera);

#[pymethods]
impl Camera {
    /// `intrinsics` is `[fx, fy, cx, cy]` in pixels, `size` is `[width, height]`.
    #[new]
    fn new(world_from_camera: [[f64; 4]; 4], intrinsics: [f64; 4], size: [u32; 2]) -> PyResult<Self> {
        let camera = softshadow::Camera::new(world_from_camera, intrinsics, size);
        camera.map(Self).map_err(|error| scene_exception(&error))
    }

    #[staticmethod]
    fn with_fov(world_from_camera: [[f64; 4]; 4], fov_y_deg: f64, size: [u32; 2]) -> PyResult<Self> {
        let camera = softshadow::Camera::with_fov(world_from_camera, fov_y_deg, size);
        camera.map(Self).map_err(|error| scene_exception(&error))
    }
}

/// The rigid matrix at `eye` whose local −Z points at `target`.
#[pyfunction]
#[pyo3(signature = (eye, target, up=None))]
pub(crate) fn look_at(eye: [f64; 3], target: [f64; 3], up: Option<[f64; 3]>) -> PyResult<[[f64; 4]; 4]> {
    softshadow::look_at(eye, target, up).map_err(|error| scene_exception(&error))
}
