//! Defects of an image that no average of single pixels tells apart: steps where the truth slopes, edges that are none, and an image that
//! lies beside its place.

use serde::Serialize;

use crate::metrics::UMBRA_LIMIT;

/// What neighbours say.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Structure {
    /// The largest difference of the steps from a pixel to its right or lower neighbour.
    pub gradient_error_max: f64,
    /// The share of neighbours in the penumbra between which the estimate is constant and the reference is not.
    pub banding_fraction: f64,
    /// The shift in pixels, right and down, by which the estimate fits the reference best; `[0, 0]` unless that halves the squared error.
    pub shift: [i32; 2],
}

/// Pixels up to which a shift is looked for.
const REACH: i32 = 2;
/// A step of the reference below this may be its noise.
const STEP: f32 = 1e-3;

/// `None` where no two neighbours in the penumbra are there.
pub(crate) fn structure(estimate: &[f32], truth: &[f32], width: usize) -> Option<Structure> {
    let height = truth.len().checked_div(width)?;
    let inside = |pixel: usize| truth[pixel] > UMBRA_LIMIT && truth[pixel] < 1.0 - UMBRA_LIMIT;
    let neighbours = (0..truth.len()).flat_map(|pixel| {
        let right = (pixel % width + 1 < width).then_some(pixel + 1);
        let below = Some(pixel + width).filter(|below| *below < truth.len());
        [right, below].into_iter().flatten().map(move |other| (pixel, other))
    });
    let (mut pairs, mut flat, mut gradient_error_max) = (0_usize, 0_usize, 0.0_f64);
    for (a, b) in neighbours.filter(|(a, b)| inside(*a) && inside(*b)) {
        let (step, true_step) = (estimate[b] - estimate[a], truth[b] - truth[a]);
        pairs += usize::from(true_step.abs() > STEP);
        flat += usize::from(true_step.abs() > STEP && step == 0.0);
        gradient_error_max = gradient_error_max.max(f64::from((step - true_step).abs()));
    }
    let squared = |[right, down]: [i32; 2]| {
        let (mut sum, mut count) = (0.0, 0_usize);
        for y in REACH..height as i32 - REACH {
            for x in REACH..width as i32 - REACH {
                let (pixel, moved) =
                    ((y * width as i32 + x) as usize, ((y + down) * width as i32 + x + right) as usize);
                let error = f64::from(estimate[moved]) - f64::from(truth[pixel]);
                if !error.is_nan() {
                    (sum, count) = (sum + error * error, count + 1);
                }
            }
        }
        if count == 0 { f64::INFINITY } else { sum / count as f64 }
    };
    let shifts = (-REACH..=REACH).flat_map(|down| (-REACH..=REACH).map(move |right| [right, down]));
    let (mut shift, mut least) = ([0, 0], squared([0, 0]) / 2.0);
    if least.is_finite() {
        for candidate in shifts {
            let found = squared(candidate);
            if found < least {
                (shift, least) = (candidate, found);
            }
        }
    }
    (pairs > 0).then(|| Structure { gradient_error_max, banding_fraction: flat as f64 / pairs as f64, shift })
}
