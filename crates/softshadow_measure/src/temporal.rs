//! How steady a result is while a scene moves: flicker, and the largest jump from one frame to the next.
//!
//! What changes in the reference may change in the result. Counted is the change beyond that: the difference of the errors of two frames
//! that follow each other, for every receiver that is in the penumbra in either.

use serde::Serialize;

use crate::MeasureError;
use crate::metrics::UMBRA_LIMIT;

/// One frame: the same receivers in every frame, NaN where there is none.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// What is judged.
    pub values: &'a [f32],
    /// What is true.
    pub reference: &'a [f32],
    /// The reference's own standard error.
    pub standard_error: Option<&'a [f32]>,
}

/// Changes of the error over a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TemporalReport {
    /// Pairs of a receiver and two frames that follow each other.
    pub pairs: usize,
    /// Root mean square change of the error from a frame to the next.
    pub flicker: f64,
    /// The largest such change.
    pub largest_jump: f64,
    /// How much of `flicker` the references' own noise may be, where their standard errors are given: less is not distinguishable.
    pub reference_flicker: Option<f64>,
}

/// Measures a sweep; `None` where no receiver is ever in the penumbra.
///
/// # Errors
/// `TooFew` for less than two frames; `LengthMismatch`.
pub fn compare_frames(frames: &[Frame<'_>]) -> Result<Option<TemporalReport>, MeasureError> {
    if frames.len() < 2 {
        return Err(MeasureError::TooFew { what: "frames", minimum: 2 });
    }
    let expected = frames[0].reference.len();
    for frame in frames {
        let lengths = [Some(frame.values), Some(frame.reference), frame.standard_error];
        if let Some(found) = lengths.iter().flatten().map(|part| part.len()).find(|length| *length != expected) {
            return Err(MeasureError::LengthMismatch { what: "a frame", expected, found });
        }
    }
    let (mut pairs, mut sum, mut noise, mut largest_jump) = (0_usize, 0.0, 0.0, 0.0_f64);
    for pair in frames.windows(2) {
        for receiver in 0..expected {
            // Every comparison with NaN is false.
            let in_penumbra =
                |frame: &Frame<'_>| (UMBRA_LIMIT..=1.0 - UMBRA_LIMIT).contains(&frame.reference[receiver]);
            let [before, after] = [pair[0], pair[1]];
            let error = |frame: Frame<'_>| f64::from(frame.values[receiver]) - f64::from(frame.reference[receiver]);
            let change = error(after) - error(before);
            if !(in_penumbra(&before) || in_penumbra(&after)) || change.is_nan() {
                continue;
            }
            pairs += 1;
            sum += change * change;
            largest_jump = largest_jump.max(change.abs());
            for frame in [before, after] {
                noise += frame.standard_error.map_or(0.0, |errors| f64::from(errors[receiver]).powi(2));
            }
        }
    }
    let has_errors = frames.iter().all(|frame| frame.standard_error.is_some());
    let root_mean = |sum: f64| (sum / pairs as f64).sqrt();
    Ok((pairs > 0).then(|| TemporalReport {
        pairs,
        flicker: root_mean(sum),
        largest_jump,
        reference_flicker: has_errors.then(|| root_mean(noise)),
    }))
}
