//! `compare`: what each technique costs and how far it is from a reference, on the same receivers.

use serde::Serialize;
use softshadow_measure::metrics::{self, ErrorReport};
use softshadow_scene::{Light, LightShape, Receivers, Scene};
use softshadow_techniques::Technique;

use crate::Progress;
use crate::context::Context;
use crate::error::Error;
use crate::info::Info;
use crate::visibility::{Options, Visibility, run};

/// Techniques beside a reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Triangles of the scene as given.
    pub triangles: usize,
    /// The light by what growth is measured over.
    pub light: ComparedLight,
    /// `[width, height]` where a camera was given.
    pub size: Option<[u32; 2]>,
    /// 1, or 3 where the light has a texture.
    pub channels: usize,
    /// What made the reference.
    pub reference: Info,
    /// Root mean square of the reference's own standard error over the penumbra.
    pub reference_standard_error: Option<f64>,
    /// The reference itself: receivers × channels.
    #[serde(skip)]
    pub reference_values: Vec<f32>,
    /// One row a technique, in the caller's order.
    pub rows: Vec<ComparisonRow>,
}

/// How large a light is, as one number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ComparedLight {
    /// `rectangle`, `disc`, `sphere`, `polygon` or `sun`.
    pub shape: &'static str,
    /// Side of the square of the same area for rectangles and polygons, diameter of the others: in world units, of suns in degrees.
    pub extent: f64,
}

impl ComparedLight {
    fn of(shape: &LightShape) -> Self {
        let (shape, extent) = match shape {
            LightShape::Rectangle { width, height } => ("rectangle", (width * height).sqrt()),
            LightShape::Disc { radius } => ("disc", 2.0 * radius),
            LightShape::Sphere { radius } => ("sphere", 2.0 * radius),
            LightShape::Polygon { outline } => {
                let next = outline.iter().cycle().skip(1);
                let twice: f64 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
                ("polygon", (twice.abs() / 2.0).sqrt())
            }
            LightShape::Sun { angular_diameter } => ("sun", angular_diameter.to_degrees()),
        };
        Self { shape, extent }
    }
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
    /// Every run, in the order of the turns.
    pub times_ms: Vec<f64>,
    /// Bytes on the device.
    pub bytes: u64,
    /// Bytes by resource.
    pub bytes_by_resource: Vec<(String, u64)>,
    /// What the result does not model, and settings that could not be followed.
    pub notes: Vec<String>,
    /// Where the root mean square error in the penumbra lies against the truth, as far as the reference's own standard error lets that
    /// be said; see [`metrics::true_error_interval`].
    pub penumbra_rmse_interval: Option<[f64; 2]>,
    /// How far it is from the reference: over the penumbra, over everything, and what is confused.
    #[serde(flatten)]
    pub errors: ErrorReport,
    /// Its visibility in the last run: receivers × channels.
    #[serde(skip)]
    pub values: Vec<f32>,
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
    let image = metrics::ReferenceImage {
        visibility: &truth.values,
        standard_error: truth.standard_error.as_deref(),
        width: truth.image.filter(|_| truth.channels == 1).map(|[width, _]| width as usize),
    };
    let rows = techniques.iter().zip(results).zip(times).map(|((technique, result), times)| {
        let report = metrics::compare(&result.values, &image).map_err(|error| Error::Measure(error.to_string()))?;
        Ok::<ComparisonRow, Error>(row(technique, result, times, report, truth.info.standard_error))
    });
    Ok(Comparison {
        rows: rows.collect::<Result<_, _>>()?,
        triangles: scene.triangle_count(),
        light: ComparedLight::of(light.shape()),
        size: truth.image,
        channels: truth.channels,
        reference_standard_error: truth.info.standard_error,
        reference: truth.info,
        reference_values: truth.values,
    })
}

fn row(
    technique: &Technique,
    result: Visibility,
    times: Vec<f64>,
    errors: ErrorReport,
    standard_error: Option<f64>,
) -> ComparisonRow {
    let mut sorted = times.clone();
    sorted.sort_by(f64::total_cmp);
    let (middle, last) = (sorted.len() / 2, sorted.len() - 1);
    ComparisonRow {
        technique: technique.clone(),
        // The mean of both in the middle, where there are two.
        median_ms: (sorted[middle] + sorted[last - middle]) / 2.0,
        range_ms: [sorted[0], sorted[last]],
        times_ms: times,
        bytes: result.info.bytes.iter().map(|(_, bytes)| bytes).sum(),
        bytes_by_resource: result.info.bytes,
        notes: result.info.notes,
        penumbra_rmse_interval: errors
            .penumbra
            .zip(standard_error)
            .map(|(region, standard_error)| metrics::true_error_interval(region.rmse, standard_error)),
        errors,
        values: result.values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_have_one_extent() {
        let square = vec![[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]];
        for (shape, name, extent) in [
            (LightShape::Rectangle { width: 4.0, height: 1.0 }, "rectangle", 2.0),
            (LightShape::Polygon { outline: square }, "polygon", 2.0),
            (LightShape::Disc { radius: 1.5 }, "disc", 3.0),
            (LightShape::Sphere { radius: 0.5 }, "sphere", 1.0),
            (LightShape::Sun { angular_diameter: 0.5_f64.to_radians() }, "sun", 0.5),
        ] {
            let found = ComparedLight::of(&shape);
            assert!(found.shape == name && (found.extent - extent).abs() < 1e-12, "{found:?}");
        }
    }
}
