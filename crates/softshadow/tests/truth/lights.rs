//! What every light does: one front, a limit without size, textures, company, probes.

use softshadow::{
    Light, LightShape, LightTexture, Options, RayTraced, Receivers, SamplePattern, Technique, light_points, measure,
    visibility,
};

use crate::common::{
    Random, bits, context, depth_complexity, hard_shadow_map, lamp, points, ray_traced, rays, rectangle, see, shipped,
    surface_points,
};
use crate::shapes::{Point, plate, scene};

/// One light of each shape, a unit over the origin or a unit above the horizon.
fn one_of_each() -> Vec<(&'static str, Light)> {
    let at = [0.0, 0.0, 1.0];
    let triangle = vec![[-0.3, -0.3], [0.4, -0.2], [0.0, 0.4]];
    vec![
        ("rectangle", lamp(rectangle(0.6, 0.4), at)),
        ("disc", lamp(LightShape::Disc { radius: 0.3 }, at)),
        ("sphere", lamp(LightShape::Sphere { radius: 0.3 }, at)),
        ("polygon", lamp(LightShape::Polygon { outline: triangle }, at)),
        ("sun", lamp(LightShape::Sun { angular_diameter: 0.1 }, at)),
    ]
}

#[test]
fn flat_lights_shine_to_the_front_and_round_ones_all_around() {
    // A triangle far away, so that there is a scene that shades nothing.
    let far = scene(&plate([50.0, 51.0], [50.0, 51.0], 0.0)[..1]);
    let (front, back, inside) = ([0.2, 0.1, 0.0], [0.2, 0.1, 2.0], [0.0, 0.1, 1.1]);
    for (name, light) in one_of_each() {
        for technique in [ray_traced(64), hard_shadow_map(64), depth_complexity(64)] {
            let values = see(&far, std::slice::from_ref(&light), &points(vec![front, back, inside]), &technique).values;
            let expected = match name {
                "sphere" | "sun" => [1.0, 1.0, 1.0],
                _ => [1.0, 0.0, 0.0],
            };
            assert_eq!(values, expected, "{name}, {}", technique.name());
            // A surface that faces away sees nothing of any of them.
            let turned = surface_points(vec![front], [0.0, 0.0, -1.0]);
            let value = see(&far, std::slice::from_ref(&light), &turned, &technique).values[0];
            assert_eq!(value, 0.0, "{name}, {}, turned away", technique.name());
        }
    }
}

#[test]
fn a_light_without_size_casts_the_hard_shadow_that_small_ones_approach() {
    let (occluder, center) = (plate([-0.3, 0.4], [-0.2, 0.25], 0.7), [0.15, -0.1, 2.0]);
    let shade = scene(&occluder);
    // A grid that meets the shadow's border nowhere.
    let receivers: Vec<Point> =
        (0..4096).map(|i| [f64::from(i % 64) * 0.031 - 1.0, f64::from(i / 64) * 0.031 - 1.0, 0.0]).collect();
    let k = 2.0 / 0.7;
    let hidden = |p: &Point| {
        let [x, y] = [0, 1].map(|i| p[i] + (center[i] - p[i]) / k);
        (-0.3..=0.4).contains(&x) && (-0.2..=0.25).contains(&y)
    };
    let truth: Vec<f32> = receivers.iter().map(|p| if hidden(p) { 0.0 } else { 1.0 }).collect();
    type OfSize = fn(f64) -> LightShape;
    let shapes: [(&str, OfSize); 4] = [
        ("rectangle", |s| rectangle(s, s)),
        ("disc", |s| LightShape::Disc { radius: s }),
        ("sphere", |s| LightShape::Sphere { radius: s }),
        ("sun", |s| LightShape::Sun { angular_diameter: s }),
    ];
    for (name, shape) in shapes {
        let of = |size| {
            let receivers = points(receivers.clone());
            see(&shade, &[lamp(shape(size), center)], &receivers, &ray_traced(16)).values
        };
        let hard = of(0.0);
        assert!(hard.iter().all(|v| *v == 0.0 || *v == 1.0), "{name}: a shadow without penumbra");
        let off = |values: &[f32]| values.iter().zip(&hard).filter(|(a, b)| a != b).count();
        let counts: Vec<usize> = [0.3, 1e-1, 1e-3, 1e-6, 1e-12].map(|size| off(&of(size))).to_vec();
        println!(
            "{name}: receivers that differ from the hard shadow at sizes 0.3, 1e-1, 1e-3, 1e-6, 1e-12: {counts:?}"
        );
        assert!(counts.is_sorted_by(|a, b| a >= b) && counts[0] > 200, "{name}: {counts:?}");
        assert_eq!(counts[3..], [0, 0], "{name}");
        if name != "sun" {
            assert_eq!(hard, truth, "{name}: the hard shadow of the light's centre");
        }
    }
}

