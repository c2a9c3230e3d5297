//! `visibility_within`: the fastest technique and settings for an error, or the smallest error within a time, for one scene, its lights and
//! receivers.
//!
//! 1. **Candidates** are the settings that techniques list in rising quality ([`Technique::rising_quality`]).
//! 2. **Costs** are predicted from their plans and a calibration of the device ([`calibration`]), corrected by what the same scene has cost
//!    before.
//! 3. **A pilot** (`pilot`) lets one setting of each technique do a random part of the receivers: it says what this scene costs, and, where
//!    there is time for rays, how wrong the technique is here. Each part of it runs where all together are expected to take less than a third
//!    of the run that follows; else the choice is safe: among techniques whose error follows from their samples, with a larger margin.
//! 4. **The run.**
//! 5. **A check** (`check`): receivers drawn at random from the result itself are traced, each with samples of its own, and bound its
//!    error. Nothing that led to the choice enters here, so nothing has to be corrected for how many candidates there were; only checks
//!    that were not passed count, and share the risk: a half for the first, a half of the rest for the next, and so on.
//! 6. What is not confirmed is checked with more receivers where it looks right, else computed again by the next setting that should do.
//!
//! **Kinds.** `certified`: no receiver, or no error could be too large. `statistical`: the bound holds with the confidence that is
//! asked for, in the sense of [`softshadow_measure::bound`]. `measured`: an estimate without a promise, as of every largest error: the
//! share of receivers beyond the bound is what can be said of it.

pub mod calibration;
mod candidates;
mod check;
mod pilot;

use std::time::Instant;

use serde::Serialize;
use softshadow_measure::{ErrorBound, ErrorNorm};
use softshadow_scene::{Light, Receivers, Scene};
use softshadow_techniques::Technique;

use crate::Progress;
use crate::context::{Context, Device};
use crate::error::Error;
use crate::visibility::{Options, Visibility, run};
pub use candidates::Candidate;
use candidates::Candidates;

/// What is asked of a result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Goal {
    /// What must not be exceeded.
    pub limit: Limit,
    /// How the error is measured.
    pub norm: ErrorNorm,
    /// How sure a statistical bound is.
    pub confidence: f64,
}

/// What must not be exceeded, while the other is as small as it can be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The error of visibility.
    MaxError(f64),
    /// The wall time in milliseconds, pilot and check included.
    MaxMs(f64),
}

/// The confidence of statistical bounds where nobody says another.
pub const CONFIDENCE: f64 = 0.95;

impl Goal {
    /// An error that must not be exceeded.
    #[must_use]
    pub fn max_error(error: f64, norm: ErrorNorm) -> Self {
        Self { limit: Limit::MaxError(error), norm, confidence: CONFIDENCE }
    }

    /// A time that must not be exceeded.
    #[must_use]
    pub fn max_ms(ms: f64, norm: ErrorNorm) -> Self {
        Self { limit: Limit::MaxMs(ms), norm, confidence: CONFIDENCE }
    }

    fn check(&self) -> Result<(), Error> {
        let (name, value) = match self.limit {
            Limit::MaxError(error) => ("max_error", error),
            Limit::MaxMs(ms) => ("max_ms", ms),
        };
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::Settings(format!("{name}: must be positive and finite, got {value}")));
        }
        if !(0.5..1.0).contains(&self.confidence) {
            let confidence = self.confidence;
            return Err(Error::Settings(format!("confidence: must be at least 0.5 and below 1, got {confidence}")));
        }
        Ok(())
    }

    /// How much larger this norm is than the root mean square, for errors of samples.
    fn over_rmse(&self) -> f64 {
        // Measured with 64 samples: 2.7 to 2.9, and 4 to 6 in images of 512 × 512.
        match self.norm {
            ErrorNorm::Rmse => 1.0,
            ErrorNorm::P99 => 2.9,
            ErrorNorm::Max => 6.0,
        }
    }
}

/// How well an error is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorKind {
    /// Nothing can be wrong by more.
    Certified,
    /// With a confidence.
    Statistical,
    /// On the receivers that were drawn; nothing is promised about the others.
    Measured,
}

/// How a result was chosen, and how wrong it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// What was asked for.
    #[serde(flatten)]
    pub goal: Goal,
    /// Whether the result keeps it.
    pub met: bool,
    /// How well the error is known.
    pub kind: ErrorKind,
    /// The error: an estimate, a bound, and what they rest on; `None` where the error is certified.
    pub error: Option<ErrorBound>,
    /// What the chosen settings were expected to take.
    pub predicted_ms: f64,
    /// Milliseconds of the pilot, 0 where there was none.
    pub pilot_ms: f64,
    /// What the pilot did, or why there was none.
    pub pilot: String,
    /// Milliseconds of all checks.
    pub check_ms: f64,
    /// Receivers that were traced by all checks.
    pub checked_receivers: usize,
    /// Milliseconds of earlier runs that were not good enough.
    pub discarded_ms: f64,
    /// Every candidate, the fastest first, as it was seen last.
    pub candidates: Vec<Candidate>,
    /// Where the costs of this device come from.
    pub calibration: String,
}

