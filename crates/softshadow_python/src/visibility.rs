//! Visibility and pictures.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use softshadow::measure::ErrorNorm;
use softshadow::{Error, Goal, Limit, Options, PictureOptions, Points, Receivers, Shading};

use crate::arrays::rows;
use crate::camera::Camera;
use crate::context::Context;
use crate::detached::detached_with_progress;
use crate::errors::{internal_exception, scene_exception, settings_exception};
use crate::light::Light;
use crate::scene::Scene;
use crate::technique::{json, parse_technique};

/// Flat arrays; Python gives them their shape.
#[derive(IntoPyObject)]
pub(crate) struct VisibilityArrays<'py> {
    values: Bound<'py, PyArray1<f32>>,
    channels: usize,
    valid: Bound<'py, PyArray1<bool>>,
    standard_error: Option<Bound<'py, PyArray1<f32>>>,
    placed: Option<PlacedArrays<'py>>,
    visible_samples: Option<Bound<'py, PyArray1<bool>>>,
    info: String,
}

#[derive(IntoPyObject)]
struct PlacedArrays<'py> {
    positions: Bound<'py, PyArray1<f64>>,
    normals: Bound<'py, PyArray1<f32>>,
    triangles: Bound<'py, PyArray1<i64>>,
}

#[derive(IntoPyObject)]
pub(crate) struct PictureArrays<'py> {
    linear: Bound<'py, PyArray1<f32>>,
    srgb: Bound<'py, PyArray1<u8>>,
    visibility: VisibilityArrays<'py>,
}

impl<'py> VisibilityArrays<'py> {
    fn new(py: Python<'py>, visibility: softshadow::Visibility) -> PyResult<Self> {
        let samples = visibility.info.technique.samples() as usize;
        Ok(Self {
            info: json(&visibility.info)?,
            visible_samples: visibility.masks.map(|masks| masks.visible(samples).into_pyarray(py)),
            values: visibility.values.into_pyarray(py),
            channels: visibility.channels,
            valid: visibility.valid.into_pyarray(py),
            standard_error: visibility.standard_error.map(|values| values.into_pyarray(py)),
            placed: visibility.placed.map(|placed| PlacedArrays {
                positions: placed.positions.into_flattened().into_pyarray(py),
                normals: placed.normals.into_flattened().into_pyarray(py),
                triangles: placed.triangles.into_pyarray(py),
            }),
        })
    }
}

/// What a caller asks for besides scene, lights and technique; `None` leaves the library's default.
fn options(memory_limit: Option<u64>, standard_error: bool, receivers: bool, sample_masks: bool) -> Options {
    let default = Options::default();
    let memory_limit_bytes = memory_limit.unwrap_or(default.memory_limit_bytes);
    Options { memory_limit_bytes, standard_error, receivers, sample_masks, ..default }
}

/// A camera, or else points with or without normals.
pub(crate) fn receivers_of(
    camera: Option<&Bound<'_, Camera>>,
    points: Option<&PyReadonlyArray2<'_, f64>>,
    normals: Option<&PyReadonlyArray2<'_, f64>>,
) -> PyResult<Receivers> {
    match (camera, points) {
        (Some(camera), None) => Ok(Receivers::Camera(camera.get().0)),
        (None, Some(points)) => {
            let points = Points::new(rows(points)?, normals.map(rows).transpose()?);
            points.map(Receivers::Points).map_err(|error| scene_exception(&error))
        }
        _ => Err(internal_exception("either a camera or points expected".into())),
    }
}

pub(crate) fn lights_of(lights: &[Py<Light>]) -> Vec<softshadow::Light> {
    lights.iter().map(|light| light.get().0.clone()).collect()
}

/// The lit fraction of every light at every receiver.
#[pyfunction]
#[pyo3(signature = (context, scene, lights, *, camera, points, normals, technique, memory_limit, standard_error, receivers, sample_masks, progress))]
#[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
pub(crate) fn visibility<'py>(
    py: Python<'py>,
    context: &Bound<'py, Context>,
    scene: &Bound<'py, Scene>,
    lights: Vec<Py<Light>>,
    camera: Option<Bound<'py, Camera>>,
    points: Option<PyReadonlyArray2<'py, f64>>,
    normals: Option<PyReadonlyArray2<'py, f64>>,
    technique: &str,
    memory_limit: Option<u64>,
    standard_error: bool,
    receivers: bool,
    sample_masks: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<VisibilityArrays<'py>> {
    let (context, scene, lights) = (context.get().get()?, &scene.get().0, lights_of(&lights));
    let technique = parse_technique(technique)?;
    let options = options(memory_limit, standard_error, receivers, sample_masks);
    let receivers = receivers_of(camera.as_ref(), points.as_ref(), normals.as_ref())?;
    let result = detached_with_progress(py, progress, |on_progress| {
        softshadow::visibility(context, scene, &lights, &receivers, &technique, &options, on_progress)
    })?;
    VisibilityArrays::new(py, result)
}

