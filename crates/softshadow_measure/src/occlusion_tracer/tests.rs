//! The tracer has the verdicts of the brute force, and a spoilt hierarchy is noticed.

use super::*;
use crate::RayReference;
use crate::test_scenes::{add_offset, beyond_an_edge, float32_vector, hostile_mesh, sphere_mesh, uniforms, vertex};
use crate::vector::{add, cross, sub};

/// How many verdicts there are, how many say hidden, and how many differ from the brute force.
#[derive(Default)]
struct Tally {
    verdicts: usize,
    hidden: usize,
    different: usize,
}

impl Tally {
    fn add(&mut self, tracer: &OcclusionTracer, mesh: &[Triangle], receiver: &Receiver, targets: &[Target]) {
        let reference = RayReference::new(mesh).unwrap();
        let expected = reference.trace_receiver(receiver, targets).unwrap();
        for (hidden, expected) in tracer.hidden(receiver, targets).into_iter().zip(expected) {
            self.verdicts += 1;
            self.hidden += usize::from(!expected.visible);
            self.different += usize::from(hidden == expected.visible);
        }
    }
}

/// Points that are mixed with directions in every fifth round, and beyond edges of the mesh in every tenth.
fn hostile_targets(round: usize, mesh: &[Triangle], origin: Vec3, next: &mut impl FnMut() -> f64) -> Vec<Target> {
    let light = float32_vector(next, 8.0);
    let spread = 10_f64.powf(next() * 3.0 - 2.0);
    let target = |sample: usize| {
        let at = match sample % 8 {
            3.. if round % 10 == 7 => vertex(beyond_an_edge(&mesh[sample % mesh.len()], origin)),
            _ => vertex(add_offset(light, next, spread)),
        };
        if round.is_multiple_of(5) && sample.is_multiple_of(2) { Target::Direction(at) } else { Target::Point(at) }
    };
    (0..64).map(target).collect()
}

fn hostile_receiver(round: usize, next: &mut impl FnMut() -> f64) -> Receiver {
    let mut receiver = Receiver::at(float32_vector(next, 2.0));
    match round % 4 {
        1 => receiver.normal = Some(float32_vector(next, 1.0)),
        2 => receiver.origin[2] = 0.0,
        3 => receiver.excluded_triangle = Some(5),
        _ => {}
    }
    receiver
}

fn hostile_tally(spoil: impl Fn(&[Triangle]) -> OcclusionTracer) -> Tally {
    let mut next = uniforms(11);
    let mut tally = Tally::default();
    for round in 0..400 {
        let mesh = hostile_mesh(&mut next, 150);
        let tracer = spoil(&mesh);
        for _ in 0..4 {
            let receiver = hostile_receiver(round, &mut next);
            tally.add(&tracer, &mesh, &receiver, &hostile_targets(round, &mesh, receiver.origin, &mut next));
        }
    }
    tally
}

#[test]
fn hostile_meshes_have_the_verdicts_of_the_brute_force() {
    let tally = hostile_tally(|mesh| OcclusionTracer::new(mesh).unwrap());
    assert_eq!(tally.different, 0);
    assert!(tally.hidden * 20 > tally.verdicts && tally.hidden * 20 < tally.verdicts * 19, "{}", tally.hidden);
}

#[test]
fn shrunk_boxes_are_noticed() {
    let tally = hostile_tally(|mesh| {
        let mut tracer = OcclusionTracer::new(mesh).unwrap();
        tracer.hierarchy.shrink_boxes(0.99);
        tracer
    });
    assert!(tally.different > 10, "only {} of {}", tally.different, tally.verdicts);
}

#[test]
fn a_missing_triangle_is_noticed() {
    let tally = hostile_tally(|mesh| OcclusionTracer::new(&mesh[..mesh.len() - 1]).unwrap());
    assert!(tally.different > 10, "only {} of {}", tally.different, tally.verdicts);
}

/// A square light of 8 × 8 points, 3.5 above the origin.
fn square_light() -> Vec<Target> {
    let at = |index: usize| (index as f64 + 0.5) / 8.0 - 0.5;
    (0..64).map(|index| Target::Point([at(index % 8), at(index / 8), 3.5])).collect()
}

#[test]
fn receivers_on_and_around_closed_meshes_have_the_verdicts_of_the_brute_force() {
    let mut next = uniforms(12);
    let mut mesh = sphere_mesh([0.0, 0.0, 1.0], 0.7, 4);
    mesh.extend(sphere_mesh([0.3, -0.1, 0.5], 0.4, 3));
    let tracer = OcclusionTracer::new(&mesh).unwrap();
    let mut tally = Tally::default();
    for round in 0..600 {
        let index = (next() * mesh.len() as f64) as usize;
        let [v0, v1, v2] = mesh[index];
        let receiver = match round % 3 {
            // On a corner of the mesh, where the planes of several triangles meet.
            0 => Receiver { origin: v0, normal: Some(sub(v0, [0.0, 0.0, 1.0])), excluded_triangle: Some(index) },
            1 => Receiver {
                origin: vertex([0, 1, 2].map(|axis| (v0[axis] + v1[axis] + v2[axis]) / 3.0)),
                normal: Some(cross(sub(v1, v0), sub(v2, v0))),
                excluded_triangle: Some(index),
            },
            _ => Receiver::at(vertex([next() * 4.0 - 2.0, next() * 4.0 - 2.0, -0.5])),
        };
        tally.add(&tracer, &mesh, &receiver, &square_light());
    }
    assert_eq!(tally.different, 0);
    assert!(tally.hidden * 20 > tally.verdicts && tally.hidden * 20 < tally.verdicts * 19, "{}", tally.hidden);
}

