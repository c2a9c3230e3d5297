//! The bounds where they can be worked out by hand; [`kernel`] has those of a float32 kernel on random triangles.

use super::*;
use crate::ray_reference::bounds::UNIT_ROUNDOFF;

mod kernel;

/// Receiver at the origin, light in the plane z = 1: projecting divides by z.
const STRAIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Its shadow on the light ends at x = 0.5, where the determinant of its edge at x = 0.25 has the permanent 0.25 and grows
/// by 0.25 per unit of x.
const BLOCKER: Triangle = [[0.25, -0.25, 0.5], [0.25, 0.25, 0.5], [-4.0, 0.0, 0.5]];

fn view(rows: [[f64; 3]; 3]) -> ProjectedView {
    ProjectedView { rows, magnitudes: rows.map(abs) }
}

fn sample(x: f64, y: f64) -> ProjectedSample {
    ProjectedSample { at: [x, y], magnitude: [x.abs(), y.abs()], target: Target::Point([x, y, 1.0]) }
}

fn direction(x: f64, y: f64) -> ProjectedSample {
    ProjectedSample { target: Target::Direction([x, y, 1.0]), ..sample(x, y) }
}

fn at_origin(triangle: &Triangle, sample: &ProjectedSample, roundings: f64) -> bool {
    grazing(&[*triangle], &Receiver::at([0.0; 3]), &view(STRAIGHT), sample, roundings)
}

/// How far x must go from 0.5 to leave the bound of an edge.
fn edge_bound(roundings: f64) -> f64 {
    roundings * UNIT_ROUNDOFF
}

#[test]
fn well_inside_and_well_outside_nothing_grazes() {
    for x in [-0.5, 0.3, 0.7, 2.0] {
        assert!(!at_origin(&BLOCKER, &sample(x, 0.0), 8.0), "{x}");
        assert!(!at_origin(&BLOCKER, &direction(x, 0.0), 8.0), "{x}");
    }
}

#[test]
fn samples_graze_an_edge_within_its_bound_only() {
    for make in [sample, direction] {
        for side in [-1.0, 1.0] {
            let off = |bounds: f64| make(0.5 + side * bounds * edge_bound(8.0), 0.0);
            assert!(at_origin(&BLOCKER, &off(0.0), 8.0));
            assert!(at_origin(&BLOCKER, &off(0.5), 8.0));
            assert!(at_origin(&BLOCKER, &off(0.98), 8.0));
            assert!(!at_origin(&BLOCKER, &off(1.02), 8.0));
            assert!(!at_origin(&BLOCKER, &off(4.0), 8.0));
        }
    }
}

#[test]
fn magnitudes_that_forget_the_cancellation_are_noticed() {
    let off = sample(0.5 + 5.0 * edge_bound(8.0), 0.0);
    let mut rows = view(STRAIGHT);
    rows.magnitudes = STRAIGHT.map(|row| row.map(|x| 10.0 * x));
    let receiver = Receiver::at([0.0; 3]);
    assert!(grazing(&[BLOCKER], &receiver, &rows, &off, 8.0));
    assert!(!grazing(&[BLOCKER], &receiver, &view(STRAIGHT), &off, 8.0));
    // x = 10.5 − 10 is known ten times worse than x = 0.5.
    let cancelled = ProjectedSample { magnitude: [20.5, 0.0], ..off };
    assert!(at_origin(&BLOCKER, &cancelled, 8.0) && !at_origin(&BLOCKER, &off, 8.0));
}

#[test]
fn samples_graze_the_horizon_within_its_bound_only() {
    // At x = 1 the height x − z is 0 with the terms 1 and 1: four roundings of 2.
    let receiver = Receiver { normal: Some([1.0, 0.0, -1.0]), ..Receiver::at([0.0; 3]) };
    let grazes = |triangles: &[Triangle], bounds: f64| {
        let x = 1.0 + bounds * 8.0 * UNIT_ROUNDOFF;
        grazing(triangles, &receiver, &view(STRAIGHT), &sample(x, 0.0), 8.0)
    };
    for side in [-1.0, 1.0] {
        assert!(grazes(&[], side * 0.9) && !grazes(&[], side * 1.1));
    }
    // What is hidden anyway does not graze.
    let cover = [[-8.0, -8.0, 0.5], [8.0, -8.0, 0.5], [0.0, 16.0, 0.5]];
    assert!(!grazes(&[cover], 0.0));
}

