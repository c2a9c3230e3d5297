//! Hard cases of occlusion layers: what they get wrong is known, bounded, or said.

use std::f64::consts::FRAC_PI_4;

use softshadow::measure::{Receiver, RectangleLight, rectangle_visibility};
use softshadow::{Combine, Filter, Light, Mesh, Near, OcclusionLayers, Projection, Scene, Technique, Visibility};

use crate::common::{Random, lamp, points, ray_traced, rectangle, see};
use crate::shapes::{Point, Triangle, map, plate, scene, turned};

const HEIGHT: f64 = 2.0;

fn exact(triangles: &[Triangle], side: f64, p: Point) -> f64 {
    let half = side / 2.0;
    let light = RectangleLight::new([0.0, 0.0, HEIGHT], [half, 0.0, 0.0], [0.0, half, 0.0], [0.0, 0.0, -1.0]);
    rectangle_visibility(&light.unwrap(), triangles, &Receiver::at(p)).unwrap()
}

fn run(triangles: &[Triangle], light: &Light, positions: &[Point], settings: &OcclusionLayers) -> Visibility {
    let technique = Technique::OcclusionLayers(settings.clone());
    see(&scene(triangles), std::slice::from_ref(light), &points(positions.to_vec()), &technique)
}

fn values(triangles: &[Triangle], light: &Light, positions: &[Point], settings: &OcclusionLayers) -> Vec<f64> {
    run(triangles, light, positions, settings).values.iter().map(|v| f64::from(*v)).collect()
}

fn square(side: f64) -> Light {
    lamp(rectangle(side, side), [0.0, 0.0, HEIGHT])
}

/// A half plane of casters and one far corner that holds the window.
const PLATE_HEIGHT: f64 = 1.0;
const WINDOW: f64 = 4.0;
fn half_plane() -> Vec<Triangle> {
    [
        plate([-WINDOW / 2.0, 0.0], [-WINDOW / 2.0, WINDOW / 2.0], PLATE_HEIGHT),
        plate([WINDOW / 2.0 - 0.01, WINDOW / 2.0], [WINDOW / 2.0 - 0.01, WINDOW / 2.0], PLATE_HEIGHT),
    ]
    .concat()
}

/// Without slant, and seen from so wide around that the window is that of the plates: values of the first receivers.
fn over_plates(positions: &[Point], side: f64, settings: &OcclusionLayers) -> Vec<f64> {
    let around = [[-9.0, -9.0, 0.0], [9.0, 9.0, 0.0]];
    let all: Vec<Point> = positions.iter().copied().chain(around).collect();
    let settings = OcclusionLayers { projection: Projection::Parallel, ..settings.clone() };
    let mut seen = values(&half_plane(), &square(side), &all, &settings);
    seen.truncate(positions.len());
    seen
}

#[test]
fn n_buffers_err_at_an_edge_as_much_as_their_closed_form() {
    // A kernel of r·2^l texels with an edge at half its size from its middle: f (1/2 - r/4) is missed, f = log2 r, at most 0.0736.
    const RESOLUTION: u32 = 512;
    let (mut off, mut predicted, mut off_exact) = (Vec::new(), Vec::new(), Vec::new());
    for step in 0..=16 {
        let r = 2f64.powf(f64::from(step) / 16.0);
        // Half way up, the kernel is half as wide as the light.
        let texels = 64.0 * r;
        let side = 2.0 * texels * WINDOW / f64::from(RESOLUTION);
        // The kernel's border on the edge: all of it is free.
        let p = [side / 2.0, 0.0, 0.0];
        let of = |filter: Filter| {
            let settings =
                OcclusionLayers { filter, slices: 1, split: 1, resolution: RESOLUTION, ..OcclusionLayers::default() };
            1.0 - over_plates(&[p], side, &settings)[0]
        };
        off.push(of(Filter::Nbuffer));
        off_exact.push(of(Filter::SummedArea));
        predicted.push(r.log2() * (0.5 - r / 4.0));
    }
    let worst = |of: &[f64], by: f64| of.iter().zip(&predicted).map(|(a, b)| (a - by * b).abs()).fold(0.0, f64::max);
    println!("N-buffer at an edge: {off:.4?}\nclosed form: {predicted:.4?}");
    assert!(worst(&off, 1.0) < 6e-3, "{}", worst(&off, 1.0));
    assert!((off.iter().copied().fold(0.0, f64::max) - 0.0736).abs() < 4e-3);
    // The exact filter has none of it, and would not pass for an N-buffer.
    assert!(off_exact.iter().all(|off| off.abs() < 1e-4), "{off_exact:?}");
    assert!(worst(&off_exact, 1.0) > 0.05 && worst(&off, 1.2) > 6e-3);
}

