//! What float32 kernels may decide otherwise that look at projected edges instead of rays.
//!
//! Such a kernel maps corners and edges onto the light, `g = rows·(v − p)` and `g_e = rows·e`, and says on which side
//! of an edge the sample (x, y, 1) lies by the sign of `(g×g_e)·(x, y, 1)`. It knows the side of a triangle by the sign
//! of `n·(p − v)` with its stored unit normal n, cuts geometry at the light's plane and rounds the corners that this
//! makes, and leaves out what lies below the horizon, by the sign of `normal·(s − p)`. In exact arithmetic all signs
//! are those of [`super::bounds`]: the projected determinants are those of the ray times `det(rows)` over a positive
//! number.
//!
//! | what decides | differs from the exact value by at most |
//! |---|---|
//! | an edge, `det(g, g_e, (x, y, 1))` | k·u of the permanent of the magnitudes of g, g_e and (x, y, 1) |
//! | T = n·(v − p) and D = n·(s − p) | 6·u·Σ\|nᵢ\|\|vᵢ − pᵢ\|, likewise with s |
//! | T − D, whether the target lies beyond | 6·u·Σ\|nᵢ\|(\|vᵢ − pᵢ\| + \|pᵢ\| + \|sᵢ\|): cut corners are rounded as coordinates, not as differences |
//! | `normal·(s − p)` | 4·u·Σ\|normalᵢ\|\|sᵢ − pᵢ\| |
//!
//! Magnitudes are sums of absolute terms: `magnitudes·|v − p|` for g. A kernel may start at either end of an edge and
//! at any corner of a triangle, so the larger bound counts. Its number k depends on how its rows came about, and is an
//! argument; [`needed_roundings`] tells how much of it a disagreement takes.
//!
//! Wrong when the kernel's rows are noise (the receiver lies in the light's plane), and too strict when |p| is a
//! hundred times
//! |v − p| and a cut made an edge of a corner that was rounded as a coordinate.
//!
//! Sources: Higham, *Accuracy and Stability of Numerical Algorithms*, 3.1.

use super::bounds::{PLANE_ROUNDINGS, relative_bound};
use super::contact::{Contact, Determinants};
use super::shadow_volume::Form;
use super::{Ray, beyond_horizon};
use crate::vector::{Vec3, abs, add, cross, dot, sub};
use crate::{Receiver, Target, Triangle};

/// How a float32 kernel maps a vector v − p to homogeneous coordinates on the light: h = rows·(v − p).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedView {
    /// The map; its third row is positive towards the light. The determinant may have either sign.
    pub rows: [[f64; 3]; 3],
    /// For each entry the sum of the absolute terms before cancellation, at least its absolute value.
    pub magnitudes: [[f64; 3]; 3],
}

/// One light sample in a [`ProjectedView`]: the point (x, y, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedSample {
    /// x and y.
    pub at: [f64; 2],
    /// Of each the sum of the absolute terms before cancellation, at least its absolute value.
    pub magnitude: [f64; 2],
    /// The same sample in world space.
    pub target: Target,
}

/// Whether a correct kernel with `roundings` roundings in an edge's determinant may decide either way. Over the horizon and
/// all triangles except the excluded one together: some evaluation within the bounds finds a blocker, and some finds none.
#[must_use]
pub fn grazing(
    triangles: &[Triangle],
    receiver: &Receiver,
    view: &ProjectedView,
    sample: &ProjectedSample,
    roundings: f64,
) -> bool {
    let projection = Projection::new(receiver, view, sample);
    let candidates = projection.candidates(triangles, receiver, roundings);
    together(beyond_horizon(receiver, &projection.ray), &candidates, roundings).is_grazing()
}

/// The smallest of 1, 2, 4, … up to `limit` roundings that make the sample [`grazing`]; `None` when none does.
#[must_use]
pub fn needed_roundings(
    triangles: &[Triangle],
    receiver: &Receiver,
    view: &ProjectedView,
    sample: &ProjectedSample,
    limit: f64,
) -> Option<f64> {
    let projection = Projection::new(receiver, view, sample);
    let horizon = beyond_horizon(receiver, &projection.ray);
    // What is impossible with the widest bounds is impossible with narrower ones.
    let candidates = projection.candidates(triangles, receiver, limit);
    std::iter::successors(Some(1.0), |roundings| Some(2.0 * roundings))
        .take_while(|roundings| *roundings <= limit)
        .find(|roundings| together(horizon, &candidates, *roundings).is_grazing())
}

fn together(horizon: Contact, candidates: &[Candidate], roundings: f64) -> Contact {
    candidates.iter().fold(horizon, |all, candidate| all.or(candidate.contact(roundings)))
}