/// The best there is where a goal is out of reach.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundNotMet {
    /// The result that comes closest; its `info.choice` says how close.
    pub best: Visibility,
    /// Why there is no better one.
    pub reason: String,
}

/// Margin between what a candidate is expected to err and the bound: a check must confirm it from few receivers.
const MARGIN: f64 = 1.15;
/// The same where no error was measured on this scene before.
const SAFE_MARGIN: f64 = 1.35;
/// Runs at most: each is chosen with what the one before has shown.
const MOST_RUNS: usize = 4;

/// Visibility by the fastest technique that keeps a bound of the error, or with the smallest error within a time.
///
/// `options.standard_error`, `receivers` and `timing` are those of the result; `sample_masks` cannot be had, for not every technique has them.
///
/// # Errors
/// [`Error::BoundNotMet`], with the best result attached; any other [`Error`].
pub fn visibility_within(
    context: &Context,
    scene: &Scene,
    lights: &[Light],
    receivers: &Receivers,
    goal: &Goal,
    options: &Options,
    on_progress: Progress<'_>,
) -> Result<Visibility, Error> {
    goal.check()?;
    if options.sample_masks {
        return Err(Error::Settings("sample_masks: a technique that is chosen may have none; name one".into()));
    }
    if lights.is_empty() {
        return Err(Error::Settings("at least one light is needed".into()));
    }
    let call = Call { device: context.device([])?, scene, lights, receivers, goal: *goal };
    if let Limit::MaxError(bound) = goal.limit {
        // A visibility lies between 0 and 1.
        if bound >= 1.0 || receivers.count() == 0 {
            return certified(&call, options, on_progress);
        }
    }
    Search::new(&call, on_progress)?.search(options, on_progress)
}

/// What is computed, and where.
struct Call<'a> {
    device: &'a Device,
    scene: &'a Scene,
    lights: &'a [Light],
    receivers: &'a Receivers,
    goal: Goal,
}

impl Call<'_> {
    fn run(
        &self,
        technique: &Technique,
        receivers: &Receivers,
        options: &Options,
        on_progress: Progress<'_>,
    ) -> Result<Visibility, Error> {
        Ok(run(self.device, self.scene, self.lights, receivers, technique, options, None, on_progress)?.0)
    }
}

/// Any settings do.
fn certified(call: &Call<'_>, options: &Options, on_progress: Progress<'_>) -> Result<Visibility, Error> {
    let candidates = Candidates::of(call)?;
    let technique = candidates.fastest().ok_or_else(candidates::none)?.technique.clone();
    let mut result = call.run(&technique, call.receivers, options, on_progress)?;
    result.info.error_kind = "certified";
    result.info.choice = Some(Box::new(Choice {
        goal: call.goal,
        met: true,
        kind: ErrorKind::Certified,
        error: None,
        predicted_ms: 0.0,
        pilot_ms: 0.0,
        pilot: "none: any settings do".into(),
        check_ms: 0.0,
        checked_receivers: 0,
        discarded_ms: 0.0,
        candidates: candidates.listed(),
        calibration: candidates.calibration.clone(),
    }));
    Ok(result)
}

struct Search<'a> {
    call: &'a Call<'a>,
    candidates: Candidates,
    started: Instant,
    pilot_ms: f64,
    pilot: String,
    check_ms: f64,
    checked_receivers: usize,
    discarded_ms: f64,
    /// Checks so far: each has half of the risk that is left.
    checks: i32,
    margin: f64,
}

impl<'a> Search<'a> {
    fn new(call: &'a Call<'a>, on_progress: Progress<'_>) -> Result<Self, Error> {
        let started = Instant::now();
        let mut candidates = Candidates::of(call)?;
        let began = Instant::now();
        let pilot = pilot::pilot(call, &mut candidates, on_progress)?;
        let margin = if pilot.has_errors { MARGIN } else { SAFE_MARGIN };
        let pilot_ms = if pilot.is_skipped { 0.0 } else { began.elapsed().as_secs_f64() * 1e3 };
        Ok(Self {
            call,
            candidates,
            started,
            pilot_ms,
            pilot: pilot.words,
            check_ms: 0.0,
            checked_receivers: 0,
            discarded_ms: 0.0,
            checks: 0,
            margin,
        })
    }

    fn search(mut self, options: &Options, on_progress: Progress<'_>) -> Result<Visibility, Error> {
        let mut best: Option<Visibility> = None;
        for _ in 0..MOST_RUNS {
            let (index, is_expected_to_do) = match (self.next(), &best) {
                (Some(index), _) => (index, true),
                // What is asked for is out of reach: the nearest to it is still worth something.
                (None, None) => (self.candidates.nearest(self.call.goal.limit).ok_or_else(candidates::none)?, false),
                (None, Some(_)) => break,
            };
            let result = match self.attempt(index, options, on_progress) {
                Ok(result) => result,
                // Silhouettes of a scene that is too dense for them, or too little memory: others may do.
                Err(error @ (Error::Gpu(_) | Error::TooLarge { .. } | Error::Settings(_))) => {
                    self.candidates.refuse(index, &error);
                    continue;
                }
                Err(error) => return Err(error),
            };
            let is_met = choice_of(&result).is_some_and(|choice| choice.met);
            if is_met {
                return Ok(result);
            }
            self.discarded_ms += result.info.wall_ms;
            best = Some(match best {
                Some(known) if upper(&known) <= upper(&result) => known,
                _ => result,
            });
            if !is_expected_to_do || matches!(self.call.goal.limit, Limit::MaxMs(_)) {
                break;
            }
        }
        let best = best.ok_or_else(candidates::none)?;
        let reason = self.reason(&best);
        Err(Error::BoundNotMet(Box::new(BoundNotMet { best, reason })))
    }

