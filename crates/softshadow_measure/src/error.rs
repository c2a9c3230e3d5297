//! What can be wrong with an input, said once for the whole crate.

/// Why an oracle, a tracer or a metric declined its input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeasureError {
    /// A number is NaN, infinite or larger than any float32.
    #[error("{what} {index} holds a number that no finite float32 can hold")]
    NotFinite {
        /// The kind of input, for example "triangle".
        what: &'static str,
        /// Its position in the slice that was passed (0 for a single value).
        index: usize,
    },
    /// A size is zero or negative, a range is reversed, axes are not orthogonal.
    #[error("degenerate input: {why}")]
    Degenerate {
        /// What is degenerate about it.
        why: &'static str,
    },
    /// The input is fine, but this closed form says nothing about it.
    #[error("the closed form does not apply: {why}")]
    OutsideDomain {
        /// The assumption that does not hold.
        why: &'static str,
    },
    /// Two slices that describe the same pixels differ in length.
    #[error("{what} has {found} entries where {expected} are expected")]
    LengthMismatch {
        /// The slice at fault.
        what: &'static str,
        /// The length that the other slice has.
        expected: usize,
        /// The length that it has.
        found: usize,
    },
    /// A pixel is NaN (no receiver) in one image and a number in the other.
    #[error("pixel {index} is valid in one image and NaN in the other")]
    ValidityMismatch {
        /// Row-major index of the first such pixel.
        index: usize,
    },
    /// A reference visibility lies outside [0, 1], or its standard error is negative.
    #[error("reference pixel {index} is not a visibility in [0, 1] with a standard error >= 0")]
    NotAReference {
        /// Row-major index of the first such pixel.
        index: usize,
    },
    /// A count is too small for the statistic.
    #[error("{what} must be at least {minimum}")]
    TooFew {
        /// What is counted.
        what: &'static str,
        /// The smallest count that means something.
        minimum: usize,
    },
}

/// `Ok` when every component fits a finite float32; larger values would overflow the determinants that follow.
pub(crate) fn require_finite(what: &'static str, index: usize, values: &[f64]) -> Result<(), MeasureError> {
    let limit = f64::from(f32::MAX);
    if values.iter().all(|value| value.abs() <= limit) { Ok(()) } else { Err(MeasureError::NotFinite { what, index }) }
}
