//! Which boxes a ray, or the pyramid of all rays of one receiver, can enter.

use crate::vector::Vec3;

/// Boxes grow by this part of the scene's largest coordinate, on every side: the resolution of float32. The float64 test of
/// a triangle may find a hit about 1e-15 of the scene off the triangle, and further off the more edge-on the ray is.
const PADDING: f64 = 1.0 / 16_777_216.0;

/// Components below this count as this: no coordinate that fits a float32 overflows float64 when divided by it.
const SMALLEST_COMPONENT: f64 = 1e-200;

/// Where a beam starts, with room for the padding of the boxes.
#[derive(Clone, Copy)]
pub(super) struct Apex {
    /// Subtracted from the low corner of boxes.
    above: Vec3,
    /// Subtracted from the high corner of boxes.
    below: Vec3,
}

impl Apex {
    /// `reach` is the largest coordinate of the scene.
    pub(super) fn new(origin: Vec3, reach: f64) -> Self {
        let largest = origin.iter().fold(reach, |largest, x| largest.max(x.abs()));
        let padding = PADDING * largest;
        Self { above: origin.map(|x| x + padding), below: origin.map(|x| x - padding) }
    }
}

/// Something that leaves a receiver and enters boxes.
pub(super) trait Beam {
    /// A lower bound of the ray parameter (0 at the receiver, 1 at a target point) at which it enters, `None` for a miss.
    fn entry(&self, low: &Vec3, high: &Vec3) -> Option<f64>;
}

fn inverse(component: f64) -> f64 {
    1.0 / if component.abs() < SMALLEST_COMPONENT { SMALLEST_COMPONENT.copysign(component) } else { component }
}

/// Unlike `f64::min`, one instruction; no NaN gets here.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

fn end(at_infinity: bool) -> f64 {
    if at_infinity { f64::INFINITY } else { 1.0 }
}

/// One ray.
pub(super) struct Slabs {
    apex: Apex,
    inverse: Vec3,
    end: f64,
}

impl Slabs {
    pub(super) fn new(apex: Apex, direction: Vec3, at_infinity: bool) -> Self {
        Self { apex, inverse: direction.map(inverse), end: end(at_infinity) }
    }
}

impl Beam for Slabs {
    #[inline]
    fn entry(&self, low: &Vec3, high: &Vec3) -> Option<f64> {
        let (mut first, mut last) = (0.0, self.end);
        for axis in 0..3 {
            let at_low = (low[axis] - self.apex.above[axis]) * self.inverse[axis];
            let at_high = (high[axis] - self.apex.below[axis]) * self.inverse[axis];
            first = larger(first, smaller(at_low, at_high));
            last = smaller(last, larger(at_low, at_high));
        }
        (first <= last).then_some(first)
    }
}

/// All rays of one receiver: those whose directions lie in a box.
#[derive(Clone, Copy)]
pub(super) struct Pyramid {
    low: Vec3,
    high: Vec3,
    holds_directions: bool,
}

impl Pyramid {
    pub(super) const EMPTY: Self =
        Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], holds_directions: false };

    pub(super) fn add(&mut self, direction: Vec3, at_infinity: bool) {
        self.low = std::array::from_fn(|axis| smaller(self.low[axis], direction[axis]));
        self.high = std::array::from_fn(|axis| larger(self.high[axis], direction[axis]));
        self.holds_directions |= at_infinity;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.low[0] > self.high[0]
    }

    pub(super) fn holds_directions(&self) -> bool {
        self.holds_directions
    }

    /// The least and the greatest value of `form·d` over the pyramid, a little widened: the rounding of `form·d` for any
    /// single ray stays inside.
    pub(super) fn range(&self, form: Vec3) -> [f64; 2] {
        // Three products and two sums on each side: 1e-14 is ten times what they can lose.
        const ROUNDING: f64 = 1e-14;
        let (mut least, mut greatest, mut magnitude) = (0.0, 0.0, 0.0);
        for (factor, (low, high)) in form.into_iter().zip(self.low.into_iter().zip(self.high)) {
            let (x, y) = (factor * low, factor * high);
            least += smaller(x, y);
            greatest += larger(x, y);
            magnitude += larger(x.abs(), y.abs());
        }
        [least - ROUNDING * magnitude, greatest + ROUNDING * magnitude]
    }

    pub(super) fn from(self, apex: Apex) -> PyramidSlabs {
        PyramidSlabs {
            apex,
            low: self.low.map(Bound::by),
            high: self.high.map(Bound::by),
            end: end(self.holds_directions),
        }
    }
}

/// What `t·component <= limit` or `>= limit` says about t.
#[derive(Clone, Copy)]
struct Bound {
    inverse: f64,
    positive: bool,
}

impl Bound {
    fn by(component: f64) -> Self {
        Self { inverse: inverse(component), positive: component >= 0.0 }
    }
}

/// The pyramid as boxes meet it: at t every axis spans `[t·low, t·high]`, which the box must overlap on all three at one t.
pub(super) struct PyramidSlabs {
    apex: Apex,
    low: [Bound; 3],
    high: [Bound; 3],
    end: f64,
}

impl Beam for PyramidSlabs {
    #[inline]
    fn entry(&self, low: &Vec3, high: &Vec3) -> Option<f64> {
        let (mut first, mut last) = (0.0, self.end);
        for axis in 0..3 {
            let at_low = (low[axis] - self.apex.above[axis]) * self.high[axis].inverse;
            if self.high[axis].positive {
                first = larger(first, at_low);
            } else {
                last = smaller(last, at_low);
            }
            let at_high = (high[axis] - self.apex.below[axis]) * self.low[axis].inverse;
            if self.low[axis].positive {
                last = smaller(last, at_high);
            } else {
                first = larger(first, at_high);
            }
        }
        (first <= last).then_some(first)
    }
}