#[test]
fn published_filters_are_exact_over_squares_of_their_own() {
    // Kernels of 2^l texels, between texels: the mean over them is a linear interpolation, of eight bits.
    const RESOLUTION: u32 = 256;
    let triangles = half_plane();
    let texel = WINDOW / f64::from(RESOLUTION);
    let positions: Vec<Point> = (0..40).map(|k| [f64::from(k - 20) * 0.173 * 2.0 * texel, 0.07, 0.0]).collect();
    for level in 1..=5 {
        let side = 2.0 * f64::from(1 << level) * texel;
        let truth: Vec<f64> = positions.iter().map(|p| exact(&triangles, side, *p)).collect();
        let of = |filter| {
            let settings =
                OcclusionLayers { filter, slices: 1, split: 1, resolution: RESOLUTION, ..OcclusionLayers::default() };
            let seen = over_plates(&positions, side, &settings);
            seen.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let [nbuffer, mipmap] = [Filter::Nbuffer, Filter::Mipmap].map(of);
        println!("level {level}: N-buffer off by {nbuffer:.4}, mipmap by {mipmap:.4}");
        assert!(nbuffer < 6e-3, "level {level}: {nbuffer}");
        // A mipmap has its squares in a lattice: between them it is wrong by up to an eighth.
        assert!(mipmap < 0.14);
    }
}

#[test]
fn kernels_below_a_texel_are_finite_and_end_in_its_value() {
    let triangles = half_plane();
    let settings = OcclusionLayers { slices: 1, split: 1, resolution: 64, ..OcclusionLayers::default() };
    // Deep in the shadow, in the open, and on the edge; down to a light without size.
    let positions = [[-0.7, 0.1, 0.0], [0.7, 0.1, 0.0], [0.0, 0.1, 0.0]];
    let mut last = 2.0;
    for side in [0.5, 0.125, 0.031, 1e-3, 1e-6, 0.0] {
        let seen = values(&triangles, &square(side), &positions, &settings);
        assert!(seen.iter().all(|v| (0.0..=1.0).contains(v)), "{side}: {seen:?}");
        assert!(seen[0] < 1e-6 && seen[1] > 1.0 - 1e-6, "{side}: {seen:?}");
        last = seen[2];
    }
    assert!((last - 0.5).abs() < 0.51);
}

#[test]
fn walls_under_the_light_vanish_and_the_result_says_so() {
    let wall = map(&plate([-0.5, 0.5], [-0.5, 0.5], 0.0), |[x, y, _]| [0.0, x, y + 0.8]);
    let light = square(0.8);
    let positions = [[0.4, 0.0, 0.0], [-0.4, 0.1, 0.0]];
    let truth: Vec<f64> = positions.iter().map(|p| exact(&wall, 0.8, *p)).collect();
    assert!(truth.iter().all(|v| *v < 0.8), "{truth:?}");
    let settings = OcclusionLayers { slices: 64, near: Near::Fade, ..OcclusionLayers::default() };
    let seen = run(&wall, &light, &positions, &settings);
    assert!(seen.values.iter().all(|v| *v > 0.99), "{:?}", seen.values);
    let says = |seen: &Visibility| seen.info.notes.iter().any(|note| note.contains("from the side"));
    assert!(says(&seen), "{:?}", seen.info.notes);
    // A level plate of the same size is seen, and nothing is said.
    let level = run(&plate([-0.5, 0.5], [-0.5, 0.5], 0.8), &light, &positions, &settings);
    assert!(level.values.iter().any(|v| *v < 0.9) && !says(&level));
}

#[test]
fn a_steep_plate_leaks_by_the_product_and_is_repaired_at_a_price() {
    let steep = map(&plate([-0.6, 0.6], [-0.6, 0.6], 0.0), |p| {
        let [x, y, z] = turned(p, FRAC_PI_4, 0.0);
        [x, y, z + 1.0]
    });
    let light = square(1.2);
    let positions = Random(5).points(200, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.1]);
    let truth: Vec<f64> = positions.iter().map(|p| exact(&steep, 1.2, *p)).collect();
    let errors = |repair_leaks: bool, combine: Combine, slices: u32| {
        let settings =
            OcclusionLayers { slices, combine, repair_leaks, near: Near::Fade, split: 8, ..OcclusionLayers::default() };
        let seen = values(&steep, &light, &positions, &settings);
        let off: Vec<f64> = seen.iter().zip(&truth).map(|(a, b)| a - b).collect();
        let (bias, rmse) = (off.iter().sum::<f64>() / 200.0, (off.iter().map(|x| x * x).sum::<f64>() / 200.0).sqrt());
        println!("45 degrees, {slices} slices, {combine:?}, repaired {repair_leaks}: bias {bias:+.4}, RMSE {rmse:.4}");
        (bias, rmse)
    };
    let (leaking, product) = errors(false, Combine::Product, 32);
    let (repaired, _) = errors(true, Combine::Product, 32);
    let (_, sum) = errors(false, Combine::Sum, 32);
    assert!(leaking > 0.05, "slices that hide one strip each let too much through when they are multiplied: {leaking}");
    assert!(repaired < leaking, "what is written twice is darker");
    assert!(sum < 0.5 * product, "strips lie side by side, so their sum is right: {sum} against {product}");
}