/// The plane z = 1 + x: it cuts the light along x = 0, and lies before it where x < 0.
const LEANING: Triangle = [[-0.5, -0.5, 0.5], [-0.5, 0.5, 0.5], [0.5, 0.0, 1.5]];

#[test]
fn samples_graze_where_a_triangle_crosses_the_light() {
    // With the normal (-1, 0, 1): T − D = x, Σ|a| = 2 at the farthest corner, |s| = 1.
    let bound = PLANE_ROUNDINGS * 3.0 * UNIT_ROUNDOFF;
    for side in [-1.0, 1.0] {
        assert!(at_origin(&LEANING, &sample(side * 0.98 * bound, 0.0), 8.0));
        assert!(!at_origin(&LEANING, &sample(side * 1.02 * bound, 0.0), 8.0));
    }
    // Seen from elsewhere its corners are rounded as coordinates.
    let moved = [10.0, 0.0, 0.0];
    let receiver = Receiver::at(moved);
    let away = LEANING.map(|corner| add(corner, moved));
    let near = ProjectedSample { target: Target::Point([10.0 + 4.0 * bound, 0.0, 1.0]), ..sample(4.0 * bound, 0.0) };
    assert!(grazing(&[away], &receiver, &view(STRAIGHT), &near, 8.0));
    // A direction has no end to lie before.
    assert!(!at_origin(&LEANING, &direction(0.0, 0.0), 8.0));
}

#[test]
fn planes_through_the_receiver_graze() {
    // The plane x − z = off, with the normal (1, 0, −1): T = off, D = 1.6 off, terms of up to 1.5 and 2.
    let edge_on = |off: f64| [[0.5 + off, -1.0, 0.5], [0.5 + off, 1.0, 0.5], [0.75 + off, 0.0, 0.75]];
    for (off, grazes) in [(0.0, true), (5.0, true), (-5.0, true), (60.0, false), (-60.0, false)] {
        let off = off * UNIT_ROUNDOFF;
        // Next to no roundings in the edges: they are not in doubt.
        assert_eq!(at_origin(&edge_on(off), &sample(1.0 + 1.6 * off, 0.0), 1e-3), grazes, "{off}");
    }
}

#[test]
fn the_excluded_triangle_does_not_graze() {
    let receiver = Receiver { excluded_triangle: Some(0), ..Receiver::at([0.0; 3]) };
    assert!(!grazing(&[BLOCKER], &receiver, &view(STRAIGHT), &sample(0.5, 0.0), 8.0));
    assert!(grazing(&[LEANING, BLOCKER], &receiver, &view(STRAIGHT), &sample(0.5, 0.0), 8.0));
}

#[test]
fn needed_roundings_are_the_smallest_power_of_two() {
    let receiver = Receiver::at([0.0; 3]);
    let needed = |bounds: f64, limit: f64| {
        needed_roundings(&[BLOCKER], &receiver, &view(STRAIGHT), &sample(0.5 + edge_bound(bounds), 0.0), limit)
    };
    assert_eq!(needed(0.0, 1024.0), Some(1.0));
    assert_eq!(needed(0.9, 1024.0), Some(1.0));
    assert_eq!(needed(-1.1, 1024.0), Some(2.0));
    assert_eq!(needed(5.0, 1024.0), Some(8.0));
    assert_eq!(needed(-900.0, 1024.0), Some(1024.0));
    assert_eq!(needed(900.0, 512.0), None);
}

#[test]
fn a_mirrored_view_says_the_same() {
    // Light coordinates (−x, y): the determinant of the rows is negative.
    let mirrored = view([[-1.0, 0.0, 0.0], STRAIGHT[1], STRAIGHT[2]]);
    let receiver = Receiver::at([0.0; 3]);
    for bounds in [-3.0, -0.5, 0.0, 0.5, 3.0] {
        let here = sample(0.5 + bounds * edge_bound(8.0), 0.0);
        let there = ProjectedSample { at: [-here.at[0], 0.0], ..here };
        let grazes = bounds.abs() < 1.0;
        assert_eq!(grazing(&[BLOCKER], &receiver, &view(STRAIGHT), &here, 8.0), grazes);
        assert_eq!(grazing(&[BLOCKER], &receiver, &mirrored, &there, 8.0), grazes);
        // The spoilt view: mirrored rows with a sample that is not.
        assert!(!grazing(&[BLOCKER], &receiver, &mirrored, &here, 8.0));
    }
}
