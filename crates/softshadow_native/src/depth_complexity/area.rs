//! How much of the light lies beyond an edge: exact areas instead of samples.
//!
//! The integral of `D` over the light is `D(c)·A − Σ λ·w·(area beyond the edge in its sector)`, because `D` changes by −λ·w exactly
//! there. Where a single layer of depth m lies between receiver and light, the hidden area is that integral over m: no sampling noise.
//! Whether there is a single layer, the counters suggest: no sample sees another depth.

use glam::{Vec2, Vec3};
use softshadow_scene::Outline;

/// Areas are summed as integers of this many to a unit, so that the order of edges changes no bit.
const UNITS: f64 = 16_777_216.0;

/// A sum of areas of the light, in fixed point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AreaSum(i64);

impl AreaSum {
    /// Adds `times` an area.
    pub fn add(&mut self, area: f32, times: i32) {
        self.0 += (f64::from(area) * UNITS).round() as i64 * i64::from(times);
    }

    /// The sum, in the units of the outline.
    #[must_use]
    pub fn value(self) -> f64 {
        self.0 as f64 / UNITS
    }
}

/// Area of the light between the directions `from` and `to` (counter-clockwise, less than a half turn) and beyond the line, which
/// crosses both. `line·(x, y, 1)` is positive on the side of the origin, which is the reference point.
#[must_use]
pub fn area_beyond(outline: &Outline, line: Vec3, from: Vec2, to: Vec2) -> f32 {
    match outline {
        Outline::Polygon(corners) => {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).map(|(a, b)| beyond_side(line, [from, to], [Vec2::from(*a), Vec2::from(*b)])).sum()
        }
        Outline::Disc(center) => beyond_arc(line, [from, to], Vec2::from(*center)),
    }
}

/// The part between the origin and one side of the light, negative for a side that turns away from the origin: the light is the sum
/// of its sides' triangles.
fn beyond_side(line: Vec3, sector: [Vec2; 2], [a, b]: [Vec2; 2]) -> f32 {
    let turn = a.perp_dot(b);
    if turn == 0.0 {
        return 0.0;
    }
    let side = if turn > 0.0 { [a, b] } else { [b, a] };
    let Some([first, last]) = common_sector(sector, side) else { return 0.0 };
    // Where the borders of the common sector meet the side, and how far beyond the line that is.
    let (mut p, mut q) = (on_side(side, first), on_side(side, last));
    let (at_p, at_q) = (height(line, p), height(line, q));
    match [at_p < 0.0, at_q < 0.0] {
        [false, false] => return 0.0,
        [true, true] => {}
        [p_is_beyond, _] => {
            let crossing = p + (q - p) * (at_p / (at_p - at_q));
            *(if p_is_beyond { &mut q } else { &mut p }) = crossing;
        }
    }
    let beyond = p.perp_dot(q) * 0.5 * (1.0 - share_before(line, p) * share_before(line, q));
    if turn > 0.0 { beyond } else { -beyond }
}

/// Where two sectors, each below a half turn, overlap.
fn common_sector([a, b]: [Vec2; 2], [u, v]: [Vec2; 2]) -> Option<[Vec2; 2]> {
    let holds = |from: Vec2, to: Vec2, d: Vec2| from.perp_dot(d) >= 0.0 && d.perp_dot(to) >= 0.0;
    let first = if holds(a, b, u) {
        u
    } else if holds(u, v, a) {
        a
    } else {
        return None;
    };
    let last = if holds(a, b, v) {
        v
    } else if holds(u, v, b) {
        b
    } else {
        return None;
    };
    Some([first, last])
}

/// The point of a side in a direction within the side's sector.
fn on_side([a, b]: [Vec2; 2], direction: Vec2) -> Vec2 {
    let (from_a, to_b) = (a.perp_dot(direction), direction.perp_dot(b));
    let whole = from_a + to_b;
    if whole > 0.0 { a + (b - a) * (from_a / whole) } else { a }
}

fn height(line: Vec3, p: Vec2) -> f32 {
    line.truncate().dot(p) + line.z
}

/// The share of the way from the origin to a point beyond the line (or on it) that lies before the line.
fn share_before(line: Vec3, p: Vec2) -> f32 {
    let fall = -line.truncate().dot(p);
    if fall > 0.0 { (line.z / fall).clamp(0.0, 1.0) } else { 1.0 }
}

fn beyond_arc(line: Vec3, [from, to]: [Vec2; 2], center: Vec2) -> f32 {
    // Where the line enters and leaves the disc, counter-clockwise as seen from the origin: the origin lies left of the chord.
    let normal = line.truncate();
    let length = normal.length();
    let depth = (normal.dot(center) + line.z) / length.max(f32::MIN_POSITIVE);
    let half_chord = (1.0 - depth * depth).max(0.0).sqrt();
    if half_chord <= 0.0 {
        return 0.0;
    }
    let normal = normal / length;
    let middle = center - normal * depth;
    // The side of the origin is where the normal points; turning counter-clockwise about it runs along the normal turned by −90°… +90°.
    let along = Vec2::new(-normal.y, normal.x);
    let ends = [middle - along * half_chord, middle + along * half_chord];
    let chord = if ends[0].perp_dot(ends[1]) >= 0.0 { ends } else { [ends[1], ends[0]] };
    let Some([first, last]) = common_sector([from, to], chord) else { return 0.0 };
    let (p, q) = (on_circle(center, first), on_circle(center, last));
    let (x, y) = (p - center, q - center);
    let angle = x.perp_dot(y).atan2(x.dot(y));
    let angle = if angle < 0.0 { angle + std::f32::consts::TAU } else { angle };
    let swept = angle + center.perp_dot(q - p);
    (swept - p.perp_dot(q) * share_before(line, p) * share_before(line, q)) * 0.5
}

/// Where the circle of radius 1 around `center`, which holds the origin, is met in a direction.
fn on_circle(center: Vec2, direction: Vec2) -> Vec2 {
    let d = direction.normalize_or_zero();
    let along = d.dot(center);
    d * (along + (along * along + 1.0 - center.length_squared()).max(0.0).sqrt())
}
