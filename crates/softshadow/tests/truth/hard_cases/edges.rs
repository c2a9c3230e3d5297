//! How edges lie: DC1 to DC3.

use glam::DVec3;
use softshadow::{Light, light_points};
use softshadow_scene::{LightFrame, LocalScene};

use super::judge::{Case, expect_rays, settings};
use super::{MANY, all_around, slanting};
use crate::common::{Random, lamp, points, rectangle};
use crate::shapes::{Point, cuboid, plate, scene};

/// The reference point of a square lamp of size 1, whose frame has y turned.
fn reference_of(lamp: &Light) -> DVec3 {
    let bare = LightFrame::new(lamp, &LocalScene::new(&scene(&[]), None, 1 << 20).frame);
    let [x, y] = bare.reference.map(f64::from);
    DVec3::new(0.1 + x * 0.5, 0.2 - y * 0.5, 3.0)
}

#[test]
fn dc01_a_lattice_of_ties() {
    // Everything axis-aligned and dyadic: receivers, box, light. Lines through corners meet the light's middle everywhere.
    let block = scene(&cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.5]));
    let light = lamp(rectangle(2.0, 2.0), [0.0, 0.0, 2.0]);
    let at = |i: i32| f64::from(i) / 32.0;
    let lattice = |z: f64| (-32..=32).flat_map(move |i| (-32..=32).map(move |j| [at(i), at(j), z]));
    let receivers = [-1.0, -0.5, -0.25, -0.125].into_iter().flat_map(lattice).collect();
    let found = expect_rays("DC1 lattice", [Case::run(&block, &light, &points(receivers))]);
    assert!(found.samples > 1_000_000 && found.grazing == 0, "{found:?}");
}

#[test]
fn dc01_faces_in_one_plane_with_the_reference_point() {
    // A triangle whose plane holds the point c about which all directions are taken, and receivers in and near that plane: c lies within
    // rounding of the images of all its edges.
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.2, 3.0]);
    let c = reference_of(&light);
    let (across, down) = (DVec3::new(0.6, 0.8, 0.0), DVec3::NEG_Z);
    let normal = across.cross(down);
    let corner = |s: f64, t: f64| (c + across * s + down * t).to_array();
    let (mut torn, mut samples) = (0, 0);
    let ahead = [corner(-0.8, 0.5), corner(0.9, 0.7), corner(0.1, 2.0)];
    let partly_behind = [corner(1.2, 0.5), corner(1.9, 0.7), corner(1.3, 6.0)];
    for face in [ahead, partly_behind] {
        let mut random = Random(26);
        for off in [0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4] {
            let place = |random: &mut Random| {
                let (s, t) = (random.within([-1.0, 1.0]), random.within([2.1, 4.0]));
                (c + across * s + down * t + normal * random.within([-off, off])).to_array()
            };
            let receivers = points((0..2 * MANY).map(|_| place(&mut random)).collect());
            let case = Case::run(&scene(&[face]), &light, &receivers);
            let found = case.found();
            println!("hard case DC1 one plane, {off:e} off: {found:?}");
            torn += found.wrong;
            samples += found.samples;
            if off == 1e-4 {
                case.goes_red_when_spoilt("DC1 one plane");
            }
        }
    }
    assert!(samples > 3_000_000);
    assert_eq!(torn, 0);
}

#[test]
fn dc01_samples_in_line_with_a_corner_and_the_reference_point() {
    // A plate hides c, and the way from c to a sample leaves it through a corner, within rounding: exactly one of the two edges there has
    // to take the sample, which is far from both.
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.2, 3.0]);
    let shade = scene(&plate([-1.0, 0.3], [-1.0, 0.4], 1.0));
    let c = reference_of(&light);
    let all = light_points(&shade, &light, &settings().sampling(0), &[], 0).unwrap().positions;
    let beyond = all.into_iter().map(DVec3::from).filter(|s| s.x > c.x + 0.1 && s.y > c.y + 0.1).collect::<Vec<_>>();
    assert!(beyond.len() > 8);
    let corner = DVec3::new(0.3, 0.4, 1.0);
    let mut random = Random(12);
    let receivers = (0..MANY).map(|i| {
        let on_the_way = c + (beyond[i % beyond.len()] - c) * random.within([0.2, 0.8]);
        (corner + (corner - on_the_way) * random.within([0.3, 1.0])).to_array()
    });
    expect_rays("DC1 samples in line with a corner", [Case::run(&shade, &light, &points(receivers.collect()))]);
}

#[test]
fn dc02_edges_along_the_view() {
    // A thin vertical rod: its long edges are points as seen from below.
    let rod = scene(&cuboid([-0.01, -0.01, -0.5], [0.01, 0.01, 1.5]));
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0]);
    let mut random = Random(20);
    let mut under = |i: usize, axis: [f64; 2]| -> Point {
        let reach = if i.is_multiple_of(10) { 0.0 } else { 10f64.powf(random.within([-7.0, -1.0])) };
        let turn = random.within([0.0, std::f64::consts::TAU]);
        [axis[0] + reach * turn.cos(), axis[1] + reach * turn.sin(), -0.9]
    };
    // Below its middle, and below one of its edges.
    let receivers = (0..MANY).map(|i| under(i, if i % 2 == 0 { [0.0; 2] } else { [0.01; 2] })).collect();
    expect_rays("DC2 rod", [Case::run(&rod, &light, &points(receivers))]);
}

#[test]
fn dc03_edges_parallel_to_the_light() {
    let mut random = Random(30);
    let level = lamp(rectangle(1.0, 0.8), [0.1, 0.05, 3.0]);
    for (name, light) in [("DC3 turning edge, slanting light", slanting()), ("DC3 turning edge, level light", level)] {
        let calls: Vec<Case> = (0..=12)
            .map(|turn| {
                let angle = f64::from(turn) * std::f64::consts::PI / 12.0;
                // Exactly along and across at 0, 90 and 180 degrees.
                let (s, c) = if turn % 6 == 0 { (angle.sin().round(), angle.cos().round()) } else { angle.sin_cos() };
                let tip = |sign: f64| [sign * c * 0.4, 0.0, sign * s * 0.4];
                let face = [tip(1.0), tip(-1.0), [0.05, 0.3, 0.1]];
                Case::run(&scene(&[face]), &light, &all_around(&mut random, MANY / 4))
            })
            .collect();
        expect_rays(name, calls);
    }
}
