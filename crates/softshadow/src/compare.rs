//! `compare`: what each technique costs and how far it is from a reference, on the same receivers.

use serde::Serialize;
use softshadow_measure::metrics::{self, ErrorReport};
use softshadow_scene::{Light, Receivers, Scene};
use softshadow_techniques::Technique;

use crate::Progress;
use crate::context::Context;
use crate::error::Error;
use crate::info::Info;
use crate::visibility::{Options, Visibility, run};

/// Techniques beside a reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What made the reference.
    pub reference: Info,
    /// Root mean square of the reference's own standard error over the penumbra.
    pub reference_standard_error: Option<f64>,
    /// One row a technique, in the caller's order.
    pub rows: Vec<ComparisonRow>,
}

/// One technique.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// The technique and its settings.
    pub technique: Technique,
    /// Median wall time in milliseconds.
    pub median_ms: f64,
    /// Fastest and slowest run.
    pub range_ms: [f64; 2],
    /// Bytes on the device.
    pub bytes: u64,
    /// How far it is from the reference: over the penumbra, over everything, and what is confused.
    #[serde(flatten)]
    pub errors: ErrorReport,
}

/// Compares techniques with a reference, on one device that serves all of them; each runs once to warm up and `repeats` times, taking turns.
///
/// # Errors
/// Any [`Error`].
#[expect(clippy::too_many_arguments, reason = "a comparison names its scene, light, receivers and both sides")]
pub fn compare(
    context: &Context,
    scene: &Scene,
    light: &Light,
    receivers: &Receivers,
    techniques: &[Technique],
    reference: &Technique,
    repeats: u32,
    on_progress: Progress<'_>,
) -> Result<Comparison, Error> {
    if repeats == 0 {
        return Err(Error::Settings("compare repeats: must be at least 1".into()));
    }
    let lights = std::slice::from_ref(light);
    let device = context.device(techniques.iter().chain([reference]))?;
    let total = 1 + techniques.len() as u64 * (u64::from(repeats) + 1);
    let mut done = 0;
    let mut one = |technique: &Technique, standard_error: bool| {
        let options = Options { standard_error, ..Options::default() };
        let mut go_on = |_, _| on_progress(done, total);
        let (result, _) = run(device, scene, lights, receivers, technique, &options, None, &mut go_on)?;
        done += 1;
        if !on_progress(done, total) {
            return Err(Error::Interrupted);
        }
        Ok::<Visibility, Error>(result)
    };
    let truth = one(reference, true)?;
    let mut results = techniques.iter().map(|t| one(t, false)).collect::<Result<Vec<_>, _>>()?;
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); techniques.len()];
    for _ in 0..repeats {
        for (index, technique) in techniques.iter().enumerate() {
            results[index] = one(technique, false)?;
            times[index].push(results[index].info.wall_ms);
        }
    }
    let mut rows = Vec::with_capacity(techniques.len());
    for ((technique, result), times) in techniques.iter().zip(&results).zip(&mut times) {
        let image = metrics::ReferenceImage {
            visibility: &truth.values,
            standard_error: truth.standard_error.as_deref(),
            width: truth.image.filter(|_| truth.channels == 1).map(|[width, _]| width as usize),
        };
        let report = metrics::compare(&result.values, &image).map_err(|error| Error::Measure(error.to_string()))?;
        rows.push(row(technique, result, times, report));
    }
    Ok(Comparison { reference_standard_error: truth.info.standard_error, reference: truth.info, rows })
}

fn row(technique: &Technique, result: &Visibility, times: &mut [f64], errors: ErrorReport) -> ComparisonRow {
    times.sort_by(f64::total_cmp);
    ComparisonRow {
        technique: technique.clone(),
        median_ms: times[times.len() / 2],
        range_ms: [times[0], times[times.len() - 1]],
        bytes: result.info.bytes.iter().map(|(_, bytes)| bytes).sum(),
        errors,
    }
}
