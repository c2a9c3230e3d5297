//! A converged reference with an error bar, for lights and meshes that no exact oracle covers.
//!
//! R independent replicates of m × m jittered samples each: the mean of the replicates is unbiased, and their spread gives
//! its standard error without any assumption about how fast jittering converges. State `V ± t(.975, R−1) · SE`
//! ([`t_quantile_975`]).

use rayon::prelude::*;

use crate::{MeasureError, RayReference, Receiver, Target};

/// How much to sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplingPlan {
    /// Independent repetitions, at least 2.
    pub replicates: usize,
    /// The unit square is cut into this many strata a side, at least 1; each replicate has one sample a stratum.
    pub strata_per_side: usize,
    /// Equal seeds give equal estimates, whatever the number of threads.
    pub seed: u64,
}

/// A visibility with its error bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean visibility of the replicates, in [0, 1].
    pub mean: f64,
    /// Standard error of that mean.
    pub standard_error: f64,
}

impl Estimate {
    /// Whether `truth` is within `quantile` standard errors; a visibility of 0 or 1 without any spread contains only itself.
    #[must_use]
    pub fn covers(&self, truth: f64, quantile: f64) -> bool {
        (truth - self.mean).abs() <= quantile * self.standard_error
    }
}

/// The visibility of a light from every receiver. `light` maps the unit square to the light, uniformly in the measure in
/// which visibility is wanted (area; solid angle for spheres).
///
/// # Errors
/// `NotFinite` for receivers or targets, `TooFew` for the plan's counts.
pub fn converged_visibility(
    scene: &RayReference,
    receivers: &[Receiver],
    light: impl Fn([f64; 2]) -> Target + Sync,
    plan: SamplingPlan,
) -> Result<Vec<Estimate>, MeasureError> {
    require_at_least("replicates", plan.replicates, 2)?;
    require_at_least("strata per side", plan.strata_per_side, 1)?;
    receivers
        .par_iter()
        .enumerate()
        .map(|(index, receiver)| {
            receiver.check(index)?;
            let mut random = SplitMix64::for_stream(plan.seed, index as u64);
            let targets: Vec<Target> =
                (0..plan.replicates).flat_map(|_| jittered(plan.strata_per_side, &mut random)).map(&light).collect();
            let verdicts = scene.trace_receiver(receiver, &targets)?;
            let per_replicate = plan.strata_per_side * plan.strata_per_side;
            let means: Vec<f64> = verdicts
                .chunks(per_replicate)
                .map(|replicate| {
                    let visible = replicate.iter().filter(|verdict| verdict.visible).count();
                    visible as f64 / per_replicate as f64
                })
                .collect();
            Ok(estimate_from(&means))
        })
        .collect()
}

fn require_at_least(what: &'static str, count: usize, minimum: usize) -> Result<(), MeasureError> {
    if count < minimum {
        return Err(MeasureError::TooFew { what, minimum });
    }
    Ok(())
}

fn estimate_from(means: &[f64]) -> Estimate {
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (count - 1.0);
    Estimate { mean, standard_error: (variance / count).sqrt() }
}

fn jittered(per_side: usize, random: &mut SplitMix64) -> Vec<[f64; 2]> {
    let width = 1.0 / per_side as f64;
    (0..per_side * per_side)
        .map(|cell| {
            let (row, column) = (cell / per_side, cell % per_side);
            [column, row].map(|at| (at as f64 + random.uniform()) * width)
        })
        .collect()
}

/// The quantile t(.975) of Student's distribution, the factor of a two-sided 95 % interval, for R − 1 degrees of freedom.
///
/// Tabulated up to 30; beyond, the expansion of Abramowitz and Stegun 26.7.5, then good to 1e-6.
///
/// # Errors
/// `TooFew` for 0 degrees of freedom.
pub fn t_quantile_975(degrees_of_freedom: usize) -> Result<f64, MeasureError> {
    const TABLE: [f64; 30] = [
        12.70620, 4.30265, 3.18245, 2.77645, 2.57058, 2.44691, 2.36462, 2.30600, 2.26216, 2.22814, 2.20099, 2.17881,
        2.16037, 2.14479, 2.13145, 2.11991, 2.10982, 2.10092, 2.09302, 2.08596, 2.07961, 2.07387, 2.06866, 2.06390,
        2.05954, 2.05553, 2.05183, 2.04841, 2.04523, 2.04227,
    ];
    const NORMAL_975: f64 = 1.959_963_984_540_054;
    require_at_least("degrees of freedom", degrees_of_freedom, 1)?;
    if let Some(&tabulated) = TABLE.get(degrees_of_freedom - 1) {
        return Ok(tabulated);
    }
    let (x, nu) = (NORMAL_975, degrees_of_freedom as f64);
    let first = (x.powi(3) + x) / 4.0;
    let second = (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / 96.0;
    let third = (3.0 * x.powi(7) + 19.0 * x.powi(5) + 17.0 * x.powi(3) - 15.0 * x) / 384.0;
    Ok(x + first / nu + second / (nu * nu) + third / (nu * nu * nu))
}

/// SplitMix64 (Steele, Lea and Flood 2014): small, seedable, and shared with nothing that is judged.
struct SplitMix64(u64);

impl SplitMix64 {
    fn for_stream(seed: u64, stream: u64) -> Self {
        // Two rounds separate the streams; seed + stream alone would make neighbours overlap.
        let start = Self(seed).next() ^ stream.wrapping_mul(0xD134_2543_DE82_EF95);
        Self(Self(start).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In [0, 1), from the highest 53 bits.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
