//! One triangle as one receiver sees it: linear functions of the direction that decide whether a ray is blocked.

use super::Ray;
use super::bounds::{DETERMINANT_ROUNDINGS, relative_bound};
use super::contact::{Contact, Determinants};
use crate::Triangle;
use crate::vector::{Vec3, abs, add, cross, dot, scale, sub};

/// The box of all rays of one receiver.
pub(super) struct TargetHull {
    center: Vec3,
    half: Vec3,
    /// Largest |direction|, componentwise.
    reach: Vec3,
    holds_directions: bool,
}

impl TargetHull {
    /// `None` without rays.
    pub(super) fn around<'a>(rays: impl Iterator<Item = &'a Ray>) -> Option<Self> {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut holds_directions = false;
        for ray in rays {
            holds_directions |= ray.at_infinity;
            for axis in 0..3 {
                low[axis] = low[axis].min(ray.direction[axis]);
                high[axis] = high[axis].max(ray.direction[axis]);
            }
        }
        (low[0] <= high[0]).then(|| Self {
            center: scale(add(low, high), 0.5),
            half: scale(sub(high, low), 0.5),
            reach: std::array::from_fn(|axis| low[axis].abs().max(high[axis].abs())),
            holds_directions,
        })
    }
}

/// A linear function of the direction d with its rounding bound: `value·d ± (k·u) permanent·|d|`.
#[derive(Clone, Copy)]
pub(super) struct Form {
    value: Vec3,
    permanent: Vec3,
}

impl Form {
    /// d ↦ d·(x×y).
    pub(super) fn cross(x: Vec3, y: Vec3) -> Self {
        Self::cross_of_sums([x, abs(x)], [y, abs(y)])
    }

    /// The same for vectors that are themselves sums, each given with the componentwise sum of absolute terms.
    pub(super) fn cross_of_sums([x, p]: [Vec3; 2], [y, q]: [Vec3; 2]) -> Self {
        Self {
            value: cross(x, y),
            permanent: [p[1] * q[2] + p[2] * q[1], p[2] * q[0] + p[0] * q[2], p[0] * q[1] + p[1] * q[0]],
        }
    }

    /// Value and rounding bound for one direction, given with its componentwise magnitude.
    fn at(&self, direction: Vec3, magnitude: Vec3) -> [f64; 2] {
        let [value, sum] = self.terms(direction, magnitude);
        [value, relative_bound(DETERMINANT_ROUNDINGS) * sum]
    }

    /// The sum of its terms, and that of their absolute values.
    pub(super) fn terms(&self, direction: Vec3, magnitude: Vec3) -> [f64; 2] {
        [dot(self.value, direction), dot(self.permanent, magnitude)]
    }

    /// Middle and half width of an interval that holds value ± bound for every ray of the hull. The bound is widened by a
    /// thousandth, far more than the rounding of the interval itself, so that what is culled here is never possible there.
    fn over(&self, hull: &TargetHull) -> [f64; 2] {
        let bound = relative_bound(DETERMINANT_ROUNDINGS) * 1.001 * dot(self.permanent, hull.reach);
        let half_width = dot(abs(self.value), hull.half) + bound;
        [dot(self.value, hull.center), half_width]
    }
}

/// The infinite pyramid behind the triangle, with the receiver at its apex.
pub(super) struct ShadowVolume {
    /// E01, E12 and −E02: on which side of the planes through the receiver and each edge.
    edges: [Form; 3],
    /// D = d·(e1×e2), how far the ray goes across the plane of the triangle. Equal to the sum of the edges but rounded much
    /// less: a small triangle far away has small e1 and e2.
    depth: Form,
    /// T = a·(e1×e2), how far that plane is, six times the volume of the tetrahedron; with its rounding bound.
    volume: f64,
    volume_bound: f64,
}

impl ShadowVolume {
    pub(super) fn new(origin: Vec3, triangle: &Triangle) -> Self {
        let [v0, v1, v2] = *triangle;
        let (a, b) = (sub(v0, origin), sub(v1, origin));
        let (e1, e2) = (sub(v1, v0), sub(v2, v0));
        let depth = Form::cross(e1, e2);
        let [volume, volume_bound] = depth.at(a, abs(a));
        let edges = [Form::cross(a, e1), Form::cross(b, sub(v2, v1)), Form::cross(e2, a)];
        Self { edges, depth, volume, volume_bound }
    }

    /// False only when [`Self::contact`] finds no possible hit for any ray of the hull: the same inequalities, each over
    /// an interval that holds all rays.
    pub(super) fn may_touch(&self, hull: &TargetHull) -> bool {
        let mut positive = self.volume + self.volume_bound > 0.0;
        let mut negative = self.volume - self.volume_bound < 0.0;
        for edge in &self.edges {
            let [middle, half_width] = edge.over(hull);
            positive &= middle + half_width >= 0.0;
            negative &= middle - half_width <= 0.0;
            if !(positive || negative) {
                return false;
            }
        }
        if hull.holds_directions {
            return true;
        }
        let [middle, half_width] = self.depth.over(hull);
        let (volume, bound) = (self.volume, self.volume_bound);
        (positive && volume - bound < middle + half_width) || (negative && -volume - bound < half_width - middle)
    }

    /// Whether the triangle blocks the ray.
    pub(super) fn contact(&self, ray: &Ray) -> Contact {
        let mut positive = self.volume + self.volume_bound > 0.0;
        let mut negative = self.volume - self.volume_bound < 0.0;
        let mut edges = [[0.0; 2]; 3];
        for (edge, form) in edges.iter_mut().zip(&self.edges) {
            let [value, bound] = form.at(ray.direction, ray.magnitude);
            positive &= value + bound >= 0.0;
            negative &= value - bound <= 0.0;
            if !(positive || negative) {
                return Contact::NONE;
            }
            *edge = [value, bound];
        }
        let depth = self.depth.at(ray.direction, ray.magnitude);
        let volume = [self.volume, self.volume_bound];
        let excess = (!ray.at_infinity).then(|| [volume[0] - depth[0], volume[1] + depth[1]]);
        Determinants { edges, depth, volume, excess }.contact()
    }
}
