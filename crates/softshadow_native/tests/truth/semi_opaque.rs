//! Two counters: opaque layers, and the attenuation of semi-opaque ones.

use softshadow_native::depth_complexity::{Coverage, Receiver};
use softshadow_scene::{LightTexture, LocalFrame};

use crate::scene::{Random, Setup, Soup, opaque};
use crate::shapes::{above, aimed, ball, leaves, plate, shapes, soup, square, torus};

/// Opacities by the triangle's index, opaque ones among them.
fn mixed(triangle: usize) -> f32 {
    [0.5, 1.0, 0.25, 0.9, 0.0, 0.5, 0.75][triangle % 7]
}

/// What passes to each sample, by float64 crossings.
fn passed(setup: &Setup, receiver: &Receiver) -> Vec<f64> {
    let from = Setup::true_receiver(receiver);
    let crossing = |t: &_| setup.tracer.crossings(&from, t);
    setup
        .targets(receiver)
        .iter()
        .map(|target| crossing(target).iter().map(|i| 1.0 - f64::from((setup.opacity)(*i))).product())
        .collect()
}

#[test]
fn every_crossing_attenuates() {
    let mut random = Random(41);
    let meshes: [(&str, Soup); 2] = [
        ("leaves", leaves(&mut random, 120, 0.4, [-0.5; 3], [0.5; 3])),
        ("bodies", [soup(&torus([0.0; 3], 0.4, 0.2, 20, 10)), soup(&ball([0.1, 0.0, 0.3], 0.3, 2))].concat()),
    ];
    for (name, mesh) in meshes {
        for (shape_name, shape) in shapes(1.0, 3.0) {
            let light = aimed(shape, [0.3, 0.4, 3.0], [0.0; 3]);
            let setup = Setup::in_frame(mesh.clone(), LocalFrame::around(None), light, 64, mixed);
            let (mut worst, mut partly): (f64, usize) = (0.0, 0);
            for _ in 0..2000 {
                let position = random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.6]);
                let receiver = Receiver { position, ..Receiver::default() };
                let truth = passed(&setup, &receiver);
                let seen = setup.see(&receiver);
                worst = worst.max((f64::from(seen.sampled) - truth.iter().sum::<f64>() / 64.0).abs());
                partly += truth.iter().filter(|t| **t > 0.0 && **t < 1.0).count();
                for (sample, t) in truth.iter().enumerate() {
                    assert_eq!(seen.hidden[0] >> sample & 1 == 1, *t == 0.0, "{name} {shape_name} {position:?}");
                }
            }
            assert!(partly > 5000, "{name}: {partly} samples are attenuated");
            // A layer's attenuation is known to half a unit of 1/4096 of a halving, 8.5e-5 of itself; several layers to several.
            assert!(worst < 3e-4, "{name} {shape_name}: {worst}");
        }
    }
}

#[test]
fn two_half_sheets_pass_a_quarter_and_a_hole_in_one_passes_half() {
    let half = |_: usize| 0.5;
    let sheets = [plate([0.0, 0.0, 0.0], 0.9), plate([0.0, 0.0, 0.3], 0.9)].concat();
    let light = above(square(0.5), [0.0, 0.0, 3.0]);
    let setup = Setup::in_frame(sheets, LocalFrame::around(None), light.clone(), 64, half);
    let under = Receiver { position: [0.05, 0.05, -0.5], ..Receiver::default() };
    assert_eq!(setup.see(&under).sampled, 0.25);
    let one = Setup::in_frame(plate([0.0, 0.0, 0.0], 0.9), LocalFrame::around(None), light, 64, half);
    assert_eq!(one.see(&under).sampled, 0.5);
    assert!(one.technique(Coverage::Exact, true).see::<1>(&under).by_area.is_none(), "areas know no opacity");
}

#[test]
fn semi_opaque_geometry_in_a_ball_of_light() {
    let mut random = Random(42);
    let mesh = leaves(&mut random, 60, 0.5, [-0.6, -0.6, 0.5], [0.6, 0.6, 1.3]);
    let light = above(softshadow_scene::LightShape::Sphere { radius: 0.4 }, [0.0, 0.0, 1.0]);
    let setup = Setup::in_frame(mesh, LocalFrame::around(None), light, 64, mixed);
    assert!(setup.occluders.touching.len() > 10);
    let mut differing = 0;
    for _ in 0..2000 {
        let receiver = Receiver { position: random.point([-1.0, -1.0, -0.9], [1.0, 1.0, 0.2]), ..Receiver::default() };
        let truth = passed(&setup, &receiver).iter().sum::<f64>() / 64.0;
        differing += usize::from((f64::from(setup.see(&receiver).sampled) - truth).abs() > 3e-4);
    }
    // One of the 128,000 samples lies 2e-7 from an edge.
    assert!(differing <= 1, "{differing} receivers differ");
}

#[test]
fn textured_lights_weigh_what_passes() {
    let mut random = Random(43);
    let mesh = [leaves(&mut random, 60, 0.4, [-0.5; 3], [0.5; 3]), soup(&ball([0.0; 3], 0.2, 2))].concat();
    let texture = LightTexture::new(2, 2, vec![[1.0, 0.0, 0.3], [0.0, 2.0, 0.3], [0.5, 0.1, 0.3], [0.0, 0.0, 0.3]]);
    let light = aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]).with_texture(texture.unwrap()).unwrap();
    for opacity in [opaque, mixed] {
        let setup = Setup::in_frame(mesh.clone(), LocalFrame::around(None), light.clone(), 64, opacity);
        let radiance = &setup.parameters.radiance;
        let mut coloured = 0;
        for _ in 0..1000 {
            let position = random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.6]);
            let receiver = Receiver { position, ..Receiver::default() };
            let (seen, truth) = (setup.see(&receiver).textured(radiance), passed(&setup, &receiver));
            for channel in 0..3 {
                let of = |s: usize| f64::from(radiance[s][channel]);
                let (all, through) = (0..64).fold((0.0, 0.0), |(a, t), s| (a + of(s), t + of(s) * truth[s]));
                assert!((f64::from(seen[channel]) - through / all).abs() < 3e-4, "{position:?}: {seen:?}");
            }
            coloured += usize::from((seen[0] - seen[1]).abs() > 0.05);
        }
        assert!(coloured > 30, "{coloured} receivers see coloured light");
    }
    // A channel without light returns the share of the samples.
    let setup = Setup::in_frame(mesh, LocalFrame::around(None), light, 64, mixed);
    let seen = setup.see(&Receiver { position: [0.1, 0.0, -0.8], ..Receiver::default() });
    assert_eq!(seen.textured(&[[0.0; 3]; 64]), [seen.sampled; 3]);
}

#[test]
fn more_layers_than_counters_hold_are_told() {
    let almost = |_: usize| 0.999_999_94;
    let stack =
        |layers: usize| -> Soup { (0..layers).flat_map(|i| plate([0.0, 0.0, -0.5 + i as f64 * 1e-5], 0.2)).collect() };
    let light = above(square(1.0), [0.1, 0.05, 3.0]);
    for (layers, overflows) in [(200, false), (24_000, true)] {
        let setup = Setup::in_frame(stack(layers), LocalFrame::around(None), light.clone(), 64, almost);
        let seen = setup.see(&Receiver { position: [0.19, 0.0, -0.6], ..Receiver::default() });
        assert_eq!(seen.overflowed, overflows, "{layers} layers");
        if !overflows {
            assert!(seen.sampled > 0.0 && seen.sampled < 1.0);
        }
    }
}
