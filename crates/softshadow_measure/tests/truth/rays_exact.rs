//! The tracer against exact integer arithmetic, and its rules one by one.

use softshadow_measure::{MeasureError, RayReference, Receiver, SampleVerdict, Target, Triangle};

use crate::random::Random;

type Lattice = [i64; 3];

/// A number of at most 11 bits, so that determinants are exact in float64 and in i64 alike. Coarse steps make ties common.
fn lattice(random: &mut Random, step: i64) -> Lattice {
    std::array::from_fn(|_| (i64::from(random.bits() % 2001) - 1000) / step * step)
}

fn to_float(point: Lattice) -> [f64; 3] {
    point.map(|k| k as f64 / 256.0)
}

fn det(x: Lattice, y: Lattice, z: Lattice) -> i64 {
    x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) + x[2] * (y[0] * z[1] - y[1] * z[0])
}

/// The definition of a blocked segment, in integers. `strict_end` is the rule that only what is before the sample blocks.
fn blocked_exactly(p: Lattice, s: Lattice, face: [Lattice; 3], strict_end: bool) -> bool {
    let minus = |v: Lattice| -> Lattice { std::array::from_fn(|k| v[k] - p[k]) };
    let ([a, b, c], d) = (face.map(minus), minus(s));
    let edges = [det(d, a, b), det(d, b, c), det(d, c, a)];
    let depth: i64 = edges.iter().sum();
    let volume = det(a, b, c);
    let one_sided = edges.iter().all(|e| *e >= 0) || edges.iter().all(|e| *e <= 0);
    one_sided
        && volume != 0
        && depth != 0
        && volume.signum() == depth.signum()
        && (!strict_end || volume.abs() < depth.abs())
}

#[test]
fn verdicts_are_exact_on_lattices_including_ties() {
    let mut random = Random::new(1);
    let (mut blocked, mut spoilt, mut ties) = (0, 0, 0);
    for round in 0..400 {
        let step = [1, 50, 250, 500][round % 4];
        let faces: Vec<[Lattice; 3]> = (0..8).map(|_| std::array::from_fn(|_| lattice(&mut random, step))).collect();
        let mesh: Vec<Triangle> = faces.iter().map(|face| face.map(to_float)).collect();
        let scene = RayReference::new(&mesh).unwrap();
        let p = lattice(&mut random, step);
        let samples: Vec<Lattice> = (0..64).map(|_| lattice(&mut random, step)).collect();
        let targets: Vec<Target> = samples.iter().map(|s| Target::Point(to_float(*s))).collect();
        let verdicts = scene.trace_receiver(&Receiver::at(to_float(p)), &targets).unwrap();
        for (sample, verdict) in samples.iter().zip(&verdicts) {
            let any = |strict_end| faces.iter().any(|face| blocked_exactly(p, *sample, *face, strict_end));
            assert_eq!(!verdict.visible, any(true), "round {round}");
            blocked += usize::from(any(true));
            // A wrong rule must be seen: triangles beyond the sample count as blockers.
            spoilt += usize::from(verdict.visible && any(false));
            ties += usize::from(verdict.grazing);
        }
    }
    assert!(blocked > 1000 && spoilt > 100 && ties > 100, "{blocked} {spoilt} {ties}");
}

const COVER: Triangle = [[-9.0, -9.0, 1.0], [9.0, -9.0, 1.0], [0.0, 9.0, 1.0]];
const VISIBLE: SampleVerdict = SampleVerdict { visible: true, grazing: false };
const BLOCKED: SampleVerdict = SampleVerdict { visible: false, grazing: false };

fn one(mesh: &[Triangle], receiver: Receiver, target: Target) -> SampleVerdict {
    let scene = RayReference::new(mesh).unwrap();
    let verdicts = scene.trace(&[receiver], &[target]).unwrap();
    assert_eq!(verdicts.len(), 1);
    verdicts[0]
}

#[test]
fn each_rule_turns_a_verdict() {
    let above = Target::Point([0.0, 0.0, 2.0]);
    let receiver = Receiver::at([0.0; 3]);
    assert_eq!(one(&[], receiver, above), VISIBLE);
    assert_eq!(one(&[COVER], receiver, above), BLOCKED);
    let [a, b, c] = COVER;
    assert_eq!(one(&[[c, b, a]], receiver, above), BLOCKED);
    // Grazing alone, but not in front of a triangle that blocks for certain.
    let touched = [[-3.0, -3.0, 0.5], [3.0, 3.0, 0.5], [9.0, -9.0, 0.5]];
    assert!(one(&[touched], receiver, above).grazing);
    assert_eq!(one(&[touched, COVER], receiver, above), BLOCKED);
    // The sample is below the triangle; the same direction at infinity is not.
    assert_eq!(one(&[COVER], receiver, Target::Point([0.0, 0.0, 0.5])), VISIBLE);
    assert_eq!(one(&[COVER], receiver, Target::Direction([0.0, 0.0, 0.5])), BLOCKED);
    assert_eq!(one(&[COVER], receiver, Target::Direction([0.0, 0.0, -1.0])), VISIBLE);
    // No direction at all.
    assert_eq!(one(&[COVER], receiver, Target::Direction([0.0; 3])), VISIBLE);
    // Behind the receiver.
    assert_eq!(one(&[COVER], Receiver::at([0.0, 0.0, 1.5]), above), VISIBLE);
    // Degenerate triangles block nothing.
    assert!(one(&[[a, a, b]], receiver, above).visible);
}