#[test]
fn the_sum_and_the_maximum_bracket_the_truth() {
    // Plates anywhere on two planes, moved by a 128th of their distance.
    let mut random = Random(17);
    let light = square(0.9);
    for _ in 0..6 {
        let mut any = |height: f64| {
            let (x, y) = (random.within([-0.5, 0.3]), random.within([-0.5, 0.3]));
            plate([x, x + random.within([0.1, 0.5])], [y, y + random.within([0.1, 0.5])], height)
        };
        let triangles = [any(0.6), any(1.2)].concat();
        let positions = Random(3).points(60, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]);
        let of = |combine| {
            let settings =
                OcclusionLayers { combine, slices: 128, split: 1, resolution: 256, ..OcclusionLayers::default() };
            values(&triangles, &light, &positions, &settings)
        };
        let (sum, maximum) = (of(Combine::Sum), of(Combine::Maximum));
        let holds = |shift: f64| {
            positions.iter().zip(sum.iter().zip(&maximum)).all(|(p, (low, high))| {
                let truth = exact(&triangles, 0.9, [p[0] + shift, p[1], p[2]]);
                *low - 0.02 <= truth && truth <= *high + 0.02
            })
        };
        assert!(holds(0.0), "the truth lies between");
        assert!(!holds(0.4), "another truth does not");
    }
}

