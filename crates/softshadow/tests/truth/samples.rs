//! Light samples are equal shares of the light, and independent of each other.

use softshadow::{LightSampling, LightShape, SamplePattern, light_points, measure};

use crate::common::{Random, lamp, points, ray_traced, rectangle, see};
use crate::shapes::{disc, plate, scene};

#[test]
fn a_wide_sun_is_measured_by_solid_angle() {
    // A disc over the receiver hides the inner half of the angle; the share that is left follows from the caps alone.
    let (half_angle, hidden_angle) = (60.0_f64.to_radians(), 30.0_f64.to_radians());
    let sun = lamp(LightShape::Sun { angular_diameter: 2.0 * half_angle }, [0.0; 3]);
    let occluder = scene(&disc([0.0, 0.0, 1.0], hidden_angle.tan(), 256));
    let seen = see(&occluder, &[sun], &points(vec![[0.0; 3]]), &ray_traced(16_384));
    let truth = 1.0 - (1.0 - hidden_angle.cos()) / (1.0 - half_angle.cos());
    let value = f64::from(seen.values[0]);
    println!("wide sun: {value} where solid angle gives {truth}");
    assert!((value - truth).abs() < 0.005, "{value} is not {truth}: samples are no equal shares of solid angle");
}

/// Positions of the samples within their cells, row by row: 64 samples lie in 8 × 8 cells.
fn jitters(seed: u32) -> Vec<[f64; 2]> {
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 1.0]);
    let floor = scene(&plate([-1.0, 1.0], [-1.0, 1.0], 0.0));
    let samples =
        light_points(&floor, &light, &LightSampling::correlated(SamplePattern::Stratified, 64, seed), &[], 0).unwrap();
    let mut cells = vec![[f64::NAN; 2]; 64];
    for p in &samples.parameters {
        let at = p.map(|x| (f64::from(x) * 0.5 + 0.5) * 8.0);
        cells[(at[1].floor() * 8.0 + at[0].floor()) as usize] = at.map(f64::fract);
    }
    assert!(cells.iter().flatten().all(|x| x.is_finite()), "every cell holds one sample");
    cells
}

/// Two numbers of a cell or of a cell and its neighbour.
type Pair<'a> = &'a dyn Fn(&[[f64; 2]], usize) -> [f64; 2];

/// Pearson's correlation; for independent numbers its standard deviation is 1/√n.
fn correlation(pairs: &[[f64; 2]]) -> f64 {
    let n = pairs.len() as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|p| p[k]).sum::<f64>() / n);
    let moment = |i: usize, j: usize| pairs.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    moment(0, 1) / (moment(0, 0) * moment(1, 1)).sqrt()
}

#[test]
fn jitters_are_independent_of_each_other() {
    let all: Vec<Vec<[f64; 2]>> = (0..32).map(jitters).collect();
    let between = |pair: Pair<'_>| {
        let pairs: Vec<[f64; 2]> = all.iter().flat_map(|cells| (1..64).map(|c| pair(cells, c))).collect();
        (correlation(&pairs), 5.0 / (pairs.len() as f64).sqrt())
    };
    let kinds: [(&str, Pair<'_>); 4] = [
        ("the two coordinates of a cell", &|cells, c| cells[c]),
        ("the first coordinates of neighbours", &|cells, c| [cells[c - 1][0], cells[c][0]]),
        ("a second coordinate and the neighbour's first", &|cells, c| [cells[c - 1][1], cells[c][0]]),
        ("a first coordinate and the neighbour's second", &|cells, c| [cells[c - 1][0], cells[c][1]]),
    ];
    for (what, pair) in kinds {
        let (found, limit) = between(pair);
        println!("jitter, {what}: correlation {found:.3}");
        assert!(found.abs() <= limit, "{what} are correlated: {found}");
    }
    let (same, limit) = between(&|cells, c| [cells[c][0], cells[c][0] + 1.0]);
    assert!(same.abs() > limit, "the measure sees what is the same");
}

#[test]
fn seeds_one_apart_share_no_pass() {
    // Passes take further seeds; a caller who averages calls with seeds 0 and 1 counts on new samples.
    let box_over = scene(&plate([-0.3, 0.2], [-0.1, 0.4], 1.0));
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 2.0]);
    let receivers = points(Random(3).points(200, [-0.6, 0.6], [-0.6, 0.6], [0.0, 0.0]));
    let run = |seed, passes| {
        let settings = softshadow::RayTraced { samples: 64, seed, passes, ..Default::default() };
        see(&box_over, std::slice::from_ref(&light), &receivers, &softshadow::Technique::RayTraced(settings))
    };
    // The masks are those of the last pass.
    let (second_of_first, first_of_second) = (run(0, 2).masks.unwrap().bits, run(1, 1).masks.unwrap().bits);
    let same = second_of_first.iter().zip(&first_of_second).filter(|(a, b)| a == b).count();
    println!("pass 1 of seed 0 and pass 0 of seed 1: {same} of {} words equal", second_of_first.len());
    assert!(same * 2 < second_of_first.len(), "pass 1 of seed 0 repeats pass 0 of seed 1");
}

#[test]
fn standard_errors_cover_as_often_as_they_claim() {
    // Exact intervals of Student's t cover 95 %; receivers of one seed err together, so there are many seeds.
    let occluder = measure::AxisRectangle { x: [-0.4, 0.5], y: [-0.2, 0.3], z: 0.8 };
    let lamp_area = measure::AxisRectangle { x: [-0.5, 0.5], y: [-0.3, 0.3], z: 2.0 };
    let shade = scene(&plate(occluder.x, occluder.y, occluder.z));
    let light = lamp(rectangle(1.0, 0.6), [0.0, 0.0, 2.0]);
    let quantile = measure::t_quantile_975(15).unwrap();
    let (mut covered, mut covered_by_half, mut penumbra) = (0, 0, 0);
    for seed in 0..40 {
        let positions = Random(u64::from(seed)).points(64, [-1.0, 1.0], [-0.8, 0.8], [0.0, 0.0]);
        let settings = softshadow::RayTraced { samples: 64, seed: 100 * seed, passes: 16, ..Default::default() };
        let technique = softshadow::Technique::RayTraced(settings);
        let seen = see(&shade, std::slice::from_ref(&light), &points(positions.clone()), &technique);
        let errors = seen.standard_error.unwrap();
        for ((p, value), error) in positions.iter().zip(&seen.values).zip(&errors) {
            let truth = measure::rectangle_over_rectangle(*p, &occluder, &lamp_area).unwrap();
            if (0.05..0.95).contains(&truth) {
                let off = (f64::from(*value) - truth).abs();
                penumbra += 1;
                covered += usize::from(off <= quantile * f64::from(*error));
                covered_by_half += usize::from(off <= 0.5 * quantile * f64::from(*error));
            }
        }
    }
    let share = |count: usize| count as f64 / penumbra as f64;
    println!(
        "coverage of ±t(.975, 15) SE: {:.3} of {penumbra}; of half of it {:.3}",
        share(covered),
        share(covered_by_half)
    );
    assert!((0.90..=0.99).contains(&share(covered)), "{}", share(covered));
    assert!(share(covered_by_half) < 0.90, "an error half as large would be found out");
}
