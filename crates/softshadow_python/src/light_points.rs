//! Where the samples of a light lie.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use softshadow::{LightSampling, SamplePattern, SampleSpread};

use crate::arrays::rows;
use crate::detached::detached;
use crate::errors::settings_exception;
use crate::light::Light;
use crate::scene::Scene;

#[derive(IntoPyObject)]
pub(crate) struct LightPointArrays<'py> {
    parameters: Bound<'py, PyArray1<f32>>,
    positions: Bound<'py, PyArray1<f64>>,
    rows: usize,
    at_infinity: bool,
}

/// The samples of a light, for comparison sample by sample.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "what decides who takes which sample")]
pub(crate) fn light_points<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    light: &Bound<'py, Light>,
    pattern: &str,
    count: u32,
    seed: u32,
    spread: &str,
    tile: u32,
    receivers: PyReadonlyArray2<'py, f64>,
    image_width: u32,
) -> PyResult<LightPointArrays<'py>> {
    let pattern = match pattern {
        "stratified" => SamplePattern::Stratified,
        "low_discrepancy" => SamplePattern::LowDiscrepancy,
        _ => return Err(settings_exception(format!("unknown pattern '{pattern}'"))),
    };
    let spread = match spread {
        "correlated" => SampleSpread::Correlated,
        "decorrelated" => SampleSpread::Decorrelated,
        "interleaved" => SampleSpread::Interleaved,
        _ => return Err(settings_exception(format!("unknown spread '{spread}'"))),
    };
    let sampling = LightSampling { pattern, count, seed, spread, tile };
    let (scene, light, receivers) = (&scene.get().0, &light.get().0, rows::<f64, 3>(&receivers)?);
    let points = detached(py, || softshadow::light_points(scene, light, &sampling, &receivers, image_width))?;
    Ok(LightPointArrays {
        parameters: points.parameters.into_flattened().into_pyarray(py),
        positions: points.positions.into_flattened().into_pyarray(py),
        rows: points.rows,
        at_infinity: points.at_infinity,
    })
}
