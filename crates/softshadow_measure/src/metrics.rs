//! The error of a visibility image against a reference.
//!
//! Averages hide what the eye and the physicist see, so the report also says where the error sits (penumbra), which way it
//! leans (bias), whether light leaks into the umbra or shadow on to lit ground, and how large the gross defects are.

use serde::Serialize;

use std::collections::VecDeque;
use std::fmt;

use crate::MeasureError;
use crate::structure::{Structure, structure};

/// Reference visibility up to which a pixel is umbra; from 1 minus it a pixel is lit; in between it is penumbra.
pub const UMBRA_LIMIT: f32 = 0.002;
/// An error that is visible at 8 bits.
pub const VISIBLE_ERROR: f64 = 1.0 / 255.0;
/// An umbra pixel above this leaks; a lit pixel below 1 minus it is falsely shadowed.
pub const CONFUSION_LIMIT: f32 = 0.05;
/// An error above this is gross.
pub const GROSS_ERROR: f64 = 0.25;

/// Errors `estimate − reference` over one set of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RegionError {
    /// Pixels in the set, at least 1.
    pub count: usize,
    /// Root mean square error.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// 95th percentile of the absolute error, by nearest rank.
    pub p95: f64,
    /// 99th percentile of the absolute error, by nearest rank.
    pub p99: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Mean signed error: negative is too dark.
    pub bias: f64,
}

impl RegionError {
    fn of(errors: &[f64]) -> Option<Self> {
        if errors.is_empty() {
            return None;
        }
        let mean = |f: fn(f64) -> f64| errors.iter().map(|&error| f(error)).sum::<f64>() / errors.len() as f64;
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let percentile = |percent: usize| sizes[(sizes.len() * percent).div_ceil(100).max(1) - 1];
        Some(Self {
            count: errors.len(),
            rmse: mean(|error| error * error).sqrt(),
            mae: mean(f64::abs),
            p95: percentile(95),
            p99: percentile(99),
            max: percentile(100),
            bias: mean(|error| error),
        })
    }
}

/// Everything to say about one image. Sets without pixels are `None`, so that nothing measured never reads as no error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorReport {
    /// All valid pixels.
    pub overall: Option<RegionError>,
    /// Pixels with 0.002 < V_ref < 0.998.
    pub penumbra: Option<RegionError>,
    /// The penumbra, and every other pixel whose error exceeds 1/255.
    pub penumbra_or_wrong: Option<RegionError>,
    /// Fraction of the true umbra (V_ref <= 0.002) that is reported above 0.05.
    pub leak_fraction: Option<f64>,
    /// Fraction of the truly lit pixels (V_ref >= 0.998) that is reported below 0.95.
    pub false_shadow_fraction: Option<f64>,
    /// Pixels with |error| > 0.25.
    pub gross_count: usize,
    /// Size of the largest 4-connected group of those; `None` without a width.
    pub largest_gross_component: Option<usize>,
    /// Mean standard error of the reference in the penumbra; `None` when none was given. A difference below about twice
    /// this is not distinguishable from the reference's own noise.
    pub penumbra_reference_se: Option<f64>,
    /// What neighbouring pixels say; `None` without a width.
    pub structure: Option<Structure>,
}

/// A visibility image to measure against.
#[derive(Debug, Clone, Copy)]
pub struct ReferenceImage<'a> {
    /// Visibility in [0, 1], row-major; NaN where there is no receiver.
    pub visibility: &'a [f32],
    /// Its standard error, pixel by pixel, ignored where the visibility is NaN.
    pub standard_error: Option<&'a [f32]>,
    /// Pixels a row, for the size of connected defects; `None` when the pixels form no image.
    pub width: Option<usize>,
}

impl ReferenceImage<'_> {
    fn check(&self, estimate: &[f32]) -> Result<(), MeasureError> {
        let expected = self.visibility.len();
        let same_length = |what, found| {
            let mismatch = MeasureError::LengthMismatch { what, expected, found };
            (found == expected).then_some(()).ok_or(mismatch)
        };
        same_length("the estimate", estimate.len())?;
        if let Some(errors) = self.standard_error {
            same_length("the reference's standard error", errors.len())?;
        }
        if self.width.is_some_and(|width| width == 0 && expected > 0 || width > 0 && !expected.is_multiple_of(width)) {
            return Err(MeasureError::Degenerate {
                why: "the pixels are not a whole number of rows of the given width",
            });
        }
        for (index, (&value, &truth)) in estimate.iter().zip(self.visibility).enumerate() {
            if value.is_nan() != truth.is_nan() {
                return Err(MeasureError::ValidityMismatch { index });
            }
            if value.is_infinite() {
                let what = "estimate pixel";
                return Err(MeasureError::NotFinite { what, index });
            }
            let error = self.standard_error.map_or(0.0, |errors| errors[index]);
            let trusted = (0.0..=1.0).contains(&truth) && (0.0..=f32::MAX).contains(&error);
            if !truth.is_nan() && !trusted {
                return Err(MeasureError::NotAReference { index });
            }
        }
        Ok(())
    }
}

