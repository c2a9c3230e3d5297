//! The part of a triangle in front of a light's plane, and whether a triangle touches a light's ball.
//!
//! A cut side is evaluated from its lower corner to its higher, whichever triangle asks and however it is wound. So both triangles
//! at an edge get the same cut corner bit for bit, and the edge stays one edge.

use glam::{DVec3, Vec3};

/// How far beyond the ball a triangle still counts as touching it, as a part of the radius: well above a rounding of the float32
/// corners relative to a frame of which the ball is a fair part, and far below anything that a picture shows.
pub(super) const TOUCH_MARGIN: f64 = 1e-6;

/// A convex polygon of at most four corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Polygon {
    corners: [[f32; 3]; 4],
    count: usize,
}

impl Polygon {
    const EMPTY: Self = Self { corners: [[0.0; 3]; 4], count: 0 };

    /// The whole triangle.
    pub(super) fn whole(&[a, b, c]: &[[f32; 3]; 3]) -> Self {
        Self { corners: [a, b, c, c], count: 3 }
    }

    /// The corners in the order of the winding.
    pub(super) fn corners(&self) -> &[[f32; 3]] {
        &self.corners[..self.count]
    }

    /// Adds a corner, unless rounding moved it onto the one before.
    fn push(&mut self, corner: [f32; 3]) {
        if self.corners().last() != Some(&corner) {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    fn close(&mut self) {
        if self.count > 1 && self.corners[0] == self.corners[self.count - 1] {
            self.count -= 1;
        }
    }
}

/// What a plane leaves of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Front {
    /// Nothing.
    Behind,
    /// All of it; it may touch the plane.
    Whole,
    /// This polygon; it has fewer than three corners where rounding left no area.
    Part(Polygon),
}

/// Cuts a triangle, corners in canonical order, with the plane through `point` and keeps what lies on the side of `normal`.
pub(super) fn in_front(corners: &[[f32; 3]; 3], point: DVec3, normal: DVec3) -> Front {
    let wide = corners.map(widen);
    let heights = wide.map(|corner| normal.dot(corner - point));
    if !heights.iter().any(|&z| z > 0.0) {
        return Front::Behind;
    }
    if !heights.iter().any(|&z| z < 0.0) {
        return Front::Whole;
    }
    let mut part = Polygon::EMPTY;
    for [from, to] in [[0, 1], [1, 2], [2, 0]] {
        if heights[from] >= 0.0 {
            part.push(corners[from]);
        }
        let (low, high) = (from.min(to), from.max(to));
        if heights[low].min(heights[high]) < 0.0 && heights[low].max(heights[high]) > 0.0 {
            let t = heights[low] / (heights[low] - heights[high]);
            // Adding +0 turns −0 into +0: equal positions must be equal bits.
            part.push(((wide[low] + t * (wide[high] - wide[low])).as_vec3() + Vec3::ZERO).to_array());
        }
    }
    part.close();
    Front::Part(part)
}

/// Whether a triangle with an area touches a ball.
pub(super) fn touches(corners: &[[f32; 3]; 3], center: DVec3, radius: f64) -> bool {
    distance(corners.map(widen), center) <= radius * (1.0 + TOUCH_MARGIN)
}

/// Distance from a point to a triangle with an area: to its plane above the inside, else to the nearest side.
fn distance([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let normal = (b - a).cross(c - a);
    let sides = [[a, b], [b, c], [c, a]];
    if sides.iter().all(|&[from, to]| normal.cross(to - from).dot(point - from) >= 0.0) {
        return normal.dot(point - a).abs() / normal.length();
    }
    let to_side = |[from, to]: [DVec3; 2]| {
        let along = to - from;
        let t = (along.dot(point - from) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + t * along)
    };
    sides.map(to_side).into_iter().fold(f64::INFINITY, f64::min)
}

pub(super) fn widen(corner: [f32; 3]) -> DVec3 {
    Vec3::from(corner).as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [3.0, 0.0, 0.0]];

    #[test]
    fn distances_in_every_region_of_a_triangle() {
        let cases = [
            ([1.0, 1.0, 2.0], 2.0),
            ([1.0, 1.0, 0.0], 0.0),
            ([-3.0, -4.0, 12.0], 13.0),
            ([-3.0, 7.0, 0.0], 18f64.sqrt()),
            ([6.0, -4.0, 0.0], 5.0),
            ([-2.0, 1.0, 0.0], 2.0),
            ([1.0, -2.0, 0.0], 2.0),
            ([1.5 + 4.0, 2.0 + 3.0, 0.0], 5.0),
        ];
        for (point, expected) in cases {
            let got = distance(TRIANGLE.map(widen), DVec3::from(point));
            assert!((got - expected).abs() < 1e-14, "{point:?}: {got}");
        }
    }

    #[test]
    fn a_ball_touches_a_side_a_corner_and_the_inside_up_to_the_margin() {
        for (center, at) in [([1.0, 1.0, 2.0], 2.0), ([-3.0, -4.0, 12.0], 13.0), ([5.5, 5.0, 0.0], 5.0)] {
            let center = DVec3::from(center);
            assert!(touches(&TRIANGLE, center, at), "exactly at it");
            assert!(touches(&TRIANGLE, center, at * (1.0 - 0.5e-6)), "within the margin");
            assert!(!touches(&TRIANGLE, center, at * (1.0 - 2e-6)), "outside the margin");
        }
    }

    #[test]
    fn corners_that_only_touch_the_plane_leave_a_triangle_whole_or_behind() {
        let plane = |point: [f64; 3], normal: [f64; 3]| in_front(&TRIANGLE, point.into(), normal.into());
        assert_eq!(plane([0.0; 3], [0.0, 1.0, 0.0]), Front::Whole, "a side in the plane");
        assert_eq!(plane([0.0, 4.0, 0.0], [0.0, -1.0, 0.0]), Front::Whole, "a corner in the plane");
        assert_eq!(plane([0.0, 4.0, 0.0], [0.0, 1.0, 0.0]), Front::Behind, "a corner in the plane, the others behind");
        assert_eq!(plane([0.0; 3], [0.0, 0.0, 1.0]), Front::Behind, "all in the plane");
    }

    #[test]
    fn a_plane_through_a_corner_keeps_that_corner() {
        // The height of [3, 0, 0] is zero exactly, [0, 4, 0] lies in front and the origin behind.
        let normal = DVec3::new(0.6, 0.8, 0.0);
        let Front::Part(part) = in_front(&TRIANGLE, DVec3::new(3.0, 0.0, 0.0), normal) else { panic!("a part") };
        assert_eq!(part.corners(), [[0.0, 2.25, 0.0], [0.0, 4.0, 0.0], [3.0, 0.0, 0.0]]);
    }

    #[test]
    fn a_cut_corner_that_rounds_onto_the_first_corner_is_merged_with_it() {
        // The plane cuts the side from the first corner to the last so close to the first that float32 cannot tell.
        let corners = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
        let normal = DVec3::new(-1.0, 1.0, 0.0);
        let Front::Part(part) = in_front(&corners, DVec3::new(1.0 + 1e-9, 0.0, 0.0), normal) else { panic!("a part") };
        assert_eq!(part.corners(), [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.5, 0.5, 0.0]]);
    }

    #[test]
    fn a_cut_corner_has_no_negative_zero() {
        let corners = [[-1e-45, 0.0, 1.0], [-1e-45, 1.0, -1.0], [1e-45, 0.0, -1.0]];
        let Front::Part(part) = in_front(&corners, DVec3::new(0.0, 0.0, 0.5), DVec3::Z) else { panic!("a part") };
        assert!(part.corners().as_flattened().iter().all(|x| x.to_bits() != (-0f32).to_bits()), "{part:?}");
    }

    #[test]
    fn a_part_that_rounds_to_nothing_has_fewer_than_three_corners() {
        // The plane leaves less than half a float32 step of the corner.
        let sharp = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        let Front::Part(part) = in_front(&sharp, DVec3::new(1.0 - 1e-9, 0.0, 0.0), DVec3::X) else { panic!("a part") };
        assert!(part.corners().len() < 3, "{part:?}");
    }
}