/// The determinants of a triangle; those of its edges with sums of absolute terms in place of bounds.
struct Candidate(Determinants);

impl Candidate {
    fn contact(&self, roundings: f64) -> Contact {
        let edges = self.0.edges.map(|[value, sum]| [value, relative_bound(roundings) * sum]);
        Determinants { edges, ..self.0 }.contact()
    }
}

/// A corner or an edge on the light, with its magnitudes.
type Projected = [Vec3; 2];

/// One sample as one receiver sees it.
struct Projection<'a> {
    origin: Vec3,
    ray: Ray,
    view: &'a ProjectedView,
    /// (x, y, 1) with its magnitudes.
    sample: Projected,
    /// The sign of det(rows), which turns the projected determinants into those of the ray.
    handedness: f64,
    /// |p| + |s|, componentwise.
    coordinates: Vec3,
}

impl<'a> Projection<'a> {
    fn new(receiver: &Receiver, view: &'a ProjectedView, sample: &ProjectedSample) -> Self {
        let [x, y, z] = view.rows;
        let coordinates = match sample.target {
            Target::Point(point) => add(abs(receiver.origin), abs(point)),
            Target::Direction(_) => [0.0; 3],
        };
        let ([x_at, y_at], [x_magnitude, y_magnitude]) = (sample.at, sample.magnitude);
        Self {
            origin: receiver.origin,
            ray: Ray::new(receiver.origin, &sample.target),
            view,
            sample: [[x_at, y_at, 1.0], [x_magnitude, y_magnitude, 1.0]],
            handedness: dot(cross(x, y), z).signum(),
            coordinates,
        }
    }

    /// The triangles that are possible blockers.
    fn candidates(&self, triangles: &[Triangle], receiver: &Receiver, roundings: f64) -> Vec<Candidate> {
        triangles
            .iter()
            .enumerate()
            .filter(|(index, _)| receiver.excluded_triangle != Some(*index))
            .filter_map(|(_, triangle)| self.candidate(triangle, roundings))
            .filter(|candidate| candidate.contact(roundings).possible)
            .collect()
    }

    /// `None` as soon as the signs that are known leave neither side of the triangle.
    fn candidate(&self, triangle: &Triangle, roundings: f64) -> Option<Candidate> {
        let [v0, v1, v2] = *triangle;
        let corners = triangle.map(|corner| sub(corner, self.origin));
        let normal = cross(sub(v1, v0), sub(v2, v0));
        let size = abs(normal);
        let unit = relative_bound(PLANE_ROUNDINGS);
        let farthest = corners.iter().map(|corner| dot(size, abs(*corner))).fold(0.0, f64::max);
        let volume = [dot(normal, corners[0]), unit * farthest];
        let depth = [dot(normal, self.ray.direction), unit * dot(size, self.ray.magnitude)];
        let mut positive = volume[0] + volume[1] > 0.0 && depth[0] + depth[1] > 0.0;
        let mut negative = volume[0] - volume[1] < 0.0 && depth[0] - depth[1] < 0.0;
        if !(positive || negative) {
            return None;
        }
        let mut edges = [[0.0; 2]; 3];
        for (from, edge) in edges.iter_mut().enumerate() {
            let to = (from + 1) % 3;
            let [value, sum] = self.edge([corners[from], corners[to]], sub(triangle[to], triangle[from]));
            let bound = relative_bound(roundings) * sum;
            positive &= value + bound >= 0.0;
            negative &= value - bound <= 0.0;
            if !(positive || negative) {
                return None;
            }
            *edge = [value, sum];
        }
        let excess_bound = unit * (farthest + dot(size, self.coordinates));
        let excess = (!self.ray.at_infinity).then(|| [volume[0] - depth[0], excess_bound]);
        Some(Candidate(Determinants { edges, depth, volume, excess }))
    }

    /// The determinant of an edge between two corners, as the ray would have it, and the sum of its absolute terms from
    /// whichever end gives more.
    fn edge(&self, ends: [Vec3; 2], along: Vec3) -> [f64; 2] {
        let along = self.project(along);
        let [sample, magnitude] = self.sample;
        let [from, to] = ends.map(|end| Form::cross_of_sums(self.project(end), along).terms(sample, magnitude));
        [self.handedness * from[0], from[1].max(to[1])]
    }

    fn project(&self, vector: Vec3) -> Projected {
        let magnitude = abs(vector);
        [self.view.rows.map(|row| dot(row, vector)), self.view.magnitudes.map(|row| dot(row, magnitude))]
    }
}

#[cfg(test)]
mod tests;
