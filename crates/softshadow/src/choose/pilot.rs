//! The pilot: one setting of each technique does a random part of the receivers.
//!
//! Of an image it is every so manyth pixel of every so manyth row from a random one on, of points a random subset. The times of its passes
//! correct the calibration for this scene; its values in the penumbra, beside rays, say how wrong each technique is here. Nothing is promised
//! from it: the check of the result does that, with receivers of its own.

use std::time::Instant;

use softshadow_measure::metrics::UMBRA_LIMIT;
use softshadow_measure::{ErrorNorm, Stratum, bound_error};
use softshadow_plan::Timing;
use softshadow_scene::{Points, Receivers};

use super::candidates::Candidates;
use super::check::{Random, reference, traced};
use super::{Call, Limit, MARGIN};
use crate::Progress;
use crate::error::Error;
use crate::visibility::Options;

/// Receivers of a pilot: enough for tiles of neighbours, and for penumbrae to be among them.
const RECEIVERS: u64 = 4096;
/// Those in the penumbra that are traced.
const TRACED: usize = 128;
/// The share of the run that a pilot may take.
const SHARE: f64 = 1.0 / 3.0;

pub(super) struct Pilot {
    pub(super) is_skipped: bool,
    pub(super) words: String,
}

fn skipped(why: String) -> Pilot {
    Pilot { is_skipped: true, words: format!("none: {why}") }
}

pub(super) fn pilot(
    call: &Call<'_>,
    candidates: &mut Candidates,
    on_progress: Progress<'_>,
) -> Result<Pilot, Error> {
    let bound = match call.goal.limit {
        Limit::MaxError(bound) => bound / MARGIN,
        Limit::MaxMs(_) => f64::INFINITY,
    };
    let settings = settings(call, candidates, bound);
    let Some(run_ms) = settings.iter().map(|index| candidates.all[*index].predicted_ms).reduce(f64::min) else {
        return Ok(skipped("nothing is expected to do".into()));
    };
    let run_ms = match call.goal.limit {
        Limit::MaxError(_) => run_ms,
        Limit::MaxMs(ms) => ms,
    };
    if settings.len() == 1 && candidates.all[settings[0]].expected_error.is_some() {
        return Ok(skipped("one technique alone serves this call".into()));
    }
    let Some(receivers) = part(call)? else { return Ok(skipped("there are too few receivers".into())) };
    let mut left = SHARE * run_ms;
    let costs = settings.iter().map(|index| candidates.predicted_for(call, *index, &receivers));
    let costs: Vec<f64> = costs.collect::<Result<_, _>>()?;
    // Without two of them there is nothing to choose between; rays for their error take about as long again.
    let mut sorted = costs.clone();
    sorted.sort_by(f64::total_cmp);
    let least: f64 = sorted.iter().take(2).sum::<f64>() * 1.5;
    if least > left {
        return Ok(skipped(format!("it would take {least:.1} ms, more than a third of {run_ms:.1} ms")));
    }
    let options = Options { receivers: true, timing: Timing::EachPass, ..Options::default() };
    let mut told = Vec::new();
    let mut seen = Vec::new();
    for (index, cost) in settings.into_iter().zip(costs) {
        if cost > left && told.len() > 1 {
            continue;
        }
        let name = candidates.all[index].technique.name();
        let began = Instant::now();
        let result = call.run(&candidates.all[index].technique.clone(), &receivers, &options, &mut |_, _| on_progress(0, 1));
        match result {
            Ok(result) => {
                candidates.learn(call, index, &receivers, &result);
                told.push(format!("{name} {:.1} ms", result.info.wall_ms));
                seen.push((index, result));
            }
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            // Neighbours lie farther apart than those of the whole call: what is too dense here may serve there.
            Err(error) => told.push(format!("{name} refused ({error})")),
        }
        left -= began.elapsed().as_secs_f64() * 1e3;
    }
    let errors = errors(call, candidates, &receivers, &seen, left, on_progress)?;
    told.extend(errors);
    let count = receivers.count();
    Ok(Pilot { is_skipped: false, words: format!("{count} receivers: {}", told.join(", ")) })
}

