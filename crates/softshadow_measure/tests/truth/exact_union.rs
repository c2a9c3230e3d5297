//! The exact union against rays, against a tilted copy of itself and in the limits that break projections.

use softshadow_measure::{
    AxisRectangle, MeasureError, RayReference, Receiver, RectangleLight, Target, Triangle, rectangle_visibility,
    sphere_over_rectangle,
};

use crate::random::Random;
use crate::shapes::{LIGHT, as_light, rectangle, sphere};

fn random_mesh(random: &mut Random, count: usize) -> Vec<Triangle> {
    (0..count)
        .map(|_| {
            // Heights from below the receivers to above the light, so that some triangles pierce either plane.
            let [x, y, z] = random.in_cube(0.6);
            std::array::from_fn(|_| {
                let [dx, dy, dz] = random.in_cube(0.5);
                [x + dx, y + dy, 1.6 + 2.0 * z + dz]
            })
        })
        .collect()
}

/// A grid of targets at the centres of cells, dense enough to see a missing triangle.
fn grid(light: &RectangleLight, side: u32) -> Vec<Target> {
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
    (0..side * side).map(|k| light.target([at(k % side), at(k / side)])).collect()
}

fn by_rays(mesh: &[Triangle], receiver: &Receiver, targets: &[Target]) -> f64 {
    let verdicts = RayReference::new(mesh).unwrap().trace_receiver(receiver, targets).unwrap();
    verdicts.iter().filter(|v| v.visible).count() as f64 / targets.len() as f64
}

#[test]
fn unions_agree_with_rays() {
    let light = as_light(&LIGHT);
    let targets = grid(&light, 200);
    let mut random = Random::new(1);
    let (mut total, mut spoilt) = (0.0, 0);
    for round in 0..60 {
        let mesh = random_mesh(&mut random, 6);
        let mut receiver = Receiver::at([random.between(-0.5, 0.5), random.between(-0.5, 0.5), 0.0]);
        if round % 3 == 1 {
            receiver.normal = Some([random.between(-1.0, 1.0) * 9.0, 0.0, 1.0]);
        }
        if round % 3 == 2 {
            receiver.excluded_triangle = Some(round % 6);
        }
        let exact = rectangle_visibility(&light, &mesh, &receiver).unwrap();
        let rays = by_rays(&mesh, &receiver, &targets);
        // A side of an edge moves at most one cell in each row or column it crosses; random cells average far below that.
        assert!((exact - rays).abs() < 2e-3, "{round}: {exact} {rays}");
        total += (exact - rays).abs();
        let fewer = rectangle_visibility(&light, &mesh[..5], &receiver).unwrap();
        spoilt += usize::from((fewer - rays).abs() > 2e-3);
    }
    assert!(total / 60.0 < 4e-4, "{}", total / 60.0);
    assert!(spoilt > 10, "a missing triangle was seen only {spoilt} times");
}

#[test]
fn horizon_and_exclusion_are_not_decoration() {
    let light = as_light(&LIGHT);
    let cover = rectangle(&AxisRectangle { z: 1.0, ..LIGHT });
    let mut receiver = Receiver::at([0.0; 3]);
    assert_eq!(rectangle_visibility(&light, &cover, &receiver), Ok(0.0));
    receiver.excluded_triangle = Some(0);
    let half = rectangle_visibility(&light, &cover, &receiver).unwrap();
    assert!((half - 0.5).abs() < 1e-12);
    // The horizon cuts the light at x = 0: exactly half of it remains.
    receiver.normal = Some([1.0, 0.0, 0.0]);
    let above = rectangle_visibility(&light, &[], &receiver).unwrap();
    assert!((above - 0.5).abs() < 1e-12);
    receiver.normal = Some([0.0, 0.0, -1.0]);
    assert_eq!(rectangle_visibility(&light, &[], &receiver), Ok(0.0));
}

#[test]
fn a_rigid_motion_changes_nothing() {
    // Rows of a rotation: the light of the other tests, tilted, stretched along none of the world's axes, and far away.
    let rotation =
        [[2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], [2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0], [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]];
    let turn = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|row| (0..3).map(|k| rotation[row][k] * p[k]).sum()) };
    let place = |p: [f64; 3]| -> [f64; 3] {
        let turned = turn(p);
        [turned[0] + 7.0, turned[1] - 5.0, turned[2] + 3.0]
    };
    let here = as_light(&LIGHT);
    let there = RectangleLight::new(
        place([0.0, 0.0, 3.0]),
        turn([0.5, 0.0, 0.0]),
        turn([0.0, 0.5, 0.0]),
        turn([0.0, 0.0, -1.0]),
    )
    .unwrap();
    let mut random = Random::new(2);
    for _ in 0..100 {
        let mesh = random_mesh(&mut random, 20);
        let moved: Vec<Triangle> = mesh.iter().map(|face| face.map(place)).collect();
        let origin = random.in_cube(0.3);
        let a = rectangle_visibility(&here, &mesh, &Receiver::at(origin)).unwrap();
        let b = rectangle_visibility(&there, &moved, &Receiver::at(place(origin))).unwrap();
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
}

