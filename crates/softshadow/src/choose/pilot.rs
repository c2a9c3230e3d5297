//! The pilot: one setting of each technique does a random part of the receivers.
//!
//! Of an image it is every so manyth pixel of every so manyth row from a random one on, of points a random subset. The times of its passes
//! correct the calibration for this scene; where rays for them fit its time as well, its values in the penumbra, beside rays, say how wrong each technique is here. Nothing is promised
//! from it: the check of the result does that, with receivers of its own.

use std::time::Instant;

use softshadow_measure::metrics::UMBRA_LIMIT;
use softshadow_measure::{Drawn, ErrorNorm, Stratum, bound_error};
use softshadow_plan::Timing;
use softshadow_scene::{Points, Receivers};

use super::candidates::Candidates;
use super::check::{Random, reference, traced};
use super::{Call, Limit, MARGIN};
use crate::Progress;
use crate::error::Error;
use crate::visibility::{Options, Visibility};

/// Receivers of a pilot: enough for tiles of neighbours, and for penumbrae to be among them.
const RECEIVERS: u64 = 4096;
/// Those in the penumbra that are traced.
const TRACED: usize = 128;
/// Fewer say nothing.
const FEWEST: usize = 16;
/// The share of the run that a pilot may take.
const SHARE: f64 = 1.0 / 3.0;

pub(super) struct Pilot {
    pub(super) is_skipped: bool,
    /// Whether errors were measured, not only times.
    pub(super) has_errors: bool,
    pub(super) words: String,
}

fn skipped(why: String) -> Pilot {
    Pilot { is_skipped: true, has_errors: false, words: format!("none: {why}") }
}

pub(super) fn pilot(call: &Call<'_>, candidates: &mut Candidates, on_progress: Progress<'_>) -> Result<Pilot, Error> {
    let bound = match call.goal.limit {
        Limit::MaxError(bound) => bound / MARGIN,
        Limit::MaxMs(_) => f64::INFINITY,
    };
    let mut settings = candidates.of_each_technique(bound);
    match settings[..] {
        [] => return Ok(skipped("nothing is expected to do".into())),
        [one] if candidates.all[one].expected_error.is_some() => {
            return Ok(skipped("one technique alone serves this call".into()));
        }
        _ => {}
    }
    let Some(receivers) = part(call)? else { return Ok(skipped("there are too few receivers".into())) };
    let options = Options { receivers: true, timing: Timing::EachPass, ..Options::default() };
    let began = Instant::now();
    let (mut told, mut seen) = (Vec::new(), Vec::new());
    let mut run_ms = f64::INFINITY;
    let left = |run_ms: f64| SHARE * run_ms - began.elapsed().as_secs_f64() * 1e3;
    // The cheapest pilot first: what it shows about the whole run decides what others may cost.
    while !settings.is_empty() {
        let costs = settings.iter().map(|index| candidates.predicted_for(call, *index, &receivers));
        let costs: Vec<f64> = costs.collect::<Result<_, _>>()?;
        let order = |at: &usize| costs[*at];
        let Some(at) = (0..costs.len()).min_by(|a, b| order(a).total_cmp(&order(b))) else { break };
        let (index, cost) = (settings.swap_remove(at), costs[at]);
        let name = candidates.all[index].technique.name();
        let whole = match call.goal.limit {
            Limit::MaxError(_) => run_ms.min(candidates.all[index].predicted_ms),
            Limit::MaxMs(ms) => ms,
        };
        let room = left(if run_ms.is_finite() { run_ms } else { whole });
        if cost > room {
            told.push(format!("{name} left out: it would take {cost:.1} ms of {room:.1}"));
            continue;
        }
        let technique = candidates.all[index].technique.clone();
        match call.run(&technique, &receivers, &options, &mut |_, _| on_progress(0, 1)) {
            Ok(result) => {
                candidates.learn(call, index, &receivers, &result);
                told.push(format!("{name} {:.1} ms", result.info.wall_ms));
                run_ms = match call.goal.limit {
                    Limit::MaxError(_) => run_ms.min(candidates.all[index].predicted_ms),
                    Limit::MaxMs(ms) => ms,
                };
                seen.push((index, result));
            }
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            // Neighbours lie farther apart than those of the whole call: what is too dense here may serve there.
            Err(error) => told.push(format!("{name} refused ({error})")),
        }
    }
    if seen.is_empty() {
        return Ok(skipped(told.join(", ")));
    }
    // Rays for errors take about as long as what they judge.
    let has_time = left(run_ms) > SHARE * SHARE * run_ms;
    let more = |spent: &Candidates| left(spent.least_predicted()) > 0.0;
    let errors = if has_time { errors(call, candidates, &receivers, seen, &more, on_progress)? } else { Vec::new() };
    let (count, has_errors) = (receivers.count(), !errors.is_empty());
    told.extend(errors);
    Ok(Pilot { is_skipped: false, has_errors, words: format!("{count} receivers: {}", told.join(", ")) })
}

