//! A float32 kernel that cuts triangles at the light's plane and projects their edges, right and wrong ones, on random
//! triangles close to the edges of their shadows.

use super::*;
use crate::RayReference;
use crate::test_scenes::{float32_vector, uniforms, vertex};
use crate::vector::{length, scale};

type V3 = [f32; 3];

/// Of g: one difference, one product, two additions; of an edge the same; the cross product two; the product with the
/// sample three. The rows are exact here.
const ROUNDINGS: f64 = 4.0 + 4.0 + 2.0 + 3.0;

struct Case {
    triangles: Vec<Triangle>,
    receiver: Receiver,
    view: ProjectedView,
    sample: ProjectedSample,
}

impl Case {
    /// Triangles between the receiver and the light, across the light's plane and beyond, around the ray; edges as
    /// close to it as float32 can tell.
    fn random(next: &mut impl FnMut() -> f64) -> Self {
        let rows = loop {
            let rows: [Vec3; 3] = std::array::from_fn(|_| float32_vector(next, 2.0));
            if dot(cross(rows[0], rows[1]), rows[2]).abs() > 0.2 {
                break rows;
            }
        };
        let origin = float32_vector(next, 2.0);
        let [x, y, _] = float32_vector(next, 2.0);
        let world = |h: Vec3| unproject(&rows, h);
        let ray = world([x, y, 1.0]);
        let triangles = (0..1 + (next() * 5.0) as usize)
            .map(|_| {
                // Every other one touches the light about as closely as its edge passes the ray.
                let touching = next() < 0.5;
                let at = if touching { 1.0 + (next() - 0.5) * 10_f64.powf(-7.0 * next()) } else { 0.2 + next() };
                let size = 0.15 * 10_f64.powf(-3.0 * next());
                // An edge that passes the ray at a distance between 1 and 1e-7 of its length, and a third corner.
                let distance = 2.0 * size * 10_f64.powf(-7.0 * next());
                let middle = add(scale(ray, at), float32_vector(next, distance));
                let along = float32_vector(next, 2.0 * size);
                let third = add(middle, float32_vector(next, 2.0 * size));
                [add(middle, along), sub(middle, along), third].map(|corner| vertex(add(origin, corner)))
            })
            .collect();
        let target = Target::Point(add(origin, ray));
        Self {
            triangles,
            receiver: Receiver::at(origin),
            view: view(rows),
            sample: ProjectedSample { at: [x, y], magnitude: [x.abs(), y.abs()], target },
        }
    }

    fn grazes(&self, roundings: f64) -> bool {
        grazing(&self.triangles, &self.receiver, &self.view, &self.sample, roundings)
    }

    fn is_visible(&self) -> bool {
        let reference = RayReference::new(&self.triangles).unwrap();
        reference.trace_receiver(&self.receiver, &[self.sample.target]).unwrap()[0].visible
    }

    /// The kernel's answer. `shift` moves the corners: what is wrong with it.
    fn kernel_sees(&self, shift: f64) -> bool {
        let rows = self.view.rows.map(single);
        let sample = [self.sample.at[0] as f32, self.sample.at[1] as f32, 1.0];
        let left_handed = dot(cross(self.view.rows[0], self.view.rows[1]), self.view.rows[2]) < 0.0;
        !self.triangles.iter().any(|triangle| {
            let [v0, v1, v2] = *triangle;
            let normal = cross(sub(v1, v0), sub(v2, v0));
            let normal = single(scale(normal, 1.0 / length(normal)));
            let origin = single(self.receiver.origin);
            let corners: Vec<V3> = self.cut(triangle).map(|corner| single(add(corner, [shift, 0.0, 0.0]))).collect();
            let front = corners.first().is_some_and(|corner| dot32(normal, sub32(*corner, origin)) > 0.0);
            let within = |(from, to): (&V3, &V3)| {
                let g = project32(rows, sub32(*from, origin));
                let side = dot32(cross32(g, project32(rows, sub32(*to, *from))), sample);
                if front == left_handed { side <= 0.0 } else { side >= 0.0 }
            };
            !corners.is_empty() && corners.iter().zip(corners.iter().cycle().skip(1)).all(within)
        })
    }

