//! Defects of known size are measured at their size.

use softshadow_measure::{ErrorReport, MeasureError, ReferenceImage, compare, true_error_interval};

const WIDTH: usize = 64;

/// Columns 0..16 umbra, 16..48 a linear penumbra, 48..64 lit; the last row has no receivers.
fn reference() -> Vec<f32> {
    (0..WIDTH * WIDTH)
        .map(|pixel| {
            let (x, y) = (pixel % WIDTH, pixel / WIDTH);
            if y == WIDTH - 1 {
                return f32::NAN;
            }
            ((x as f32 - 15.5) / 32.0).clamp(0.0, 1.0)
        })
        .collect()
}

fn report(estimate: &[f32]) -> ErrorReport {
    let visibility = reference();
    let image = ReferenceImage { visibility: &visibility, standard_error: None, width: Some(WIDTH) };
    compare(estimate, &image).unwrap()
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-6
}

#[test]
fn a_perfect_image_has_no_error() {
    let found = report(&reference());
    let overall = found.overall.unwrap();
    assert_eq!(overall.count, WIDTH * (WIDTH - 1));
    assert_eq!((overall.rmse, overall.max, overall.bias), (0.0, 0.0, 0.0));
    assert_eq!(found.penumbra.unwrap().count, 32 * (WIDTH - 1));
    assert_eq!(found.penumbra_or_wrong, found.penumbra);
    assert_eq!(found.leak_fraction, Some(0.0));
    assert_eq!(found.false_shadow_fraction, Some(0.0));
    assert_eq!((found.gross_count, found.largest_gross_component), (0, Some(0)));
    assert_eq!(found.penumbra_reference_se, None);
}

#[test]
fn a_bias_is_signed() {
    let darker: Vec<f32> = reference().iter().map(|v| v - 0.03).collect();
    let found = report(&darker);
    let penumbra = found.penumbra.unwrap();
    assert!(close(penumbra.bias, -0.03) && close(penumbra.rmse, 0.03));
    assert!(close(penumbra.mae, 0.03) && close(penumbra.p95, 0.03) && close(penumbra.max, 0.03));
    // Every pixel is visibly wrong, so this set is the whole image.
    assert_eq!(found.penumbra_or_wrong.unwrap().count, WIDTH * (WIDTH - 1));
    assert_eq!(found.false_shadow_fraction, Some(0.0));
    let lighter: Vec<f32> = reference().iter().map(|v| v + 0.03).collect();
    assert!(close(report(&lighter).penumbra.unwrap().bias, 0.03));
}

#[test]
fn a_leak_and_a_false_shadow_are_told_apart() {
    let mut leaking = reference();
    let block = |image: &mut [f32], x0: usize, value: f32| {
        for y in 8..16 {
            image[y * WIDTH + x0..][..8].fill(value);
        }
    };
    block(&mut leaking, 4, 0.2);
    let found = report(&leaking);
    let umbra = 16.0 * (WIDTH - 1) as f64;
    assert!(close(found.leak_fraction.unwrap(), 64.0 / umbra));
    assert_eq!(found.false_shadow_fraction, Some(0.0));
    // The penumbra alone does not see it; the dilated set does.
    assert_eq!(found.penumbra.unwrap().max, 0.0);
    assert_eq!(found.penumbra_or_wrong.unwrap().count, 32 * (WIDTH - 1) + 64);
    assert_eq!(found.gross_count, 0);

    let mut shadowed = reference();
    block(&mut shadowed, 52, 0.8);
    let found = report(&shadowed);
    assert_eq!(found.leak_fraction, Some(0.0));
    assert!(close(found.false_shadow_fraction.unwrap(), 64.0 / umbra));
}

#[test]
fn gross_defects_are_counted_and_grouped() {
    let mut image = reference();
    // An L of 5 and a pixel that touches it only at a corner.
    let corner = [(2, 2), (2, 3), (2, 4), (3, 4), (4, 4), (5, 5)];
    // Groups of 3 that would join into 6 if a row's end touched the next row's start, going left and going right.
    let leftwards = [(0, 20), (0, 21), (0, 22), (61, 20), (62, 20), (63, 20)];
    let rightwards = [(61, 30), (62, 30), (63, 30), (0, 31), (1, 31), (2, 31)];
    for (x, y) in [corner, leftwards, rightwards].concat() {
        image[y * WIDTH + x] = if x > 32 { 0.0 } else { 1.0 };
    }
    let found = report(&image);
    assert_eq!((found.gross_count, found.largest_gross_component), (18, Some(5)));
    image[4 * WIDTH + 5] = 1.0;
    let found = report(&image);
    assert_eq!((found.gross_count, found.largest_gross_component), (19, Some(7)));
}