#[test]
fn a_textured_light_counts_each_sample_by_its_radiance() {
    let light = lamp(rectangle(1.0, 0.8), [0.0, 0.0, 2.0]);
    // Red only on the half with x > 0, green only on the other, blue nowhere.
    let texels = (0..64).map(|x| if x < 32 { [0.0, 2.0, 0.0] } else { [3.0, 0.0, 0.0] }).collect();
    let texture = LightTexture::new(64, 1, texels).unwrap();
    let textured = light.clone().with_texture(texture.clone()).unwrap();
    let shade = scene(&plate([-0.25, 0.3], [-0.2, 0.3], 0.9));
    let positions = Random(8).points(500, [-0.9, 0.9], [-0.9, 0.9], [0.0, 0.0]);
    let settings = RayTraced { seed: 3, ..rays(256) };
    let receivers = points(positions.clone());
    let technique = Technique::RayTraced(settings.clone());
    let seen = see(&shade, &[textured], &receivers, &technique);
    let plain = see(&shade, std::slice::from_ref(&light), &receivers, &technique);
    assert_eq!((seen.channels, plain.channels), (3, 1));
    let samples = light_points(&shade, &light, &settings.sampling(0), &[], 0).unwrap();
    let radiance: Vec<[f32; 3]> =
        samples.parameters.iter().map(|p| texture.at(f64::from(p[0]), f64::from(p[1]))).collect();
    let masks = seen.masks.as_ref().unwrap();
    let half = |x: [f64; 2]| measure::AxisRectangle { x, y: [-0.4, 0.4], z: 2.0 };
    let occluder = measure::AxisRectangle { x: [-0.25, 0.3], y: [-0.2, 0.3], z: 0.9 };
    let (mut worst_sum, mut worst_half, mut apart) = (0.0_f64, 0.0_f64, 0);
    for (i, p) in positions.iter().enumerate() {
        let visible = |s: usize| masks.bits[i * masks.words + s / 32] >> (s % 32) & 1 == 0;
        for channel in [0, 1] {
            let sum = |count: &dyn Fn(usize) -> bool| -> f64 {
                (0..256).filter(|s| count(*s)).map(|s| f64::from(radiance[s][channel])).sum()
            };
            let value = f64::from(seen.values[3 * i + channel]);
            worst_sum = worst_sum.max((value - sum(&visible) / sum(&|_| true)).abs());
            let own_half = if channel == 0 { [0.0, 0.5] } else { [-0.5, 0.0] };
            let truth = measure::rectangle_over_rectangle(*p, &occluder, &half(own_half)).unwrap();
            worst_half = worst_half.max((value - truth).abs());
        }
        apart += usize::from((seen.values[3 * i] - seen.values[3 * i + 1]).abs() > 0.2);
        assert_eq!(seen.values[3 * i + 2], plain.values[i], "a channel without light is measured by area");
    }
    println!(
        "textured light: off the sum by {worst_sum:.1e}, off its own half by {worst_half:.3}; {apart} of 500 halves apart"
    );
    assert!(worst_sum < 1e-5, "{worst_sum}");
    // 128 samples a half: strata along an edge, and the texture's ramp of one texel in 64.
    assert!(worst_half < 0.05, "{worst_half}");
    assert!(apart > 50, "were the halves exchanged, the difference would be seen");
}