#[test]
fn a_triangle_through_the_receivers_plane_needs_no_epsilon() {
    // numerics.md, section 3: V = 1/2 + 3.5 g for a vertical triangle at distance g that spans below the receiver.
    let light = as_light(&LIGHT);
    for gap in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
        let face = [[-1.0, gap, -1.0], [1.0, gap, -1.0], [0.0, gap, 1.0]];
        let visible = rectangle_visibility(&light, &[face], &Receiver::at([0.0; 3])).unwrap();
        let error = (visible - 0.5 - 3.5 * gap).abs();
        println!("gap {gap:.0e}: {error:.1e} off 1/2 + 3.5 g");
        // Rounding of corners at distance 1, as seen over the gap.
        assert!(error < 1e-13 + 2.3e-16 / gap, "{gap} {visible}");
    }
}

#[test]
fn a_triangle_with_a_corner_at_the_receiver_is_edge_on() {
    let face = [[0.0; 3], [0.5, -0.2, 1.0], [-0.5, 0.2, 1.0]];
    let visible = rectangle_visibility(&as_light(&LIGHT), &[face], &Receiver::at([0.0; 3]));
    assert_eq!(visible, Ok(1.0));
}

#[test]
fn a_fine_sphere_approaches_the_true_one() {
    let light = as_light(&LIGHT);
    let (center, radius) = ([0.1, 0.2, 1.0], 0.15);
    let ball = softshadow_measure::Sphere { center, radius };
    let exact = sphere_over_rectangle([0.0; 3], &ball, &LIGHT).unwrap();
    let errors: Vec<f64> = (3..6)
        .map(|levels| {
            let mesh = sphere(center, radius, levels);
            rectangle_visibility(&light, &mesh, &Receiver::at([0.0; 3])).unwrap() - exact
        })
        .collect();
    println!("tessellated - true sphere: {errors:?}");
    // The tessellation lies inside, and its error falls by four with every level.
    assert!(errors.iter().all(|error| *error > 0.0));
    for pair in errors.windows(2) {
        assert!((3.1..4.5).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn what_is_not_strictly_between_hides_nothing() {
    let light = as_light(&LIGHT);
    let seen = |z: f64| {
        let mesh = rectangle(&AxisRectangle { z, ..LIGHT });
        rectangle_visibility(&light, &mesh, &Receiver::at([0.0; 3])).unwrap()
    };
    assert_eq!(seen(3.0), 1.0);
    assert_eq!(seen(3.5), 1.0);
    assert_eq!(seen(0.0), 1.0);
    assert_eq!(seen(-1.0), 1.0);
    assert!(seen(2.999) < 1e-2 && seen(1e-9) < 1e-12);
    // Behind the light and in its plane.
    for z in [3.0, 4.0] {
        let behind = Receiver::at([0.1, 0.0, z]);
        assert_eq!(rectangle_visibility(&light, &[], &behind), Ok(0.0));
        assert!(!light.faces(behind.origin));
    }
}

#[test]
fn bad_input_is_a_typed_error() {
    let axes = |u: [f64; 3], v: [f64; 3], front: [f64; 3]| RectangleLight::new([0.0; 3], u, v, front);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert!(axes(x, y, z).is_ok());
    for (u, v, front) in [([0.0; 3], y, z), (x, [0.1, 1.0, 0.0], z), (x, y, x), (x, y, [0.0; 3])] {
        assert!(matches!(axes(u, v, front), Err(MeasureError::Degenerate { .. })));
    }
    assert!(matches!(axes([f64::NAN; 3], y, z), Err(MeasureError::NotFinite { .. })));
    let good = [x, y, z];
    let bad = [x, y, [f64::INFINITY, 0.0, 0.0]];
    let result = rectangle_visibility(&as_light(&LIGHT), &[good, bad], &Receiver::at([0.0; 3]));
    assert_eq!(result, Err(MeasureError::NotFinite { what: "triangle", index: 1 }));
}