/// Compares visibilities with a reference; pixels that are NaN in both are left out.
///
/// Estimates outside [0, 1] are legal and count with their full error.
///
/// # Errors
/// `LengthMismatch`, `ValidityMismatch`, `NotFinite` (infinite estimate), `NotAReference`, `Degenerate` (width).
pub fn compare(estimate: &[f32], reference: &ReferenceImage<'_>) -> Result<ErrorReport, MeasureError> {
    reference.check(estimate)?;
    let truth = reference.visibility;
    let errors: Vec<f64> =
        estimate.iter().zip(truth).map(|(&value, &truth)| f64::from(value) - f64::from(truth)).collect();
    // Every comparison with NaN is false, so a pixel without a receiver belongs to none of these sets.
    let valid = |pixel: usize| !truth[pixel].is_nan();
    let in_umbra = |pixel: usize| truth[pixel] <= UMBRA_LIMIT;
    let lit = |pixel: usize| truth[pixel] >= 1.0 - UMBRA_LIMIT;
    let in_penumbra = |pixel: usize| valid(pixel) && !in_umbra(pixel) && !lit(pixel);
    let select =
        |member: &dyn Fn(usize) -> bool| -> Vec<usize> { (0..truth.len()).filter(|&pixel| member(pixel)).collect() };
    let region = |member: &dyn Fn(usize) -> bool| {
        let chosen: Vec<f64> = select(member).iter().map(|&pixel| errors[pixel]).collect();
        RegionError::of(&chosen)
    };
    let penumbra = select(&in_penumbra);
    let gross: Vec<bool> = errors.iter().map(|error| error.abs() > GROSS_ERROR).collect();
    Ok(ErrorReport {
        overall: region(&valid),
        penumbra: region(&in_penumbra),
        penumbra_or_wrong: region(&|pixel| in_penumbra(pixel) || errors[pixel].abs() > VISIBLE_ERROR),
        leak_fraction: fraction(&select(&in_umbra), |pixel| estimate[pixel] > CONFUSION_LIMIT),
        false_shadow_fraction: fraction(&select(&lit), |pixel| estimate[pixel] < 1.0 - CONFUSION_LIMIT),
        gross_count: gross.iter().filter(|is_gross| **is_gross).count(),
        largest_gross_component: reference.width.map(|width| largest_component(&gross, width)),
        penumbra_reference_se: reference.standard_error.filter(|_| !penumbra.is_empty()).map(|se| {
            let sum: f64 = penumbra.iter().map(|&pixel| f64::from(se[pixel])).sum();
            sum / penumbra.len() as f64
        }),
        structure: reference.width.and_then(|width| structure(estimate, truth, width)),
    })
}

/// Where the error against the truth lies, given that against a reference whose own error has the root mean square
/// `standard_error` over the same pixels: both norms differ by the reference's at most, whatever the errors have in common, and two
/// standard errors leave it room. Holds for root mean square and mean absolute errors.
#[must_use]
pub fn true_error_interval(measured: f64, standard_error: f64) -> [f64; 2] {
    let room = 2.0 * standard_error;
    [(measured - room).max(0.0), measured + room]
}

fn fraction(pixels: &[usize], holds: impl Fn(usize) -> bool) -> Option<f64> {
    let count = pixels.iter().filter(|&&pixel| holds(pixel)).count();
    (!pixels.is_empty()).then(|| count as f64 / pixels.len() as f64)
}

/// Size of the largest group of marked pixels that touch along sides.
fn largest_component(marked: &[bool], width: usize) -> usize {
    let mut pending = marked.to_vec();
    let mut largest = 0;
    for start in 0..marked.len() {
        let mut size = 0;
        let mut queue = VecDeque::from([start]);
        while let Some(pixel) = queue.pop_front() {
            if !std::mem::take(&mut pending[pixel]) {
                continue;
            }
            size += 1;
            let column = pixel % width;
            queue.extend((column > 0).then(|| pixel - 1));
            queue.extend((column + 1 < width).then_some(pixel + 1));
            queue.extend(pixel.checked_sub(width));
            queue.extend(Some(pixel + width).filter(|below| *below < marked.len()));
        }
        largest = largest.max(size);
    }
    largest
}

impl fmt::Display for ErrorReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "{:<18}{:>9}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}",
            "pixels", "count", "rmse", "mae", "p95", "p99", "max", "bias"
        )?;
        let regions =
            [("all", self.overall), ("penumbra", self.penumbra), ("penumbra or wrong", self.penumbra_or_wrong)];
        for (name, region) in regions {
            match region {
                None => writeln!(out, "{name:<18}{:>9}", 0)?,
                Some(r) => writeln!(
                    out,
                    "{name:<18}{:>9}{:>10.5}{:>10.5}{:>10.5}{:>10.5}{:>10.5}{:>+10.5}",
                    r.count, r.rmse, r.mae, r.p95, r.p99, r.max, r.bias
                )?,
            }
        }
        let or_none = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.5}"));
        writeln!(
            out,
            "leaks {}   false shadow {}   gross {} (largest group {})   reference SE {}",
            or_none(self.leak_fraction),
            or_none(self.false_shadow_fraction),
            self.gross_count,
            self.largest_gross_component.map_or("-".into(), |size| size.to_string()),
            or_none(self.penumbra_reference_se),
        )
    }
}
