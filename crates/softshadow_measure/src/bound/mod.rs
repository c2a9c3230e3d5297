//! The error of a result from receivers drawn at random and traced: an estimate, and a bound with its confidence.
//!
//! **The population** is the result itself: one value a receiver, computed and fixed. Nothing is assumed about how it came about, so it
//! does not matter that receivers share light samples and err together. Chance enters by which receivers are drawn, and by the noise of
//! their references, which must be independent from receiver to receiver and have an unbiased standard error.
//!
//! **Where errors count**: over the penumbra, and wherever else a receiver is wrong by more than 1/255 ([`crate::ErrorReport`]'s
//! `penumbra_or_wrong`). Over all receivers an error would vanish behind ground that is trivially lit.
//!
//! **Strata.** Receivers are drawn in strata, such as those that the result puts into the penumbra and the rest; each drawn one stands for
//! `size / drawn` of them.
//!
//! **Noise of the reference** adds its variance to every squared error, and is taken off again; for percentiles a receiver counts as beyond
//! a limit when it may be.
//!
//! | norm | bound | what it is not |
//! |---|---|---|
//! | root mean square | of a ratio of weighted sums, by linearisation; its law is taken for a gamma law of the same mean and variance, which for normal errors is exact, and the largest error found for one that was missed | free of assumptions: a defect in fewer receivers than [`ErrorBound::unseen_share`] may not be among those drawn; where 1 error in 50 is ten times as large, 95 % from 400 receivers are 91 % |
//! | 99th percentile | of the share beyond a limit: Clopper and Pearson 1934 with the effective number of receivers (Korn and Graubard 1998), whatever the law | a statement about the worst per cent |
//! | largest | none: no number of drawn receivers bounds the largest error of the others. The share beyond a limit is bounded instead | |

mod quantiles;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::metrics::{ErrorReport, UMBRA_LIMIT, VISIBLE_ERROR};
use crate::{MeasureError, error::require_finite};
pub use quantiles::{chi_square_quantile, normal_quantile, share_upper_bound};

/// Which errors one number stands for, over the penumbra and whatever else is wrong.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ErrorNorm {
    /// Root mean square error.
    #[default]
    Rmse,
    /// The absolute error that one receiver of a hundred exceeds.
    P99,
    /// The largest absolute error.
    Max,
}

impl ErrorNorm {
    /// This norm of a comparison; 0 where nothing is in the penumbra and nothing wrong.
    #[must_use]
    pub fn of(self, report: &ErrorReport) -> f64 {
        let Some(region) = report.penumbra_or_wrong else { return 0.0 };
        match self {
            Self::Rmse => region.rmse,
            Self::P99 => region.p99,
            Self::Max => region.max,
        }
    }
}

impl fmt::Display for ErrorNorm {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Rmse => "rmse",
            Self::P99 => "p99",
            Self::Max => "max",
        })
    }
}

impl FromStr for ErrorNorm {
    type Err = MeasureError;

    fn from_str(text: &str) -> Result<Self, MeasureError> {
        let found = [Self::Rmse, Self::P99, Self::Max].into_iter().find(|norm| norm.to_string() == text);
        found.ok_or(MeasureError::Degenerate { why: "an error norm is 'rmse', 'p99' or 'max'" })
    }
}

/// A receiver that was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// What the result says.
    pub value: f64,
    /// What its reference says.
    pub reference: f64,
    /// The reference's own standard error; its square must be unbiased.
    pub standard_error: f64,
}

impl Drawn {
    fn error(&self) -> f64 {
        self.value - self.reference
    }

    /// Whether its error counts.
    fn counts(&self) -> bool {
        let limit = f64::from(UMBRA_LIMIT);
        (limit..=1.0 - limit).contains(&self.reference) || self.error().abs() > VISIBLE_ERROR
    }

    /// Whether its error may be beyond a limit.
    fn may_exceed(&self, limit: f64) -> bool {
        self.error().abs() + 2.0 * self.standard_error > limit
    }
}

/// Receivers drawn at random from a part of the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Stratum {
    /// Receivers in that part.
    pub size: usize,
    /// Those drawn, without replacement.
    pub drawn: Vec<Drawn>,
}

impl Stratum {
    fn weight(&self) -> f64 {
        self.size as f64 / self.drawn.len().max(1) as f64
    }
}

/// What drawn receivers say about the error of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorBound {
    /// The norm, estimated, without the reference's own noise.
    pub estimate: f64,
    /// What the norm does not exceed with this confidence; `None` where nothing bounds it.
    pub upper: Option<f64>,
    /// Of `upper` and of `exceeding_share`.
    pub confidence: f64,
    /// Drawn receivers whose error counts.
    pub receivers: usize,
    /// A share of the receivers that count which the share beyond `limit` does not exceed with this confidence.
    pub exceeding_share: f64,
    /// A share of all receivers that may be wrong by any amount and still, with a probability of 1 − `confidence`, be missed.
    pub unseen_share: f64,
    /// Root mean square of the references' standard errors.
    pub reference_standard_error: f64,
}