#[test]
fn percentiles_are_nearest_ranks() {
    let visibility = vec![0.5_f32; 110];
    let estimate: Vec<f32> = (1..=110).map(|k| 0.5 + k as f32 / 1000.0).collect();
    let image = ReferenceImage { visibility: &visibility, standard_error: Some(&[0.001; 110]), width: None };
    let found = compare(&estimate, &image).unwrap();
    let penumbra = found.penumbra.unwrap();
    assert!(close(penumbra.p95, 0.105) && close(penumbra.p99, 0.109) && close(penumbra.max, 0.11));
    assert!(close(penumbra.mae, 0.0555));
    assert!(close(penumbra.rmse, (449_735.0_f64 / 110.0).sqrt() / 1000.0));
    assert!(close(found.penumbra_reference_se.unwrap(), 0.001));
    assert_eq!(found.largest_gross_component, None);
    assert_eq!((found.leak_fraction, found.false_shadow_fraction), (None, None));
}

#[test]
fn an_interval_holds_the_error_against_the_truth_as_long_as_the_reference_knows_its_own() {
    let count = 20_000_u32;
    // Reference errors that the estimate shares, has nothing of, or has the other way round.
    let wave = |k: u32, step: f64| (f64::from(k) * step).sin() * std::f64::consts::SQRT_2;
    for (own, shared, noise) in [(0.02, 0.0, 0.005), (0.0, 1.0, 0.01), (0.003, -1.0, 0.01), (0.01, 0.5, 0.0)] {
        let reference_error = |k: u32| noise * wave(k, 0.7);
        let estimate_error = |k: u32| own * wave(k, 1.9) + shared * reference_error(k);
        let truth = |k: u32| 0.2 + 0.6 * f64::from(k) / f64::from(count);
        let visibility: Vec<f32> = (0..count).map(|k| (truth(k) + reference_error(k)) as f32).collect();
        let estimate: Vec<f32> = (0..count).map(|k| (truth(k) + estimate_error(k)) as f32).collect();
        let image = ReferenceImage { visibility: &visibility, standard_error: None, width: None };
        let measured = compare(&estimate, &image).unwrap().penumbra.unwrap().rmse;
        let exact = ((0..count).map(|k| estimate_error(k).powi(2)).sum::<f64>() / f64::from(count)).sqrt();
        let [low, high] = true_error_interval(measured, noise);
        assert!((low - 1e-6..=high + 1e-6).contains(&exact), "{exact} outside {low}..{high}");
        // A reference that thinks too well of itself is found out.
        let [low, high] = true_error_interval(measured, noise / 100.0);
        let outside = !(low - 1e-6..=high + 1e-6).contains(&exact);
        assert_eq!(outside, noise > 0.0, "{exact} and {low}..{high}");
    }
}

#[test]
fn nothing_measured_is_not_no_error() {
    let empty = ReferenceImage { visibility: &[f32::NAN; 4], standard_error: Some(&[f32::NAN; 4]), width: Some(2) };
    let found = compare(&[f32::NAN; 4], &empty).unwrap();
    assert_eq!((found.overall, found.penumbra), (None, None));
    assert_eq!(found.penumbra_reference_se, None);
}

#[test]
fn the_table_prints_every_row() {
    let darker: Vec<f32> = reference().iter().map(|v| v - 0.03).collect();
    let table = report(&darker).to_string();
    let penumbra = table.lines().find(|line| line.starts_with("penumbra  "));
    assert!(penumbra.unwrap().ends_with("-0.03000"), "{table}");
    assert!(penumbra.unwrap().contains("2016"), "{table}");
    assert!(table.contains("leaks 0.00000") && table.contains("reference SE -"), "{table}");
}

#[test]
fn images_that_cannot_be_compared_are_typed_errors() {
    let check = |estimate: &[f32], visibility: &[f32], se: Option<&[f32]>, width| {
        let image = ReferenceImage { visibility, standard_error: se, width };
        compare(estimate, &image).unwrap_err()
    };
    let nan = f32::NAN;
    let good = [0.5, nan];
    let length = |what, expected, found| MeasureError::LengthMismatch { what, expected, found };
    assert_eq!(check(&[0.5], &good, None, None), length("the estimate", 2, 1));
    assert_eq!(check(&good, &good, Some(&[0.1]), None), length("the reference's standard error", 2, 1));
    let validity = MeasureError::ValidityMismatch { index: 1 };
    assert_eq!(check(&[0.5, 0.5], &good, None, None), validity);
    assert_eq!(check(&good, &[0.5, 0.5], None, None), validity);
    let infinite = check(&[f32::INFINITY, nan], &good, None, None);
    assert!(matches!(infinite, MeasureError::NotFinite { index: 0, .. }));
    let not_a_reference = MeasureError::NotAReference { index: 0 };
    assert_eq!(check(&[0.5], &[1.1], None, None), not_a_reference);
    for se in [-0.1, nan, f32::INFINITY] {
        assert_eq!(check(&[0.5], &[0.5], Some(&[se]), None), not_a_reference);
    }
    for width in [0, 3] {
        let refused = check(&good, &good, None, Some(width));
        assert!(matches!(refused, MeasureError::Degenerate { .. }));
    }
}