/// Triangles, receivers and targets on a lattice: rays along axes, through corners and edges, within the faces of boxes.
#[test]
fn rays_along_axes_have_the_verdicts_of_the_brute_force() {
    let mut next = uniforms(13);
    let mut lattice = |size: f64| -> Vec3 { std::array::from_fn(|_| (next() * size).floor() - (size * 0.5).floor()) };
    let mut tally = Tally::default();
    for round in 0..400 {
        let mesh: Vec<Triangle> = (0..60).map(|_| std::array::from_fn(|_| lattice(7.0))).collect();
        let receiver = Receiver::at(lattice(9.0));
        let targets: Vec<Target> = (0..64)
            .map(|sample| {
                // One axis, one plane or no restriction; sometimes the receiver itself.
                let mut along = lattice(13.0);
                (0..sample % 3).for_each(|axis| along[(axis + round) % 3] = 0.0);
                if sample.is_multiple_of(4) {
                    Target::Direction(along)
                } else {
                    Target::Point(add(receiver.origin, along))
                }
            })
            .collect();
        let tracer = OcclusionTracer::new(&mesh).unwrap();
        tally.add(&tracer, &mesh, &receiver, &targets);
        // Each alone, too: a pyramid without width.
        for target in &targets[..8] {
            tally.add(&tracer, &mesh, &receiver, &[*target]);
        }
    }
    assert_eq!(tally.different, 0);
    assert!(tally.hidden * 20 > tally.verdicts && tally.hidden * 20 < tally.verdicts * 19, "{}", tally.hidden);
}

#[test]
fn crossings_are_the_triangles_that_block_alone() {
    let mut next = uniforms(14);
    let mut found = 0;
    for round in 0..40 {
        let mesh = hostile_mesh(&mut next, 60);
        let tracer = OcclusionTracer::new(&mesh).unwrap();
        let receiver = hostile_receiver(round, &mut next);
        for target in hostile_targets(round, &mesh[..], receiver.origin, &mut next).into_iter().take(16) {
            let alone = |index: &usize| {
                let free = Receiver { normal: None, excluded_triangle: None, ..receiver };
                let alone = RayReference::new(&mesh[*index..=*index]).unwrap();
                receiver.excluded_triangle != Some(*index)
                    && !alone.trace_receiver(&free, &[target]).unwrap()[0].visible
            };
            let expected: Vec<usize> = (0..mesh.len()).filter(alone).collect();
            found += expected.len();
            assert_eq!(tracer.crossings(&receiver, &target), expected, "round {round}");
        }
    }
    assert!(found > 100, "only {found} crossings");
}

#[test]
fn many_layers_are_all_counted() {
    let layer = |height: f64| [[-1.0, -1.0, height], [1.0, -1.0, height], [0.0, 1.0, height]];
    let mesh: Vec<Triangle> = (1..=100).map(|index| layer(f64::from(index))).collect();
    let tracer = OcclusionTracer::new(&mesh).unwrap();
    let receiver = Receiver { excluded_triangle: Some(3), ..Receiver::at([0.0; 3]) };
    assert_eq!(tracer.crossings(&receiver, &Target::Direction([0.0, 0.0, 1.0])).len(), 99);
    assert_eq!(tracer.crossings(&receiver, &Target::Point([0.0, 0.0, 6.0])), [0, 1, 2, 4]);
    assert_eq!(tracer.crossings(&receiver, &Target::Direction([0.0, 0.0, -1.0])), [0_usize; 0]);
}

#[test]
fn meshes_without_area_hide_nothing_and_bad_ones_are_typed_errors() {
    let point = [[[1.0; 3]; 3], [[0.0; 3]; 3]];
    let targets = [Target::Point([2.0; 3]), Target::Point([0.0, 0.0, -1.0])];
    let upward = Receiver { normal: Some([0.0, 0.0, 1.0]), ..Receiver::at([0.0; 3]) };
    for mesh in [&point[..], &[]] {
        assert_eq!(OcclusionTracer::new(mesh).unwrap().hidden(&upward, &targets), [false, true]);
    }
    let bad = [point[0], [[0.0, f64::NAN, 0.0]; 3]];
    assert!(matches!(OcclusionTracer::new(&bad), Err(MeasureError::NotFinite { index: 1, .. })));
}

/// Equal centers leave the bins nothing to cut, sizes that fall by halves leave them one box at a time.
#[test]
fn hierarchies_of_awkward_boxes_hold_every_triangle() {
    let stacked = |_: i32| [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    let shrinking = |index: i32| stacked(0).map(|corner| corner.map(|x| x * 0.5_f64.powi(index)));
    for mesh in [(0..100).map(stacked).collect::<Vec<_>>(), (0..100).map(shrinking).collect()] {
        let tracer = OcclusionTracer::new(&mesh).unwrap();
        let receiver = Receiver::at([0.0; 3]);
        assert_eq!(tracer.crossings(&receiver, &Target::Direction([0.0, 0.0, 1.0])).len(), 100);
    }
}
