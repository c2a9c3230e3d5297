//! Receivers drawn at random from a result, traced with samples of their own.
//!
//! Pairs of a light and a receiver are drawn in two strata: those that the result puts into the penumbra, and the rest. The rest is looked at
//! with few rays first, and with as many as the others where those or the result say penumbra. References average four passes, whose
//! spread gives a variance without bias; every receiver takes one of many sets of samples, so that noise is its own.

use std::collections::BTreeMap;

use softshadow_measure::metrics::UMBRA_LIMIT;
use softshadow_measure::{Drawn, ErrorBound, ErrorNorm, Stratum, bound_error};
use softshadow_scene::{Points, Receivers, SamplePattern, SampleSpread};
use softshadow_techniques::{RayTraced, Technique};

use super::{Call, Limit};
use crate::error::Error;
use crate::visibility::{Options, Visibility, run};

/// Receivers of the penumbra that the first check of a result draws, and a second one where the first was close.
///
/// Of a root mean square, the bound from 400 lies a tenth above the estimate. Of a percentile, at most 2 of 1,000 may be beyond it.
pub(super) fn sizes(norm: ErrorNorm) -> [usize; 2] {
    match norm {
        ErrorNorm::Rmse | ErrorNorm::Max => [400, 1600],
        ErrorNorm::P99 => [1000, 1500],
    }
}

/// Others: what three of a thousand of them have would be seen.
const OTHERS: usize = 1000;
/// Rays of the first look at those.
const FIRST_RAYS: u32 = 32;
/// Passes of a reference.
const PASSES: u32 = 4;

pub(super) struct Checked {
    pub(super) bound: ErrorBound,
    /// Receivers that were traced.
    pub(super) traced: usize,
    /// Whether all receivers in the penumbra were among them.
    pub(super) is_all: bool,
}

