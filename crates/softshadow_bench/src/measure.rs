//! Measuring: a warm-up, runs in which all cases take turns, then passes one by one.

use std::time::Instant;

use softshadow::measure::{self, ErrorReport, ReferenceImage};
use softshadow::{
    Context, Error, Info, Options, PassTime, PictureOptions, Receivers, Timing, Visibility, render, visibility,
};

use crate::case::Case;
use crate::error::BenchError;
use crate::reference::Reference;
use crate::scenes::Measured;
use crate::statistics::median;

/// Runs in which each pass is a submission of its own; the one in the middle is reported.
const PASS_RUNS: usize = 3;

/// A scene, and what is taken for true on it.
pub(crate) struct Subject {
    pub(crate) measured: Measured,
    pub(crate) reference: Reference,
}

/// A scene as it is, and half opaque where a case asks for that.
pub(crate) struct Subjects {
    pub(crate) opaque: Subject,
    pub(crate) semi_opaque: Option<Subject>,
}

impl Subjects {
    /// What a case is measured on.
    pub(crate) fn of(&self, case: &Case) -> &Subject {
        self.semi_opaque.as_ref().filter(|_| case.semi_opaque).unwrap_or(&self.opaque)
    }
}

/// What one case costs on one scene, and how wrong it is.
#[derive(Debug, Clone)]
pub(crate) struct Measurement {
    pub(crate) case: Case,
    /// From plan to values, a turn each.
    pub(crate) wall_ms: Vec<f64>,
    /// The whole call, as its caller waits for it, a turn each.
    pub(crate) call_ms: Vec<f64>,
    /// Of the visibility, also where a picture was made.
    pub(crate) errors: ErrorReport,
    /// Of the last turn.
    pub(crate) info: Info,
    pub(crate) passes: PassTimes,
}

/// Passes of a run in which each had a submission of its own.
#[derive(Debug, Clone)]
pub(crate) struct PassTimes {
    pub(crate) pass_ms: Vec<PassTime>,
    /// Of that same run.
    pub(crate) wall_ms: f64,
}

impl PassTimes {
    /// The share of that run's wall time that its passes explain; the rest is planning, copying and waiting.
    pub(crate) fn explained(&self) -> f64 {
        self.pass_ms.iter().map(|pass| pass.ms).sum::<f64>() / self.wall_ms.max(f64::MIN_POSITIVE)
    }
}

impl Measurement {
    pub(crate) fn median_ms(&self) -> f64 {
        median(&self.wall_ms)
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.info.bytes.iter().map(|(_, bytes)| bytes).sum()
    }
}

/// A case that the library refuses on this scene, or that went wrong.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) case: Case,
    pub(crate) error: BenchError,
}

/// Every case once to warm up and `repeats` times, taking turns; then its passes.
pub(crate) fn take_turns(
    context: &Context,
    subjects: &Subjects,
    cases: &[Case],
    repeats: u32,
    on_run: &dyn Fn(usize, usize),
) -> (Vec<Measurement>, Vec<Failure>) {
    let mut failures = Vec::new();
    let mut entered: Vec<(Case, Vec<Run>)> = cases.iter().map(|case| (case.clone(), Vec::new())).collect();
    // Turn 0 warms up: pipelines, uploads and buffers are made there. Who fails leaves.
    let total = (repeats as usize + 1) * cases.len();
    let mut done = 0;
    for turn in 0..=repeats {
        // Every other turn goes backwards: nobody always runs after the same one.
        if turn > 0 {
            entered.reverse();
        }
        entered.retain_mut(|(case, runs)| match run(context, &subjects.of(case).measured, case, Timing::Device) {
            Ok(run) => {
                done += 1;
                on_run(done, total);
                // Values are kept of the last run alone.
                runs.iter_mut().for_each(|earlier: &mut Run| earlier.seen.values = Vec::new());
                runs.push(run);
                true
            }
            Err(error) => {
                failures.push(Failure { case: case.clone(), error: error.into() });
                false
            }
        });
    }
    // As they were given.
    entered.sort_by_key(|(case, _)| cases.iter().position(|given| given.is(case)));
    let mut measurements = Vec::new();
    for (case, runs) in entered {
        match conclude(context, subjects.of(&case), case.clone(), runs) {
            Ok(measurement) => measurements.push(measurement),
            Err(error) => failures.push(Failure { case, error }),
        }
    }
    (measurements, failures)
}

fn conclude(
    context: &Context,
    Subject { measured, reference }: &Subject,
    case: Case,
    mut runs: Vec<Run>,
) -> Result<Measurement, BenchError> {
    let times = |of: fn(&Run) -> f64| runs[1..].iter().map(of).collect::<Vec<f64>>();
    let (wall_ms, call_ms) = (times(|run| run.seen.info.wall_ms), times(|run| run.call_ms));
    let passes = (0..PASS_RUNS).map(|_| run(context, measured, &case, Timing::EachPass));
    let mut passes: Vec<Info> = passes.map(|run| Ok(run?.seen.info)).collect::<Result<_, Error>>()?;
    passes.sort_unstable_by(|a, b| a.wall_ms.total_cmp(&b.wall_ms));
    let middle = passes.swap_remove(PASS_RUNS / 2);
    let last = runs.swap_remove(runs.len() - 1).seen;
    let image = ReferenceImage {
        visibility: &reference.values,
        standard_error: Some(&reference.standard_error),
        width: last.image.map(|[width, _]| width as usize),
    };
    let errors = measure::compare(&last.values, &image).map_err(|error| Error::Measure(error.to_string()))?;
    let passes = PassTimes { pass_ms: middle.pass_ms, wall_ms: middle.wall_ms };
    Ok(Measurement { case, wall_ms, call_ms, errors, info: last.info, passes })
}

/// One call.
pub(crate) struct Run {
    pub(crate) seen: Visibility,
    pub(crate) call_ms: f64,
}

/// Calls the library as a person would.
pub(crate) fn run(context: &Context, measured: &Measured, case: &Case, timing: Timing) -> Result<Run, Error> {
    let options = Options { timing, ..Options::default() };
    let lights = std::slice::from_ref(&measured.light);
    let Measured { scene, camera, .. } = measured;
    let started = Instant::now();
    let seen = match case.picture {
        None => {
            let receivers = Receivers::Camera(*camera);
            visibility(context, scene, lights, &receivers, &case.technique, &options, &mut |_, _| true)?
        }
        Some(shading) => {
            let options = PictureOptions { shading, options, ..PictureOptions::default() };
            render(context, scene, lights, camera, &case.technique, &options, &mut |_, _| true)?.visibility
        }
    };
    Ok(Run { seen, call_ms: started.elapsed().as_secs_f64() * 1e3 })
}