type Traced = Vec<(usize, Vec<Drawn>)>;

/// Errors of what the pilot has seen. Of a technique whose error follows from nothing, better settings are tried while there is time.
fn errors(
    call: &Call<'_>,
    candidates: &mut Candidates,
    all: &Receivers,
    mut seen: Vec<(usize, Visibility)>,
    has_time: &dyn Fn(&Candidates) -> bool,
    on_progress: Progress<'_>,
) -> Result<Vec<String>, Error> {
    let limit = f64::from(UMBRA_LIMIT);
    let (size, drawn) = {
        let first = &seen[0].1;
        let channels = first.channels;
        let in_penumbra = |pair: &usize| {
            let range = pair * channels..(pair + 1) * channels;
            let values = seen.iter().flat_map(|(_, result)| &result.values[range.clone()]);
            values.into_iter().any(|v| (limit..=1.0 - limit).contains(&f64::from(*v)))
        };
        let pairs = (0..first.lights * first.receivers).filter(|pair| first.valid[pair % first.receivers]);
        let pairs: Vec<usize> = pairs.filter(in_penumbra).collect();
        (pairs.len() * channels, Random(0x517C_C1B7_2722_0A95).draw(pairs, TRACED))
    };
    if drawn.len() < FEWEST {
        return Ok(Vec::new());
    }
    let (bound, rmse_bound) = match call.goal.limit {
        Limit::MaxError(bound) => (bound, bound / call.goal.over_rmse()),
        Limit::MaxMs(_) => (0.0, 0.01),
    };
    let technique = reference(rmse_bound, ErrorNorm::Rmse, 0xA076_1D64);
    let known: Traced = traced(call, all, &seen[0].1, &drawn, &technique, &mut || on_progress(0, 1))?;
    let mut told = Vec::new();
    while let Some((index, result)) = seen.pop() {
        let of = |(pair, channels): &(usize, Vec<Drawn>)| {
            let at = pair * result.channels;
            let value = |(channel, d): (usize, &Drawn)| Drawn { value: f64::from(result.values[at + channel]), ..*d };
            channels.iter().enumerate().map(value).collect::<Vec<_>>()
        };
        let stratum = Stratum { size, drawn: known.iter().flat_map(of).collect() };
        // Of so few receivers the mean square says most, whatever the norm.
        let found = bound_error(ErrorNorm::Rmse, &[stratum], 1.0, 0.95);
        let error = found.map_err(|error| Error::Measure(error.to_string()))?.estimate * call.goal.over_rmse();
        candidates.measured(index, error);
        let technique = &candidates.all[index].technique;
        told.push(format!("{} errs by {error:.4}", technique.name()));
        let better = candidates.all.get(index + 1).filter(|next| next.technique.name() == technique.name());
        let Some(better) = better.filter(|_| technique.expected_error().is_none() && error > bound) else { continue };
        if has_time(candidates) {
            let options = Options { timing: Timing::EachPass, ..Options::default() };
            let result = call.run(&better.technique.clone(), all, &options, &mut |_, _| on_progress(0, 1))?;
            candidates.learn(call, index + 1, all, &result);
            seen.push((index + 1, result));
        }
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
