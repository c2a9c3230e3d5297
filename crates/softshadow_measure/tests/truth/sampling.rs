//! The error bar of the converged reference covers the truth, and a biased reference does not.

use softshadow_measure::{
    MeasureError, RayReference, Receiver, SamplingPlan, Triangle, converged_visibility, half_plane_over_rectangle,
    t_quantile_975,
};

use crate::random::Random;
use crate::shapes::{LIGHT, as_light};

const PLAN: SamplingPlan = SamplingPlan { replicates: 16, strata_per_side: 8, seed: 7 };

/// A half-plane at height 1.5, its edge through the origin at `angle`: it hides what lies to the negative side.
fn half_plane(angle: f64) -> Triangle {
    let (sin, cos) = angle.sin_cos();
    let at = |along: f64, across: f64| [cos * along - sin * across, sin * along + cos * across, 1.5];
    [at(0.0, -99.0), at(0.0, 99.0), at(-99.0, 0.0)]
}

/// How many of 600 estimates hold the truth in their 95 % interval when the truth is off by `bias`.
fn covered(bias: f64) -> f64 {
    let mut random = Random::new(1);
    let light = as_light(&LIGHT);
    let quantile = t_quantile_975(PLAN.replicates - 1).unwrap();
    let (mut held, mut count) = (0, 0);
    for angle in [0.1, 0.7, 1.3, 2.9, 4.0, 5.5] {
        let scene = RayReference::new(&[half_plane(angle)]).unwrap();
        // The edge projects to −(n·p) on the light, twice as high: keep the receivers within the penumbra.
        let places: Vec<[f64; 2]> = (0..100).map(|_| [random.between(-0.3, 0.3), random.between(-0.3, 0.3)]).collect();
        let receivers: Vec<Receiver> = places.iter().map(|p| Receiver::at([p[0], p[1], 0.0])).collect();
        let estimates = converged_visibility(&scene, &receivers, |uv| light.target(uv), PLAN).unwrap();
        for (place, estimate) in places.iter().zip(estimates) {
            let distance = -(angle.cos() * place[0] + angle.sin() * place[1]);
            let truth = half_plane_over_rectangle(distance, angle, [0.5; 2]).unwrap();
            count += 1;
            held += usize::from(estimate.covers(truth + bias, quantile));
        }
    }
    f64::from(u32::try_from(held).unwrap()) / f64::from(count)
}

#[test]
fn intervals_cover_the_truth_and_not_a_biased_one() {
    let (honest, biased) = (covered(0.0), covered(0.02));
    println!("coverage of 95 % intervals: {honest:.3}; with a bias of 0.02: {biased:.3}");
    assert!((0.90..=0.99).contains(&honest), "{honest}");
    assert!(biased < 0.1, "{biased}");
}

#[test]
fn equal_seeds_give_equal_estimates_and_others_do_not() {
    let scene = RayReference::new(&[half_plane(0.7)]).unwrap();
    let light = as_light(&LIGHT);
    let receivers = [Receiver::at([0.0; 3]), Receiver::at([0.0; 3])];
    let estimate = |seed| {
        let plan = SamplingPlan { seed, ..PLAN };
        converged_visibility(&scene, &receivers, |uv| light.target(uv), plan).unwrap()
    };
    assert_eq!(estimate(1), estimate(1));
    assert_ne!(estimate(1), estimate(2));
    // Neighbours draw different samples even at the same place.
    assert_ne!(estimate(1)[0], estimate(1)[1]);
}

#[test]
fn certainty_has_no_spread() {
    let scene = RayReference::new(&[]).unwrap();
    let light = as_light(&LIGHT);
    let receivers = [Receiver::at([0.0; 3])];
    let lit = converged_visibility(&scene, &receivers, |uv| light.target(uv), PLAN).unwrap()[0];
    assert_eq!((lit.mean, lit.standard_error), (1.0, 0.0));
    assert!(lit.covers(1.0, 2.0) && !lit.covers(0.999, 2.0));
}

/// Two-sided probability within ±t of Student's distribution, by Simpson's rule on its density.
fn probability_within(t: f64, degrees_of_freedom: usize) -> f64 {
    const PANELS: u32 = 20_000;
    let nu = degrees_of_freedom as f64;
    let density = |x: f64| (1.0 + x * x / nu).powf(-(nu + 1.0) / 2.0);
    let integrate = |f: &dyn Fn(f64) -> f64, end: f64| {
        let h = end / f64::from(PANELS);
        let inner: f64 = (1..PANELS).map(|k| f(h * f64::from(k)) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
        (f(0.0) + inner + f(end)) * h / 3.0
    };
    // The normalisation by the substitution x = y / (1 − y), which brings infinity to 1.
    let whole = integrate(
        &|y| {
            if y >= 1.0 {
                return if degrees_of_freedom == 1 { 1.0 } else { 0.0 };
            }
            density(y / (1.0 - y)) / ((1.0 - y) * (1.0 - y))
        },
        1.0,
    );
    integrate(&density, t) / whole
}

#[test]
fn the_quantiles_enclose_95_percent() {
    for degrees in (1..=30).chain([31, 40, 63, 255, 4095]) {
        let inside = probability_within(t_quantile_975(degrees).unwrap(), degrees);
        assert!((inside - 0.95).abs() < 2e-6, "{degrees}: {inside}");
    }
    // The spoilt table: its neighbour's entry.
    let wrong = probability_within(t_quantile_975(16).unwrap(), 15);
    assert!((wrong - 0.95).abs() > 1e-4);
}

#[test]
fn plans_without_statistics_are_typed_errors() {
    let scene = RayReference::new(&[]).unwrap();
    let light = as_light(&LIGHT);
    for (replicates, strata_per_side) in [(1, 8), (2, 0)] {
        let plan = SamplingPlan { replicates, strata_per_side, seed: 0 };
        let refused = converged_visibility(&scene, &[], |uv| light.target(uv), plan);
        assert!(matches!(refused, Err(MeasureError::TooFew { .. })));
    }
    assert!(matches!(t_quantile_975(0), Err(MeasureError::TooFew { .. })));
    let bad = [Receiver::at([0.0; 3]), Receiver::at([f64::NAN; 3])];
    let refused = converged_visibility(&scene, &bad, |uv| light.target(uv), PLAN);
    let expected = MeasureError::NotFinite { what: "receiver", index: 1 };
    assert_eq!(refused, Err(expected));
}