    /// The candidate to run next: one that should do.
    fn next(&self) -> Option<usize> {
        match self.call.goal.limit {
            Limit::MaxError(bound) => self.candidates.fastest_within(bound / self.margin),
            Limit::MaxMs(ms) => {
                // A check of its own takes about as much again as a twentieth of the run.
                let left = (ms - self.started.elapsed().as_secs_f64() * 1e3) / 1.1;
                self.candidates.best_within(left)
            }
        }
    }

    /// One run and its check.
    fn attempt(&mut self, index: usize, options: &Options, on_progress: Progress<'_>) -> Result<Visibility, Error> {
        let call = self.call;
        let candidate = &self.candidates.all[index];
        let (technique, predicted_ms) = (candidate.technique.clone(), candidate.predicted_ms);
        let with_receivers = Options { receivers: true, sample_masks: false, ..options.clone() };
        let mut result = call.run(&technique, call.receivers, &with_receivers, on_progress)?;
        self.candidates.learn(call, index, call.receivers, &result);
        let mut go_on = || on_progress(0, 1);
        let [mut size, large] = check::sizes(call.goal.norm);
        let (error, met) = loop {
            self.checks += 1;
            // Confidence of this check alone, so that the risks of all add up to at most that of the goal.
            let confidence = 1.0 - (1.0 - call.goal.confidence) / 2_f64.powi(self.checks);
            let began = Instant::now();
            let checked = check::check(call, &result, size, confidence, self.checks as u64, &mut go_on)?;
            self.check_ms += began.elapsed().as_secs_f64() * 1e3;
            self.checked_receivers += checked.traced;
            let Limit::MaxError(bound) = call.goal.limit else { break (checked.bound, true) };
            let met = match call.goal.norm {
                ErrorNorm::Max => checked.bound.estimate <= bound,
                ErrorNorm::Rmse | ErrorNorm::P99 => checked.bound.upper.is_some_and(|upper| upper <= bound),
            };
            let is_promising = call.goal.norm != ErrorNorm::Max && checked.bound.estimate < 0.97 * bound;
            if met || !is_promising || size == large || checked.is_all {
                break (checked.bound, met);
            }
            size = large;
        };
        self.candidates.measured(index, error.estimate);
        self.margin = MARGIN;
        let met = match call.goal.limit {
            Limit::MaxError(_) => met,
            Limit::MaxMs(ms) => self.started.elapsed().as_secs_f64() * 1e3 <= ms,
        };
        let kind = if error.upper.is_some() { ErrorKind::Statistical } else { ErrorKind::Measured };
        result.info.error_kind = if error.upper.is_some() { "statistical" } else { "measured" };
        // What the caller hears is the confidence of the whole search.
        let error = ErrorBound { confidence: call.goal.confidence, ..error };
        result.info.choice = Some(Box::new(Choice {
            goal: call.goal,
            met,
            kind,
            error: Some(error),
            predicted_ms,
            pilot_ms: self.pilot_ms,
            pilot: self.pilot.clone(),
            check_ms: self.check_ms,
            checked_receivers: self.checked_receivers,
            discarded_ms: self.discarded_ms,
            candidates: self.candidates.listed(),
            calibration: self.candidates.calibration.clone(),
        }));
        if !options.receivers {
            result.placed = None;
        }
        Ok(result)
    }

    fn reason(&self, best: &Visibility) -> String {
        let name = best.info.technique.name();
        let norm = self.call.goal.norm;
        match (self.call.goal.limit, choice_of(best).and_then(|choice| choice.error)) {
            (Limit::MaxError(bound), Some(error)) => {
                let upper = error.upper.map_or("no bound".into(), |upper| format!("at most {upper:.5}"));
                let estimate = error.estimate;
                format!("max_error {bound} ({norm}) is not confirmed: {name} has about {estimate:.5}, {upper}")
            }
            (Limit::MaxError(bound), None) => format!("max_error {bound} ({norm}) is not confirmed"),
            (Limit::MaxMs(ms), _) => {
                let took = self.started.elapsed().as_secs_f64() * 1e3;
                format!("max_ms {ms}: {name} and its check took {took:.1} ms")
            }
        }
    }
}

fn choice_of(result: &Visibility) -> Option<&Choice> {
    result.info.choice.as_deref()
}

fn upper(result: &Visibility) -> f64 {
    let error = choice_of(result).and_then(|choice| choice.error);
    error.map_or(f64::INFINITY, |error| error.upper.unwrap_or(error.estimate))
}