/// The lit fraction of every light at every receiver by a technique that is chosen for an error or a time; with why not, where nothing
/// keeps it.
#[pyfunction]
#[pyo3(signature = (context, scene, lights, *, camera, points, normals, max_error, max_ms, error_norm, confidence, memory_limit, standard_error, receivers, progress))]
#[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
pub(crate) fn visibility_within<'py>(
    py: Python<'py>,
    context: &Bound<'py, Context>,
    scene: &Bound<'py, Scene>,
    lights: Vec<Py<Light>>,
    camera: Option<Bound<'py, Camera>>,
    points: Option<PyReadonlyArray2<'py, f64>>,
    normals: Option<PyReadonlyArray2<'py, f64>>,
    max_error: Option<f64>,
    max_ms: Option<f64>,
    error_norm: &str,
    confidence: Option<f64>,
    memory_limit: Option<u64>,
    standard_error: bool,
    receivers: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(VisibilityArrays<'py>, Option<String>)> {
    let (context, scene, lights) = (context.get().get()?, &scene.get().0, lights_of(&lights));
    let norm: ErrorNorm = error_norm
        .parse()
        .map_err(|_| settings_exception(format!("error_norm: 'rmse', 'p99' or 'max' expected, got '{error_norm}'")))?;
    let limit = match (max_error, max_ms) {
        (Some(error), None) => Limit::MaxError(error),
        (None, Some(ms)) => Limit::MaxMs(ms),
        _ => return Err(settings_exception("max_error, max_ms: give one of them".into())),
    };
    let goal = Goal { limit, norm, confidence: confidence.unwrap_or(softshadow::choose::CONFIDENCE) };
    let options = options(memory_limit, standard_error, receivers, false);
    let receivers = receivers_of(camera.as_ref(), points.as_ref(), normals.as_ref())?;
    let (result, reason) = detached_with_progress(py, progress, |on_progress| {
        match softshadow::visibility_within(context, scene, &lights, &receivers, &goal, &options, on_progress) {
            Ok(result) => Ok((result, None)),
            Err(Error::BoundNotMet(unmet)) => Ok((unmet.best, Some(unmet.reason))),
            Err(error) => Err(error),
        }
    })?;
    Ok((VisibilityArrays::new(py, result)?, reason))
}

/// Where calibrations of devices are kept; nothing where they are not.
#[pyfunction]
pub(crate) fn cache_folder() -> Option<std::path::PathBuf> {
    softshadow::choose::calibration::cache_folder()
}

/// A picture of the scene under its lights.
#[pyfunction]
#[pyo3(signature = (context, scene, lights, *, camera, technique, shading, exposure, background, memory_limit, progress))]
#[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
pub(crate) fn render<'py>(
    py: Python<'py>,
    context: &Bound<'py, Context>,
    scene: &Bound<'py, Scene>,
    lights: Vec<Py<Light>>,
    camera: &Bound<'py, Camera>,
    technique: &str,
    shading: &str,
    exposure: f32,
    background: Option<[f32; 3]>,
    memory_limit: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PictureArrays<'py>> {
    let (context, scene, lights) = (context.get().get()?, &scene.get().0, lights_of(&lights));
    let (camera, technique) = (camera.get().0, parse_technique(technique)?);
    let default = PictureOptions::default();
    let options = PictureOptions {
        shading: shading_of(shading)?,
        exposure,
        background: background.unwrap_or(default.background),
        options: options(memory_limit, default.options.standard_error, default.options.receivers, false),
    };
    let (picture, srgb) = detached_with_progress(py, progress, |on_progress| {
        let picture = softshadow::render(context, scene, &lights, &camera, &technique, &options, on_progress)?;
        let srgb = picture.srgb8();
        Ok((picture, srgb))
    })?;
    Ok(PictureArrays {
        linear: picture.linear.into_flattened().into_pyarray(py),
        srgb: srgb.into_pyarray(py),
        visibility: VisibilityArrays::new(py, picture.visibility)?,
    })
}

fn shading_of(name: &str) -> PyResult<Shading> {
    match name {
        "integrated" => Ok(Shading::Integrated),
        "modulated" => Ok(Shading::Modulated),
        _ => Err(internal_exception(format!("unknown shading '{name}'"))),
    }
}
