//! Planted bugs: each is caught by the metric that is there for it, and the others stay silent.

use softshadow_measure::{ErrorReport, Frame, MeasureError, ReferenceImage, compare, compare_frames};

use crate::random::Random;

const WIDTH: usize = 96;

/// Two straight shadow edges of different softness, off the grid.
fn truth(light: f32) -> Vec<f32> {
    let pixel = |at: usize| {
        let (x, y) = ((at % WIDTH) as f32, (at / WIDTH) as f32);
        let edge = |across: f32, width: f32| (across / width + 0.5).clamp(0.0, 1.0);
        edge(x - 30.0 - light + 0.3 * y, 24.0).min(edge(70.0 + light - 0.2 * y - 0.9 * x, 11.0) + 0.25).min(1.0)
    };
    (0..WIDTH * WIDTH).map(pixel).collect()
}

/// As good as 64 samples are, everywhere.
fn honest(light: f32, seed: u64) -> Vec<f32> {
    let mut random = Random::new(seed);
    let noisy = |v: f32| if v > 0.0 && v < 1.0 { v + 0.02 * (random.unit() as f32 - 0.5) } else { v };
    truth(light).into_iter().map(noisy).collect()
}

fn report(estimate: &[f32]) -> ErrorReport {
    let visibility = truth(0.0);
    compare(estimate, &ReferenceImage { visibility: &visibility, standard_error: None, width: Some(WIDTH) }).unwrap()
}

/// What each metric says: leak, bias, banding, shift.
fn alarms(found: &ErrorReport) -> [bool; 4] {
    let structure = found.structure.unwrap();
    [
        found.leak_fraction.unwrap() > 0.0,
        found.penumbra.unwrap().bias.abs() > 0.01,
        structure.banding_fraction > 0.2,
        structure.shift != [0, 0],
    ]
}

#[test]
fn an_honest_image_raises_no_alarm() {
    assert_eq!(alarms(&report(&honest(0.0, 1))), [false; 4]);
    assert_eq!(alarms(&report(&truth(0.0))), [false; 4]);
}

#[test]
fn every_planted_bug_is_caught_by_its_metric_alone() {
    let mut leak = honest(0.0, 2);
    let umbra: Vec<usize> = (0..leak.len()).filter(|p| truth(0.0)[*p] == 0.0).take(30).collect();
    umbra.iter().for_each(|pixel| leak[*pixel] = 1.0);
    assert_eq!(alarms(&report(&leak)), [true, false, false, false]);
    assert!(report(&leak).structure.unwrap().gradient_error_max < 0.1, "no edge of it lies in the penumbra");

    let in_penumbra = |v: &f32| *v > 0.0 && *v < 1.0;
    let darker: Vec<f32> = honest(0.0, 3).iter().map(|v| if in_penumbra(v) { v - 0.02 } else { *v }).collect();
    assert_eq!(alarms(&report(&darker)), [false, true, false, false]);

    let bands: Vec<f32> = truth(0.0).iter().map(|v| (v * 8.0).round() / 8.0).collect();
    assert_eq!(alarms(&report(&bands)), [false, false, true, false]);

    let plain = honest(0.0, 4);
    let shifted: Vec<f32> =
        (0..plain.len()).map(|at| if at % WIDTH == 0 { plain[at] } else { plain[at - 1] }).collect();
    let found = report(&shifted);
    assert_eq!((alarms(&found)[3], found.structure.unwrap().shift), (true, [1, 0]));
    assert_eq!(&alarms(&found)[..3], [false; 3]);

    // One pixel of another brightness in the penumbra: only the gradient tells it from noise.
    let mut speckle = honest(0.0, 5);
    speckle[40 * WIDTH + 20] += 0.5;
    assert!(report(&speckle).structure.unwrap().gradient_error_max > 0.4);
    assert!(report(&honest(0.0, 5)).structure.unwrap().gradient_error_max < 0.03);
}

#[test]
fn what_flickers_is_told_from_what_moves() {
    let lights: Vec<f32> = (0..8).map(|frame| 0.7 * frame as f32).collect();
    let truths: Vec<Vec<f32>> = lights.iter().map(|light| truth(*light)).collect();
    let sweep = |values: &dyn Fn(usize) -> Vec<f32>| {
        let made: Vec<Vec<f32>> = (0..truths.len()).map(values).collect();
        let frame = |(values, reference)| Frame { values, reference, standard_error: None };
        let frames: Vec<Frame<'_>> =
            made.iter().zip(&truths).map(|(a, b)| frame((a.as_slice(), b.as_slice()))).collect();
        compare_frames(&frames).unwrap().unwrap()
    };
    // A constant bias does not flicker, however the light moves.
    let biased = sweep(&|frame| truths[frame].iter().map(|v| v + 0.05).collect());
    assert!(biased.flicker < 1e-6 && biased.largest_jump < 1e-6, "{biased:?}");
    // Noise of another seed in each frame: a uniform law of width 0.02, twice.
    let noisy = sweep(&|frame| honest(lights[frame], 10 + frame as u64));
    assert!((noisy.flicker / (0.02 / 12_f64.sqrt() * 2_f64.sqrt()) - 1.0).abs() < 0.1, "{noisy:?}");
    // One frame pops.
    let pops = sweep(&|frame| truths[frame].iter().map(|v| if frame == 4 { v * 0.8 } else { *v }).collect());
    assert!(pops.largest_jump > 0.15 && pops.flicker > 0.03, "{pops:?}");
}

#[test]
fn sweeps_that_cannot_be_compared_are_typed_errors() {
    let (short, long) = ([0.5_f32; 2], [0.5_f32; 3]);
    let frame = |values, reference| Frame { values, reference, standard_error: None };
    let one = compare_frames(&[frame(&short[..], &short[..])]);
    assert_eq!(one, Err(MeasureError::TooFew { what: "frames", minimum: 2 }));
    let two = [frame(&short[..], &short[..]), frame(&short[..], &long[..])];
    assert!(matches!(compare_frames(&two), Err(MeasureError::LengthMismatch { expected: 2, found: 3, .. })));
    let lit = [1.0_f32; 2];
    assert_eq!(compare_frames(&[frame(&lit[..], &lit[..]); 2]), Ok(None));
}
