//! Receivers with samples of their own: edges and rays take the same ones, whatever the block; averages of interleaved ones keep edges.

use softshadow::{
    Camera, DepthComplexity, Light, LightShape, LightTexture, Material, Mesh, Options, PictureOptions, RayTraced,
    Receivers, SamplePattern, SampleSpread, Scene, Shading, Technique, Visibility, light_points, look_at, measure,
    render, visibility,
};

use crate::agreement::{Agreement, Truth};
use crate::common::{Random, bits, context, lamp, points, ray_traced, rays, rectangle, see, shipped, surface_points};
use crate::filtered::{averaged, farthest, plane_of, share_visible};
use crate::shapes::{Triangle, cuboid, plate, quad, scene, sphere, torus};

use SampleSpread::{Correlated, Decorrelated, Interleaved};

fn traced(samples: u32, spread: SampleSpread) -> RayTraced {
    RayTraced { spread, ..rays(samples) }
}

fn folded(samples: u32, spread: SampleSpread) -> DepthComplexity {
    DepthComplexity { samples, spread, exact_area: false, ..DepthComplexity::default() }
}

/// Both techniques with the same samples, and without exact areas.
fn both(samples: u32, spread: SampleSpread) -> [Technique; 2] {
    [Technique::RayTraced(traced(samples, spread)), Technique::DepthComplexity(folded(samples, spread))]
}