    /// The corners of what lies before the light's plane, at height 1 in the view.
    fn cut(&self, triangle: &Triangle) -> impl Iterator<Item = Vec3> {
        let height = |corner: Vec3| dot(self.view.rows[2], sub(corner, self.receiver.origin)) - 1.0;
        (0..3).flat_map(move |from| {
            let [from, to] = [triangle[from], triangle[(from + 1) % 3]];
            let [low, high] = [height(from), height(to)];
            let kept = (low < 0.0).then_some(from);
            let crossing = ((low < 0.0) != (high < 0.0)).then(|| add(from, scale(sub(to, from), low / (low - high))));
            [kept, crossing].into_iter().flatten()
        })
    }
}

/// The vector that the rows map to h.
fn unproject(rows: &[Vec3; 3], h: Vec3) -> Vec3 {
    let [x, y, z] = *rows;
    let sum = add(add(scale(cross(y, z), h[0]), scale(cross(z, x), h[1])), scale(cross(x, y), h[2]));
    scale(sum, 1.0 / dot(cross(x, y), z))
}

fn single(a: Vec3) -> V3 {
    a.map(|x| x as f32)
}

fn sub32(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot32(a: V3, b: V3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross32(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn project32(rows: [V3; 3], a: V3) -> V3 {
    rows.map(|row| dot32(row, a))
}

/// Disagreements of a kernel: all of them, and those that the roundings do not excuse.
fn disagreements(shift: f64, roundings: f64) -> [usize; 2] {
    let mut next = uniforms(21);
    let mut counts = [0; 2];
    for _ in 0..40_000 {
        let case = Case::random(&mut next);
        if case.kernel_sees(shift) != case.is_visible() {
            counts[0] += 1;
            counts[1] += usize::from(!case.grazes(roundings));
        }
    }
    counts
}

#[test]
fn a_correct_kernel_differs_on_grazing_samples_only() {
    let [all, unexcused] = disagreements(0.0, ROUNDINGS);
    assert!(all > 100, "only {all} disagreements to excuse");
    assert_eq!(unexcused, 0, "of {all}");
}

#[test]
fn bounds_that_are_too_small_are_noticed() {
    let [all, unexcused] = disagreements(0.0, 0.02);
    assert!(unexcused > 10, "{unexcused} of {all}");
}

#[test]
fn wrong_kernels_are_not_excused() {
    let [all, unexcused] = disagreements(1e-3, ROUNDINGS);
    assert!(unexcused > 1000, "{unexcused} of {all}");
}

#[test]
fn grazing_grows_with_the_roundings() {
    let mut next = uniforms(22);
    const CASES: usize = 5_000;
    let mut counts = [0; 10];
    for _ in 0..CASES {
        let case = Case::random(&mut next);
        let grazes: Vec<bool> = (0..10).map(|power| case.grazes(2_f64.powi(power))).collect();
        assert!(grazes.is_sorted(), "{grazes:?}");
        counts.iter_mut().zip(&grazes).for_each(|(count, grazes)| *count += usize::from(*grazes));
        let needed = grazes.iter().position(|grazes| *grazes).map(|power| 2_f64.powi(power as i32));
        let found = needed_roundings(&case.triangles, &case.receiver, &case.view, &case.sample, 512.0);
        assert_eq!(found, needed);
    }
    assert!(counts[9] > counts[0] + 100 && counts[9] + 100 < CASES, "{counts:?}");
}

#[test]
fn the_order_of_corners_and_triangles_changes_nothing() {
    let mut next = uniforms(23);
    for _ in 0..5_000 {
        let mut case = Case::random(&mut next);
        let before = [1.0, 8.0, 64.0].map(|roundings| case.grazes(roundings));
        case.triangles.reverse();
        case.triangles.iter_mut().for_each(|triangle| triangle.reverse());
        assert_eq!([1.0, 8.0, 64.0].map(|roundings| case.grazes(roundings)), before);
        case.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(1));
        assert_eq!([1.0, 8.0, 64.0].map(|roundings| case.grazes(roundings)), before);
    }
}