/// Bounds the error of a result that has its receivers with it.
pub(super) fn check(
    call: &Call<'_>,
    result: &Visibility,
    size: usize,
    confidence: f64,
    round: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Checked, Error> {
    let limit = f64::from(UMBRA_LIMIT);
    let in_penumbra = |pair: usize| values(result, pair).any(|v| (limit..=1.0 - limit).contains(&v));
    let pairs = (0..result.lights * result.receivers).filter(|pair| result.valid[pair % result.receivers.max(1)]);
    let (penumbra, rest): (Vec<usize>, Vec<usize>) = pairs.partition(|pair| in_penumbra(*pair));
    let mut random = Random(round.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let parts = [penumbra.len(), rest.len()];
    let (inner, outer) = (random.draw(penumbra, size), random.draw(rest, OTHERS));
    let seed = random.next() as u32;
    let bound = match call.goal.limit {
        Limit::MaxError(bound) => bound,
        // As good as the samples of the result are.
        Limit::MaxMs(_) => result.info.technique.expected_error().unwrap_or(0.02) * call.goal.over_rmse(),
    };
    // Noise of references widens a percentile: a second look has less of it.
    let finer = if call.goal.norm == ErrorNorm::P99 && size > sizes(call.goal.norm)[0] { 0.4 } else { 1.0 };
    let technique = reference(finer * bound / call.goal.over_rmse(), call.goal.norm, seed);
    let first = Technique::RayTraced(RayTraced { samples: FIRST_RAYS, passes: 1, ..settings(seed ^ 1) });
    let looked = traced(call, call.receivers, result, &outer, &first, go_on)?;
    let (unclear, clear): (Vec<_>, Vec<_>) = looked.into_iter().partition(|(pair, drawn)| {
        let differs = drawn.iter().any(|d| (d.value - d.reference).abs() > limit);
        differs || drawn.iter().any(|d| (limit..=1.0 - limit).contains(&d.reference)) || in_penumbra(*pair)
    });
    let unclear: Vec<usize> = unclear.into_iter().map(|(pair, _)| pair).collect();
    let inner_drawn = traced(call, call.receivers, result, &inner, &technique, go_on)?;
    let mut outer_drawn = traced(call, call.receivers, result, &unclear, &technique, go_on)?;
    outer_drawn.extend(clear);
    let strata = [(parts[0], inner_drawn), (parts[1], outer_drawn)].map(|(size, drawn)| Stratum {
        size,
        drawn: drawn.into_iter().map(|(_, channels)| worst(&channels)).collect(),
    });
    let bound = bound_error(call.goal.norm, &strata, bound, confidence);
    Ok(Checked {
        bound: bound.map_err(|error| Error::Measure(error.to_string()))?,
        traced: inner.len() + outer.len(),
        is_all: inner.len() == parts[0],
    })
}

/// Rays for a standard error well below a bound: what they add to a squared error is taken off again, but not from a percentile.
pub(super) fn reference(rmse: f64, norm: ErrorNorm, seed: u32) -> Technique {
    let wanted = rmse * if norm == ErrorNorm::Rmse { 0.7 } else { 0.2 };
    let mut samples = 16;
    let error =
        |samples| Technique::RayTraced(RayTraced { samples, passes: PASSES, ..RayTraced::default() }).expected_error();
    while samples < 4096 && error(samples).is_some_and(|error| error > wanted) {
        samples *= 2;
    }
    Technique::RayTraced(RayTraced { samples, passes: PASSES, ..settings(seed) })
}

fn settings(seed: u32) -> RayTraced {
    RayTraced {
        pattern: SamplePattern::LowDiscrepancy,
        spread: SampleSpread::Decorrelated,
        seed,
        ..RayTraced::default()
    }
}

/// The values of a pair of a light and a receiver, by channel.
fn values(result: &Visibility, pair: usize) -> impl Iterator<Item = f64> {
    let channels = result.channels;
    result.values[pair * channels..(pair + 1) * channels].iter().map(|v| f64::from(*v))
}

/// The channel that errs most speaks for all.
fn worst(channels: &[Drawn]) -> Drawn {
    let size = |d: &Drawn| (d.value - d.reference).abs();
    let nothing = Drawn { value: 0.0, reference: 0.0, standard_error: 0.0 };
    channels.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(nothing)
}

/// Pairs of a light and a receiver beside their references, by channel.
pub(super) fn traced(
    call: &Call<'_>,
    all: &Receivers,
    result: &Visibility,
    pairs: &[usize],
    technique: &Technique,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Vec<(usize, Vec<Drawn>)>, Error> {
    let mut by_light: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    pairs.iter().for_each(|pair| by_light.entry(pair / result.receivers).or_default().push(pair % result.receivers));
    let options = Options { standard_error: true, ..Options::default() };
    let mut found = Vec::with_capacity(pairs.len());
    for (light, receivers) in by_light {
        let points = Receivers::Points(points(all, result, &receivers)?);
        let lights = std::slice::from_ref(&call.lights[light]);
        let (seen, _) = run(call.device, call.scene, lights, &points, technique, &options, None, &mut |_, _| go_on())?;
        let errors = seen.standard_error.unwrap_or_default();
        for (at, receiver) in receivers.into_iter().enumerate() {
            let pair = light * result.receivers + receiver;
            // A light without a texture has one channel alone, and three in a call in which another has one.
            let own = |channel: usize| at * seen.channels + channel.min(seen.channels - 1);
            let drawn = |(channel, value): (usize, f64)| Drawn {
                value,
                reference: f64::from(seen.values[own(channel)]),
                standard_error: f64::from(errors[own(channel)]),
            };
            found.push((pair, values(result, pair).enumerate().map(drawn).collect()));
        }
    }
    Ok(found)
}

/// Some receivers of a result: as they were given, or as they were placed.
fn points(all: &Receivers, result: &Visibility, receivers: &[usize]) -> Result<Points, Error> {
    if let Receivers::Points(given) = all {
        let positions = receivers.iter().map(|r| given.positions()[*r]).collect();
        let normals = given.normals().map(|normals| receivers.iter().map(|r| normals[*r]).collect());
        return Ok(Points::new(positions, normals)?);
    }
    let placed = result.placed.as_ref().ok_or_else(|| Error::Measure("a result without its receivers".into()))?;
    let normals = receivers.iter().map(|r| placed.normals[*r].map(f64::from)).collect();
    Ok(Points::new(receivers.iter().map(|r| placed.positions[*r]).collect(), Some(normals))?)
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// At most `count` of some numbers, without replacement.
    pub(super) fn draw(&mut self, mut from: Vec<usize>, count: usize) -> Vec<usize> {
        let count = count.min(from.len());
        for at in 0..count {
            let other = at + (self.next() % (from.len() - at) as u64) as usize;
            from.swap(at, other);
        }
        from.truncate(count);
        from.sort_unstable();
        from
    }
}

#[cfg(test)]
mod tests {
    use softshadow_scene::{Light, LightShape, Material, Mesh, Scene};

    use super::*;
    use crate::choose::Goal;
    use crate::{Context, DeviceChoice};

    /// A square over points in a plane: umbra, penumbra and light.
    fn scene() -> (Scene, Light, Receivers) {
        let corners = vec![[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [1.0, 1.0, 2.0], [-1.0, 1.0, 2.0]];
        let mesh = Mesh::new("square", corners, vec![[0, 1, 2], [0, 2, 3]], Material::default()).unwrap();
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 4.0], [0.0, 0.0, 0.0, 1.0]];
        let light = Light::new(LightShape::Rectangle { width: 1.0, height: 1.0 }, pose).unwrap();
        let grid = |at: usize| [(at % 120) as f64 / 20.0 - 3.0, (at / 120) as f64 / 20.0 - 3.0, 0.0];
        let places: Vec<[f64; 3]> = (0..14_400).map(grid).collect();
        let up = vec![[0.0, 0.0, 1.0]; places.len()];
        (Scene::new(vec![mesh]).unwrap(), light, Receivers::Points(Points::new(places, Some(up)).unwrap()))
    }

    #[test]
    fn planted_bugs_are_found_at_random_receivers() {
        let (scene, light, receivers) = scene();
        let context = Context::new(&DeviceChoice::Native).unwrap();
        let device = context.device([]).unwrap();
        let goal = Goal::max_error(0.02, ErrorNorm::Rmse);
        let call = Call { device, scene: &scene, lights: &[light], receivers: &receivers, goal };
        let technique = Technique::RayTraced(RayTraced { samples: 256, ..RayTraced::default() });
        let honest = call.run(&technique, &receivers, &Options::default(), &mut |_, _| true).unwrap();
        let found = |result: &Visibility| check(&call, result, 400, 0.95, 1, &mut || true).unwrap().bound;
        let plain = found(&honest);
        assert!(plain.upper.unwrap() < 0.015 && plain.receivers >= 390, "{plain:?}");

        let spoilt = |spoil: &dyn Fn(usize, f32) -> f32| {
            let mut result = honest.clone();
            result.values.iter_mut().enumerate().for_each(|(at, v)| *v = spoil(at, *v));
            found(&result)
        };
        // A bias in the penumbra alone.
        let bias = spoilt(&|_, v| if v > 0.01 && v < 0.97 { v + 0.03 } else { v });
        assert!((bias.estimate - 0.03).abs() < 0.006 && bias.upper.unwrap() > 0.03, "{bias:?}");
        // Light that leaks to one receiver of twenty in the umbra: the result says that they are lit.
        let leak = spoilt(&|at, v| if v == 0.0 && at % 20 == 0 { 1.0 } else { v });
        assert!(leak.upper.unwrap() > 0.05 && leak.estimate > 2.0 * plain.estimate, "{leak:?}");
        // A shadow that lies a receiver beside its place.
        let beside = honest.values.clone();
        let shift = spoilt(&|at, v| beside.get(at + 1).copied().unwrap_or(v));
        assert!(shift.estimate > 0.02 && shift.upper.unwrap() > 0.02, "{shift:?}");
        // Penumbrae cut to eight steps.
        let bands = spoilt(&|_, v| (v * 8.0).round() / 8.0);
        assert!(bands.estimate > 0.02 && bands.upper.unwrap() > 0.02, "{bands:?}");
    }

    #[test]
    fn draws_are_random_and_never_twice() {
        let mut random = Random(1);
        let mut counts = [0; 50];
        for _ in 0..2000 {
            let drawn = random.draw((0..50).collect(), 5);
            assert!(drawn.len() == 5 && drawn.windows(2).all(|pair| pair[0] < pair[1]));
            drawn.into_iter().for_each(|at| counts[at] += 1);
        }
        // 200 each, with a standard deviation of 13.4.
        assert!(counts.iter().all(|count| (140..260).contains(count)), "{counts:?}");
        assert_eq!(random.draw(vec![4, 7], 5), [4, 7]);
    }
}
