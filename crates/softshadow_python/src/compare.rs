//! Techniques against a reference.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::camera::Camera;
use crate::context::Context;
use crate::detached::detached_with_progress;
use crate::light::Light;
use crate::scene::Scene;
use crate::technique::{json, parse_technique};
use crate::visibility::receivers_of;

/// Error and time of every technique, as JSON.
#[pyfunction]
#[pyo3(signature = (context, scene, light, *, camera, points, normals, techniques, reference, repeats, progress))]
#[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
pub(crate) fn compare(
    py: Python<'_>,
    context: &Bound<'_, Context>,
    scene: &Bound<'_, Scene>,
    light: &Bound<'_, Light>,
    camera: Option<Bound<'_, Camera>>,
    points: Option<PyReadonlyArray2<'_, f64>>,
    normals: Option<PyReadonlyArray2<'_, f64>>,
    techniques: Vec<String>,
    reference: &str,
    repeats: u32,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (context, scene, light) = (context.get().get()?, &scene.get().0, &light.get().0);
    let techniques = techniques.iter().map(|text| parse_technique(text)).collect::<PyResult<Vec<_>>>()?;
    let reference = parse_technique(reference)?;
    let receivers = receivers_of(camera.as_ref(), points.as_ref(), normals.as_ref())?;
    let comparison = detached_with_progress(py, progress, |on_progress| {
        softshadow::compare(context, scene, light, &receivers, &techniques, &reference, repeats, on_progress)
    })?;
    json(&comparison)
}