#[test]
fn the_excluded_triangle_never_blocks() {
    let above = Target::Point([0.0, 0.0, 2.0]);
    let excluding = |index| Receiver { excluded_triangle: Some(index), ..Receiver::at([0.0; 3]) };
    let behind = COVER.map(|corner| [corner[0], corner[1], -1.0]);
    assert_eq!(one(&[behind, COVER], excluding(1), above), VISIBLE);
    assert_eq!(one(&[behind, COVER], excluding(0), above), BLOCKED);
    // A receiver that lies on its own sloping triangle grazes it unless it is excluded.
    let slope = COVER.map(|[x, y, z]| [x, y, z + x / 8.0]);
    let on_it = |excluded_triangle| Receiver { excluded_triangle, ..Receiver::at([0.5, 0.25, 1.0625]) };
    assert!(one(&[slope], on_it(None), above).grazing);
    assert_eq!(one(&[slope], on_it(Some(0)), above), VISIBLE);
}

#[test]
fn the_horizon_hides_and_grazes() {
    let facing = |normal| Receiver { normal: Some(normal), ..Receiver::at([0.25, 0.5, 0.0]) };
    let sample = Target::Point([1.25, 0.5, 1.0]);
    assert_eq!(one(&[], facing([0.0, 0.0, 1.0]), sample), VISIBLE);
    assert_eq!(one(&[], facing([0.0, 0.0, -1.0]), sample), BLOCKED);
    assert_eq!(one(&[], facing([0.0, 0.0, 1.0]), Target::Direction([9.0, 0.0, -1.0])), BLOCKED);
    let along = one(&[], facing([1.0, 0.0, -1.0]), sample);
    assert!(!along.visible && along.grazing);
    let barely = one(&[], facing([1.0 + 1e-7, 0.0, -1.0]), sample);
    assert!(barely.visible && barely.grazing);
    // 1e-6 is beyond 4 roundings of 2·2^-24: certain again.
    assert_eq!(one(&[], facing([1.0 + 1e-6, 0.0, -1.0]), sample), VISIBLE);
    // Every product is 0 and nothing is rounded.
    assert_eq!(one(&[], facing([0.0, 1.0, 0.0]), sample), BLOCKED);
}

#[test]
fn rows_are_receivers() {
    let scene = RayReference::new(&[COVER]).unwrap();
    let receivers = [Receiver::at([0.0; 3]), Receiver::at([50.0, 0.0, 0.0])];
    let targets = [[0.0, 0.0, 2.0], [0.0, 0.0, 0.5], [50.0, 0.0, 2.0]].map(Target::Point);
    let verdicts = scene.trace(&receivers, &targets).unwrap();
    let expected = [BLOCKED, VISIBLE, VISIBLE, VISIBLE, VISIBLE, VISIBLE];
    assert_eq!(verdicts, expected);
    assert!(scene.trace(&[], &targets).unwrap().is_empty());
    assert!(scene.trace(&receivers, &[]).unwrap().is_empty());
}

#[test]
fn bad_input_is_a_typed_error() {
    let not_finite = |what, index| MeasureError::NotFinite { what, index };
    let huge = [[1e39, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    let refused = RayReference::new(&[COVER, huge]).unwrap_err();
    assert_eq!(refused, not_finite("triangle", 1));
    let scene = RayReference::new(&[COVER]).unwrap();
    let good = Receiver::at([0.0; 3]);
    let bad = Receiver::at([0.0, f64::NAN, 0.0]);
    let target = Target::Point([0.0, 0.0, 2.0]);
    let refused = scene.trace(&[good, bad], &[target]).unwrap_err();
    assert_eq!(refused, not_finite("receiver", 1));
    let sideways = Receiver { normal: Some([f64::INFINITY, 0.0, 0.0]), ..good };
    let refused = scene.trace_receiver(&sideways, &[target]).unwrap_err();
    assert_eq!(refused, not_finite("receiver normal", 0));
    let nowhere = Target::Direction([f64::NAN; 3]);
    let refused = scene.trace(&[good], &[target, nowhere]).unwrap_err();
    assert_eq!(refused, not_finite("target direction", 1));
}