/// Bounds the error of a result from receivers drawn in strata. `limit` is what `exceeding_share` is about.
///
/// # Errors
/// `TooFew` where a part with receivers has fewer than two drawn, or more drawn than it has; `NotFinite`; `Degenerate` for a confidence
/// outside of 0 to 1.
pub fn bound_error(
    norm: ErrorNorm,
    strata: &[Stratum],
    limit: f64,
    confidence: f64,
) -> Result<ErrorBound, MeasureError> {
    check(strata, confidence)?;
    let strata: Vec<&Stratum> = strata.iter().filter(|stratum| stratum.size > 0).collect();
    let risk = 1.0 - confidence;
    let counted = || strata.iter().flat_map(|s| s.drawn.iter().filter(|d| d.counts()).map(|d| (s.weight(), d)));
    let whole: f64 = strata.iter().map(|s| s.size as f64).sum();
    let unseen = |s: &&Stratum| {
        let is_census = s.drawn.len() == s.size;
        if is_census { 0.0 } else { s.size as f64 / whole * share_upper_bound(0.0, s.drawn.len() as f64, confidence) }
    };
    let receivers = counted().count();
    let weights: f64 = counted().map(|(weight, _)| weight).sum();
    let squares: f64 = counted().map(|(weight, _)| weight * weight).sum();
    let mut found = ErrorBound {
        estimate: 0.0,
        upper: (norm != ErrorNorm::Max).then_some(0.0),
        confidence,
        receivers,
        exceeding_share: 0.0,
        unseen_share: strata.iter().map(unseen).fold(0.0, f64::max),
        reference_standard_error: 0.0,
    };
    if receivers == 0 {
        return Ok(found);
    }
    let mean = |of: &dyn Fn(&Drawn) -> f64| counted().map(|(weight, d)| weight * of(d)).sum::<f64>() / weights;
    let noise = mean(&|d| d.standard_error * d.standard_error);
    found.reference_standard_error = noise.sqrt();
    // Who draws nearly all leaves little to chance.
    let left = (1.0 - receivers as f64 / weights).max(f64::MIN_POSITIVE);
    let effective = weights * weights / squares / left;
    let is_census = strata.iter().all(|s| s.drawn.len() == s.size);
    let share_beyond = |limit: f64| {
        let share = mean(&|d| f64::from(u8::from(d.may_exceed(limit))));
        if is_census { share } else { share_upper_bound(share * effective, effective, confidence) }
    };
    found.exceeding_share = share_beyond(limit);
    match norm {
        ErrorNorm::Rmse => {
            let square = |d: &Drawn| d.error() * d.error() - d.standard_error * d.standard_error;
            let ratio = mean(&square);
            found.estimate = ratio.max(0.0).sqrt();
            // Squares of rare gross errors are so skewed that a draw with too few of them looks sure of itself, too: the largest is taken for
            // one that was missed.
            let largest = counted().map(|(weight, d)| weight * square(d)).fold(0.0, f64::max);
            let missed = if is_census { 0.0 } else { largest / weights };
            let variance = variance_of_ratio(&strata, square, ratio, weights);
            found.upper = Some(mean_upper_bound(ratio + missed, variance, risk).sqrt());
        }
        ErrorNorm::P99 => {
            let mut sizes: Vec<(f64, f64)> = counted().map(|(weight, d)| (d.error().abs(), weight)).collect();
            sizes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let mut below = 0.0;
            let rank = sizes.iter().find(|(_, weight)| {
                below += weight;
                below >= 0.99 * weights
            });
            found.estimate = rank.map_or(0.0, |(size, _)| *size);
            let mut limits: Vec<f64> = counted().map(|(_, d)| d.error().abs() + 2.0 * d.standard_error).collect();
            limits.sort_unstable_by(f64::total_cmp);
            // The share falls as the limit rises.
            let first = limits.partition_point(|&limit| share_beyond(limit) > 0.01);
            found.upper = limits.get(first).copied();
        }
        ErrorNorm::Max => found.estimate = counted().map(|(_, d)| d.error().abs()).fold(0.0, f64::max),
    }
    Ok(found)
}

fn check(strata: &[Stratum], confidence: f64) -> Result<(), MeasureError> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(MeasureError::Degenerate { why: "a confidence lies between 0 and 1, without them" });
    }
    for stratum in strata {
        let enough = 2.min(stratum.size);
        if stratum.drawn.len() < enough {
            return Err(MeasureError::TooFew { what: "receivers drawn from a stratum", minimum: enough });
        }
        if stratum.drawn.len() > stratum.size {
            return Err(MeasureError::TooFew { what: "receivers of a stratum", minimum: stratum.drawn.len() });
        }
        for (index, drawn) in stratum.drawn.iter().enumerate() {
            require_finite("drawn receiver", index, &[drawn.value, drawn.reference, drawn.standard_error])?;
        }
    }
    Ok(())
}

/// Of Σ w·d·y / Σ w·d, where `d` says whether a receiver counts: that of the sum of the linearised residuals d·(y − ratio).
fn variance_of_ratio(strata: &[&Stratum], of: impl Fn(&Drawn) -> f64, ratio: f64, weights: f64) -> f64 {
    let of_stratum = |stratum: &&Stratum| {
        let residual = |d: &Drawn| if d.counts() { of(d) - ratio } else { 0.0 };
        let count = stratum.drawn.len() as f64;
        let mean = stratum.drawn.iter().map(residual).sum::<f64>() / count;
        let spread: f64 = stratum.drawn.iter().map(|d| (residual(d) - mean).powi(2)).sum();
        // What is drawn whole does not vary by drawing.
        let left = 1.0 - count / stratum.size as f64;
        if count < 2.0 { 0.0 } else { (stratum.size as f64).powi(2) * left * spread / (count - 1.0) / count }
    };
    strata.iter().map(of_stratum).sum::<f64>() / (weights * weights)
}

/// Of a mean that is not negative, from its estimate and its variance: by a gamma law, and no lower than by a normal one.
fn mean_upper_bound(mean: f64, variance: f64, risk: f64) -> f64 {
    let by_normal = mean.max(0.0) + normal_quantile(1.0 - risk) * variance.sqrt();
    if mean <= 0.0 || variance <= 0.0 {
        return by_normal;
    }
    let freedom = 2.0 * mean * mean / variance;
    by_normal.max(mean * freedom / chi_square_quantile(risk, freedom))
}