#[test]
fn a_receiver_that_rises_through_the_slices_sees_no_jump() {
    // Leaves in a ball; a point rises through it.
    let mut random = Random(23);
    let leaves: Vec<Triangle> = (0..400)
        .flat_map(|_| {
            let [x, y, z] = random.point([-0.6, 0.6], [-0.6, 0.6], [0.4, 1.4]);
            let (a, b) = (random.within([-1.5, 1.5]), random.within([0.0, 6.0]));
            map(&plate([-0.1, 0.1], [-0.05, 0.05], 0.0), move |p| {
                let q = turned(p, a, b);
                [q[0] + x, q[1] + y, q[2] + z]
            })
        })
        .collect();
    let light = square(1.5);
    let positions: Vec<Point> = (0..400).map(|k| [0.03, 0.02, f64::from(k) * 0.003]).collect();
    let traced = see(&scene(&leaves), std::slice::from_ref(&light), &points(positions.clone()), &ray_traced(2048));
    let truth: Vec<f64> = traced.values.iter().map(|v| f64::from(*v)).collect();
    let settings = OcclusionLayers { near: Near::Fade, ..OcclusionLayers::default() };
    let seen = values(&leaves, &light, &positions, &settings);
    let steps = |v: &[f64]| v.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    let off: Vec<f64> = seen.iter().zip(&truth).map(|(a, b)| a - b).collect();
    println!(
        "rising: largest step of the truth {:.4}, of the error {:.4}, of V {:.4}",
        steps(&truth),
        steps(&off),
        steps(&seen)
    );
    assert!(steps(&off) <= 2.0 * steps(&truth).max(0.005));
    // Rays see what comes and goes, and jump by a part of the light at a time.
    let rays = values(&leaves, &light, &positions, &OcclusionLayers { near: Near::Rays, ..settings });
    let error = |v: &[f64]| (v.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 400.0).sqrt();
    println!("rising: RMSE fading {:.4}, with rays {:.4}", error(&seen), error(&rays));
    assert!(error(&rays) < error(&seen));
}

#[test]
fn turning_everything_changes_little() {
    let body: Vec<Triangle> = [
        map(&plate([-0.4, 0.5], [-0.2, 0.3], 0.0), |p| {
            let q = turned(p, 0.3, 0.4);
            [q[0], q[1], q[2] + 0.8]
        }),
        plate([-0.2, 0.1], [-0.6, 0.2], 1.2),
    ]
    .concat();
    let positions = Random(31).points(150, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.2]);
    let pose = |turn: &dyn Fn(Point) -> Point| {
        let axis = |p: Point| turn(p);
        let (x, y, z, c) =
            (axis([1.0, 0.0, 0.0]), axis([0.0, 1.0, 0.0]), axis([0.0, 0.0, 1.0]), turn([0.0, 0.0, HEIGHT]));
        let row = |k: usize| [x[k], y[k], z[k], c[k]];
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    };
    let of = |turn: &dyn Fn(Point) -> Point| {
        let light = Light::new(rectangle(1.0, 1.0), pose(turn)).unwrap();
        let at: Vec<Point> = positions.iter().map(|p| turn(*p)).collect();
        values(
            &map(&body, turn),
            &light,
            &at,
            &OcclusionLayers { slices: 8, near: Near::Fade, ..OcclusionLayers::default() },
        )
    };
    let straight = of(&|p| p);
    let tilted = of(&|p| turned(p, 0.7, 1.1));
    let worst = straight.iter().zip(&tilted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("turned: worst change {worst:.5}");
    assert!(worst < 0.01, "{worst}");
    assert!(straight.iter().filter(|v| **v < 0.9).count() > 20);
}

#[test]
fn semi_opaque_casters_are_taken_for_opaque_and_it_is_said() {
    let triangles = plate([-0.5, 0.5], [-0.5, 0.5], 1.0);
    let corners: Vec<Point> = triangles.iter().flatten().copied().collect();
    let faces = (0..triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let material = softshadow::Material { opacity: 0.5, ..softshadow::Material::default() };
    let glass = Scene::new(vec![Mesh::new("glass", corners, faces, material).unwrap()]).unwrap();
    let technique = Technique::OcclusionLayers(OcclusionLayers::default());
    let seen = see(&glass, &[square(0.3)], &points(vec![[0.0, 0.0, 0.0]]), &technique);
    assert_eq!(seen.values, [0.0]);
    let note = "2 semi-opaque triangles taken for opaque: occlusion_layers knows no others";
    assert!(seen.info.notes.iter().any(|n| n == note), "{:?}", seen.info.notes);
}