/// A setting of each technique, the fastest first; within a time the best that fits.
fn settings(call: &Call<'_>, candidates: &Candidates, bound: f64) -> Vec<usize> {
    match call.goal.limit {
        Limit::MaxError(_) => candidates.of_each_technique(bound),
        Limit::MaxMs(_) => candidates.of_each_technique(f64::INFINITY),
    }
}

/// Errors of what the pilot has seen, where rays for them fit what is left of its time.
fn errors(
    call: &Call<'_>,
    candidates: &mut Candidates,
    all: &Receivers,
    seen: &[(usize, crate::Visibility)],
    left_ms: f64,
    on_progress: Progress<'_>,
) -> Result<Vec<String>, Error> {
    let Some((_, first)) = seen.first().filter(|_| left_ms > 0.0) else { return Ok(Vec::new()) };
    let limit = f64::from(UMBRA_LIMIT);
    let channels = first.channels;
    let in_penumbra = |pair: &usize| {
        let values = |result: &crate::Visibility| result.values[pair * channels..(pair + 1) * channels].to_vec();
        seen.iter().any(|(_, result)| values(result).iter().any(|v| (limit..=1.0 - limit).contains(&f64::from(*v))))
    };
    let pairs: Vec<usize> = (0..first.lights * first.receivers)
        .filter(|pair| first.valid[pair % first.receivers])
        .filter(in_penumbra)
        .collect();
    let size = pairs.len();
    let drawn = Random(0x517C_C1B7_2722_0A95).draw(pairs, TRACED);
    if drawn.len() < 16 {
        return Ok(vec![format!("{size} in the penumbra: too few to measure")]);
    }
    let bound = match call.goal.limit {
        Limit::MaxError(bound) => bound / call.goal.over_rmse(),
        Limit::MaxMs(_) => 0.01,
    };
    let technique = reference(bound, ErrorNorm::Rmse, 0xA076_1D64);
    let mut told = Vec::new();
    let mut references: Option<Vec<(usize, Vec<softshadow_measure::Drawn>)>> = None;
    for (index, result) in seen {
        let known = match &references {
            None => {
                let traced = traced(call, all, result, &drawn, &technique, &mut || on_progress(0, 1))?;
                references.insert(traced)
            }
            Some(known) => known,
        };
        let own = |(pair, channels): &(usize, Vec<softshadow_measure::Drawn>)| {
            let value = |(channel, d): (usize, &softshadow_measure::Drawn)| softshadow_measure::Drawn {
                value: f64::from(result.values[pair * result.channels + channel]),
                ..*d
            };
            channels.iter().enumerate().map(value).collect::<Vec<_>>()
        };
        let stratum = Stratum { size: size * channels, drawn: known.iter().flat_map(own).collect() };
        // Of so few receivers the mean square says most, whatever the norm.
        let found = bound_error(ErrorNorm::Rmse, &[stratum], 1.0, 0.95);
        let rmse = found.map_err(|error| Error::Measure(error.to_string()))?.estimate;
        let error = rmse * call.goal.over_rmse();
        candidates.measured(*index, error);
        told.push(format!("{} errs by {error:.4}", candidates.all[*index].technique.name()));
    }
    Ok(told)
}

/// A random part of the receivers; `None` where there are so few that a part would be nearly all.
fn part(call: &Call<'_>) -> Result<Option<Receivers>, Error> {
    let count = call.receivers.count();
    if count < 4 * RECEIVERS {
        return Ok(None);
    }
    let mut random = Random(count);
    Ok(Some(match call.receivers {
        Receivers::Camera(camera) => {
            let step = (count as f64 / RECEIVERS as f64).sqrt().floor() as u32;
            let step = step.min(camera.size()[0]).min(camera.size()[1]).max(1);
            let first = [0; 2].map(|_: u32| (random.next() % u64::from(step)) as u32);
            Receivers::Camera(camera.every(step, first)?)
        }
        Receivers::Points(points) => {
            let chosen = random.draw((0..count as usize).collect(), RECEIVERS as usize);
            let positions = chosen.iter().map(|at| points.positions()[*at]).collect();
            let normals = points.normals().map(|normals| chosen.iter().map(|at| normals[*at]).collect());
            Receivers::Points(Points::new(positions, normals)?)
        }
    }))
}