#[test]
fn several_lights_in_one_call_are_as_many_calls() {
    let shade = scene(&plate([-0.4, 0.3], [-0.3, 0.2], 0.5));
    let receivers = points(Random(6).points(2000, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]));
    let lights: Vec<Light> = one_of_each().into_iter().map(|(_, light)| light).collect();
    for technique in [Technique::RayTraced(RayTraced { passes: 3, ..rays(40) }), hard_shadow_map(256)] {
        let together = see(&shade, &lights, &receivers, &technique);
        let apart: Vec<_> =
            lights.iter().map(|l| see(&shade, std::slice::from_ref(l), &receivers, &technique)).collect();
        let joined: (Vec<u32>, Vec<u32>) =
            (apart.iter().flat_map(|v| bits(v).0).collect(), apart.iter().flat_map(|v| bits(v).1).collect());
        assert!(bits(&together) == joined, "{}", technique.name());
        let errors = |v: &softshadow::Visibility| v.standard_error.clone().unwrap_or_default();
        assert_eq!(errors(&together), apart.iter().flat_map(errors).collect::<Vec<_>>());
        assert!(bits(&apart[0]).0 != bits(&apart[4]).0, "the sun is no rectangle");
    }
}

#[test]
fn probes_change_little_and_only_where_they_agree() {
    let (scene, light, camera) = shipped("hall", [128, 96]);
    let run = |probes| {
        let technique = Technique::RayTraced(RayTraced { probes, ..rays(256) });
        see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique)
    };
    let full = run(0);
    for probes in [8, 16, 64] {
        let seen = run(probes);
        let image = measure::ReferenceImage { visibility: &full.values, standard_error: None, width: Some(128) };
        let report = measure::compare(&seen.values, &image).unwrap();
        let (overall, other) = (report.overall.unwrap(), full.values.iter().zip(&seen.values));
        let changed = other.clone().filter(|(a, b)| !a.is_nan() && a != b).count();
        println!(
            "{probes} probes of 256: {changed} of {} pixels differ, RMSE {:.1e}, max {:.3}",
            overall.count, overall.rmse, overall.max
        );
        // A pixel whose probes disagree is traced in full; the others take the verdict of their probes.
        assert!(other.clone().all(|(a, b)| a.is_nan() || a == b || *b == 0.0 || *b == 1.0), "{probes} probes");
        assert_eq!(seen.valid, full.valid);
        assert!(overall.rmse < 0.01 && report.gross_count == 0, "{probes} probes: {report}");
        assert!(changed > 0 || probes == 64, "probes that never decide are no probes");
    }
}

#[test]
fn patterns_agree_within_their_errors() {
    let (scene, light, camera) = shipped("hall", [64, 48]);
    let run = |pattern, seed| {
        let technique = Technique::RayTraced(RayTraced { pattern, passes: 16, seed, ..rays(64) });
        see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique)
    };
    let (a, b) = (run(SamplePattern::Stratified, 0), run(SamplePattern::LowDiscrepancy, 50));
    assert_ne!(a.values, b.values);
    let within = |shift: f64| {
        let (mut close, mut penumbra) = (0, 0);
        let errors = a.standard_error.as_ref().unwrap().iter().zip(b.standard_error.as_ref().unwrap());
        for ((x, y), (ex, ey)) in a.values.iter().zip(&b.values).zip(errors) {
            if *x > 0.02 && *x < 0.98 {
                let error = f64::from(*ex).hypot(f64::from(*ey)).max(1.0 / 1024.0);
                penumbra += 1;
                close += usize::from((f64::from(x - y) + shift).abs() <= 3.0 * error);
            }
        }
        println!("patterns, {shift} apart: {close} of {penumbra} penumbra pixels within 3 errors of each other");
        (close, penumbra)
    };
    let (close, penumbra) = within(0.0);
    assert!(penumbra > 200 && close * 100 >= penumbra * 98, "{close} of {penumbra}");
    let (close, penumbra) = within(0.02);
    assert!(close * 100 < penumbra * 90, "a difference of 0.02 is seen");
}

#[test]
fn without_a_wish_nothing_is_returned() {
    let shade = scene(&plate([-0.4, 0.3], [-0.3, 0.2], 0.5));
    let light = lamp(rectangle(0.3, 0.3), [0.0, 0.0, 2.0]);
    let seen = visibility(
        context(),
        &shade,
        &[light],
        &points(vec![[0.0; 3]]),
        &ray_traced(16),
        &Options::default(),
        &mut |_, _| true,
    );
    let seen = seen.unwrap();
    assert!(seen.standard_error.is_none() && seen.masks.is_none() && seen.placed.is_none());
    assert_eq!((seen.values.len(), seen.info.error_kind), (1, "statistical"));
}