/// A ring and a ball over a floor.
fn bodies() -> Scene {
    scene(&[plate([-2.0, 2.0], [-2.0, 2.0], -0.6), torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat())
}

fn bodies_seen(size: [u32; 2]) -> Camera {
    Camera::look_at([1.6, -3.2, 2.2], [0.0, 0.0, -0.2], Some([0.0, 0.0, 1.0]), 40.0, size).unwrap()
}

fn lights() -> Vec<Light> {
    let pose = look_at([0.5, 0.4, 3.0], [0.0; 3], None).unwrap();
    let bracket = [[-0.5, -0.5], [0.6, -0.5], [0.6, -0.15], [-0.1, -0.15], [-0.1, 0.45], [-0.5, 0.45]];
    [
        rectangle(1.0, 0.6),
        LightShape::Disc { radius: 0.5 },
        LightShape::Polygon { outline: bracket.to_vec() },
        LightShape::Sphere { radius: 0.5 },
        LightShape::Sun { angular_diameter: 0.3 },
    ]
    .map(|shape| Light::new(shape, pose).unwrap())
    .to_vec()
}

/// Bits in which two results differ, and bits of hidden samples. Those past the last sample mean nothing.
fn differing(a: &Visibility, b: &Visibility, samples: u32) -> (u32, u32) {
    let (a, b) = (&a.masks.as_ref().unwrap().bits, &b.masks.as_ref().unwrap().bits);
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let differ = a.iter().zip(b).enumerate().map(|(at, (x, y))| ((x ^ y) & used(at)).count_ones()).sum();
    (differ, a.iter().enumerate().map(|(at, x)| (x & used(at)).count_ones()).sum())
}

#[test]
fn edges_and_rays_take_the_same_samples() {
    let scene = bodies();
    let camera = Receivers::Camera(bodies_seen([64, 48]));
    let floor = Random(6).points(2000, [-1.5, 1.5], [-1.5, 1.5], [-0.6, -0.4]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    let (mut total, mut wrong, mut apart) = (0, 0, 0);
    for light in lights() {
        let lights = std::slice::from_ref(&light);
        for samples in [16, 32, 64, 128, 256] {
            for (pattern, spread, receivers) in [
                (SamplePattern::Stratified, Interleaved, &camera),
                (SamplePattern::LowDiscrepancy, Interleaved, &camera),
                (SamplePattern::Stratified, Decorrelated, &camera),
                (SamplePattern::LowDiscrepancy, Decorrelated, &free),
                (SamplePattern::Stratified, Decorrelated, &surface),
            ] {
                let rays = RayTraced { pattern, ..traced(samples, spread) };
                let edges = DepthComplexity { pattern, ..folded(samples, spread) };
                let rays = see(&scene, lights, receivers, &Technique::RayTraced(rays));
                let edges = see(&scene, lights, receivers, &Technique::DepthComplexity(edges));
                let (differ, hidden) = differing(&rays, &edges, samples);
                assert!(hidden > 200 * samples, "{:?} {spread:?}: {hidden}", light.shape());
                total += rays.receivers * samples as usize;
                wrong += differ as usize;
                // Of one set for all nearly everything in the penumbra is another.
                if samples == 64 {
                    let one_set = see(&scene, lights, receivers, &ray_traced(samples));
                    apart += differing(&rays, &one_set, samples).0 as usize;
                }
            }
        }
    }
    println!("spread samples: {wrong} of {total} differ between edges and rays; {apart} from those of one set");
    assert!(wrong * 10_000 <= total, "{wrong} of {total} differ");
    assert!(apart > 100_000, "{apart}");
}

#[test]
fn rays_go_where_light_points_says() {
    let scene = bodies();
    let truth = Truth::of(&scene);
    let camera = Receivers::Camera(bodies_seen([48, 32]));
    let floor = points(Random(8).points(1000, [-1.0, 1.0], [-1.0, 1.0], [-0.55, -0.4]));
    let mut total = Agreement::default();
    for light in lights() {
        for (spread, receivers) in [(Interleaved, &camera), (Decorrelated, &camera), (Decorrelated, &floor)] {
            let settings = RayTraced { seed: 3, ..traced(32, spread) };
            let technique = Technique::RayTraced(settings.clone());
            let seen = see(&scene, std::slice::from_ref(&light), receivers, &technique);
            let found = truth.compare(&scene, &light, &settings, &seen);
            assert_eq!(found.differing, 0, "{:?} {spread:?}: {found:?}", light.shape());
            assert!(found.grazing * 50 < found.samples && found.hidden * 50 > found.samples, "{found:?}");
            // Were the sets those of a neighbour, it would be seen.
            let mut shifted = seen.clone();
            let words = &mut shifted.masks.as_mut().unwrap().bits;
            words.rotate_right(1);
            assert!(truth.compare(&scene, &light, &settings, &shifted).differing > 500);
            total += found;
        }
    }
    println!("spread samples against float64 rays: {total:?}");
}

#[test]
fn neighbours_have_samples_of_their_own() {
    let (scene, light) = (bodies(), lights().remove(0));
    let receivers = vec![[0.0; 3]; 24 * 16];
    let rows = |spread, width| {
        let found = light_points(&scene, &light, &traced(64, spread).sampling(0), &receivers, width).unwrap();
        assert_eq!(found.parameters.len(), found.positions.len());
        found.positions
    };
    assert_eq!(rows(Correlated, 0).len(), 64);
    for spread in [Decorrelated, Interleaved] {
        let all = rows(spread, 24);
        let row = |index: usize| &all[64 * index..64 * (index + 1)];
        let same =
            (0..24 * 16 - 24).filter(|i| (i % 24 < 23 && row(*i) == row(i + 1)) || row(*i) == row(i + 24)).count();
        // Of 128 sets two receivers have the same by chance.
        assert!(same <= 12 && (spread == Decorrelated || same == 0), "{spread:?}: {same} of 744 neighbours");
    }
    assert_eq!(rows(Decorrelated, 24), rows(Decorrelated, 0), "drawn by index, of whatever image");
    let refused = light_points(&scene, &light, &traced(64, Interleaved).sampling(0), &receivers, 0).unwrap_err();
    assert!(refused.to_string().contains("interleaved samples are those of an image's pixels"), "{refused}");
}

#[test]
fn blocks_of_any_size_give_the_same_bits() {
    let (scene, light, camera) = shipped("toruses", [96, 64]);
    let floor = surface_points(Random(2).points(20_000, [-2.0, 2.0], [0.0, 0.0], [-2.0, 2.0]), [0.0, 1.0, 0.0]);
    let camera = Receivers::Camera(camera);
    let probed = RayTraced { probes: 8, tile: 5, passes: 2, ..traced(40, Interleaved) };
    let exact = DepthComplexity { spread: Interleaved, passes: 2, ..DepthComplexity::default() };
    let [rays, edges] = both(40, Interleaved);
    let [rays_apart, edges_apart] = both(40, Decorrelated);
    for (receivers, technique, limit) in [
        (&camera, &rays, 150_000),
        (&camera, &Technique::RayTraced(probed), 200_000),
        (&camera, &edges, 350_000),
        (&camera, &Technique::DepthComplexity(exact), 400_000),
        (&camera, &rays_apart, 150_000),
        (&floor, &rays_apart, 400_000),
        (&floor, &edges_apart, 1_000_000),
    ] {
        let run = |memory_limit_bytes| {
            let options =
                Options { memory_limit_bytes, standard_error: true, sample_masks: true, ..Options::default() };
            let lights = std::slice::from_ref(&light);
            visibility(context(), &scene, lights, receivers, technique, &options, &mut |_, _| true).unwrap()
        };
        let (whole, parts) = (run(1 << 30), run(limit));
        assert!(whole.info.blocks == 1 && parts.info.blocks > 3, "{} {}", technique.name(), parts.info.blocks);
        assert!(bits(&whole) == bits(&parts), "{technique:?}");
        let errors = |v: &Visibility| v.standard_error.iter().flatten().map(|e| e.to_bits()).collect::<Vec<_>>();
        assert!(errors(&whole) == errors(&parts));
    }
}

/// A lit plate above its own umbra, a box with a dark side, and a floor: every kind of border, with exact values on both of its sides.
fn borders() -> (Scene, Light, Camera) {
    let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    triangles.extend(plate([-0.5, 0.5], [-0.6, 0.6], 1.0));
    triangles.extend(cuboid([1.4, -0.5, 0.0], [2.2, 0.5, 0.7]));
    let light = lamp(rectangle(0.3, 0.3), [-1.5, 0.0, 4.0]);
    let camera = Camera::look_at([0.8, -0.4, 9.0], [0.8, 0.0, 0.0], Some([0.0, 1.0, 0.0]), 25.0, [160, 120]).unwrap();
    (scene(&triangles), light, camera)
}

#[test]
fn averages_are_of_one_surface_and_keep_its_borders() {
    let (scene, light, above) = borders();
    let beside = Camera::look_at([6.0, -5.0, 3.0], [0.6, 0.0, 0.3], Some([0.0, 0.0, 1.0]), 30.0, [160, 120]).unwrap();
    let grazing = Camera::look_at([7.0, 1.0, 1.6], [0.0, 0.0, 0.6], Some([0.0, 0.0, 1.0]), 25.0, [160, 120]).unwrap();
    for (name, camera) in [("above", above), ("beside", beside), ("grazing", grazing)] {
        for tile in [2, 3, 4, 8] {
            for technique in [
                Technique::RayTraced(RayTraced { tile, ..traced(16, Interleaved) }),
                Technique::DepthComplexity(DepthComplexity { tile, ..folded(16, Interleaved) }),
            ] {
                let seen = see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique);
                let alone = |index: usize| share_visible(&seen, index, 16);
                let same = |a: usize, b: usize| plane_of(&seen, a) == plane_of(&seen, b);
                let expected = averaged(&seen, tile, alone, same);
                let off = farthest(&seen, &expected);
                assert!(off < 1e-5, "{name}, tile {tile}, {}: {off}", technique.name());
                // Without regard to surfaces light would bleed: many pixels, and by much.
                let bled = averaged(&seen, tile, alone, |_, _| true);
                let bleeds = |index: &usize| {
                    (f64::from(seen.values[*index]) - bled[*index]).abs() > 0.1
                        && [0.0, 1.0].contains(&expected[*index])
                };
                let borders = (0..seen.receivers).filter(|i| seen.valid[*i]).filter(bleeds).count();
                println!(
                    "{name}, tile {tile}, {}: off by {off:.1e}; {borders} exact pixels at borders",
                    technique.name()
                );
                assert!(borders > 30, "{name}, tile {tile}: {borders}");
            }
        }
    }
}

#[test]
fn sheets_closer_than_half_a_pixel_are_one_surface_and_no_others() {
    // Steps on a stair, one every 0.2, whose heights are shares of a pixel's size; seen from straight above and aslant.
    let pixel = 6.0 * 2.0 * (15.0_f64.to_radians()).tan() / 128.0;
    for (height, is_one) in [(0.2 * pixel, true), (1.5 * pixel, false)] {
        let stair: Vec<Triangle> = (0..10)
            .flat_map(|n| {
                let (x, z) = (0.2 * f64::from(n) - 1.0, height * f64::from(n % 2));
                quad([x, -1.0, z], [x + 0.2, -1.0, z], [x + 0.2, 1.0, z], [x, 1.0, z])
            })
            .collect();
        let scene = scene(&[stair, plate([-0.1, 0.1], [-0.6, 0.6], 1.0)].concat());
        let camera = Camera::look_at([0.0, 0.0, 6.0], [0.0; 3], Some([0.0, 1.0, 0.0]), 30.0, [128, 128]).unwrap();
        let light = lamp(rectangle(1.0, 1.0), [0.4, 0.1, 3.0]);
        let technique = Technique::RayTraced(RayTraced { tile: 2, ..traced(16, Interleaved) });
        let seen = see(&scene, &[light], &Receivers::Camera(camera), &technique);
        let z = |index: usize| seen.placed.as_ref().unwrap().positions[index][2];
        let (sheet, stair) = (|i: usize| z(i) > 0.5, |i: usize| (z(i) * 1e6).round());
        let alike = |a: usize, b: usize| sheet(a) == sheet(b) && (is_one || stair(a) == stair(b));
        let off = farthest(&seen, &averaged(&seen, 2, |i| share_visible(&seen, i, 16), alike));
        let otherwise = |a: usize, b: usize| sheet(a) == sheet(b) && (!is_one || stair(a) == stair(b));
        let spoilt = farthest(&seen, &averaged(&seen, 2, |i| share_visible(&seen, i, 16), otherwise));
        println!("steps of {:.1} pixels: off by {off:.1e}; taken the other way {spoilt:.2}", height / pixel);
        assert!(off < 1e-5 && spoilt > 0.01, "{off} {spoilt}");
    }
}

#[test]
fn interleaved_samples_err_less_than_as_many_of_one_set() {
    for name in ["toruses", "hall", "fork"] {
        let (scene, light, camera) = shipped(name, [240, 180]);
        let receivers = Receivers::Camera(camera);
        let run = |technique: &Technique| see(&scene, std::slice::from_ref(&light), &receivers, technique);
        let truth = run(&ray_traced(2048));
        let image = measure::ReferenceImage { visibility: &truth.values, standard_error: None, width: Some(240) };
        let rmse = |technique: &Technique| {
            let report = measure::compare(&run(technique).values, &image).unwrap();
            (report.penumbra.unwrap().rmse, report.penumbra.unwrap().bias)
        };
        for samples in [16, 64] {
            let [one, apart, interleaved] =
                [Correlated, Decorrelated, Interleaved].map(|spread| rmse(&both(samples, spread)[1]));
            println!(
                "{name}, {samples} samples, RMSE (bias) in penumbra: correlated {:.4} ({:+.4}), decorrelated {:.4} ({:+.4}), \
                 interleaved {:.4} ({:+.4})",
                one.0, one.1, apart.0, apart.1, interleaved.0, interleaved.1
            );
            if samples == 16 {
                assert!(interleaved.0 < 0.6 * one.0, "{name}: {interleaved:?} of {one:?}");
            }
        }
    }
}
