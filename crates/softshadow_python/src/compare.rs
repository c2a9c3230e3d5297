//! Techniques against a reference.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::camera::Camera;
use crate::context::Context;
use crate::detached::detached_with_progress;
use crate::light::Light;
use crate::scene::Scene;
use crate::technique::{json, parse_technique};
use crate::visibility::receivers_of;

/// What was measured as JSON; reference and results as flat arrays, which Python gives their shape.
#[derive(IntoPyObject)]
pub(crate) struct ComparisonArrays<'py> {
    measured: String,
    reference_values: Bound<'py, PyArray1<f32>>,
    values: Vec<Bound<'py, PyArray1<f32>>>,
}

/// Error, time and visibility of every technique.
#[pyfunction]
#[pyo3(signature = (context, scene, light, *, camera, points, normals, techniques, reference, repeats, progress))]
#[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    context: &Bound<'py, Context>,
    scene: &Bound<'py, Scene>,
    light: &Bound<'py, Light>,
    camera: Option<Bound<'py, Camera>>,
    points: Option<PyReadonlyArray2<'py, f64>>,
    normals: Option<PyReadonlyArray2<'py, f64>>,
    techniques: Vec<String>,
    reference: &str,
    repeats: u32,
    progress: Option<Py<PyAny>>,
) -> PyResult<ComparisonArrays<'py>> {
    let (context, scene, light) = (context.get().get()?, &scene.get().0, &light.get().0);
    let techniques = techniques.iter().map(|text| parse_technique(text)).collect::<PyResult<Vec<_>>>()?;
    let reference = parse_technique(reference)?;
    let receivers = receivers_of(camera.as_ref(), points.as_ref(), normals.as_ref())?;
    let mut comparison = detached_with_progress(py, progress, |on_progress| {
        softshadow::compare(context, scene, light, &receivers, &techniques, &reference, repeats, on_progress)
    })?;
    Ok(ComparisonArrays {
        measured: json(&comparison)?,
        reference_values: std::mem::take(&mut comparison.reference_values).into_pyarray(py),
        values: comparison.rows.into_iter().map(|row| row.values.into_pyarray(py)).collect(),
    })
}
