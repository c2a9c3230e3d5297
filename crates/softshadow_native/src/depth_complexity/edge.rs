//! The image of an edge on the light: its line, the directions of its ends as seen from the reference point c, and on which side of it
//! c lies.

use glam::{DVec2, Vec3};
use softshadow_scene::occluders::OccluderEdge;

use super::view::LightView;

/// An edge as one receiver sees it, from its low corner to its high one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedEdge {
    /// Images of the corners; the same for every edge that ends there.
    pub ends: [Vec3; 2],
    /// The line through them: `line·(x, y, 1)` is positive left of it.
    pub line: Vec3,
    /// Whether c lies left of it (λ = +1); on the line counts as left, for everyone who asks.
    pub has_reference_left: bool,
}

impl ProjectedEdge {
    /// The image of an edge.
    ///
    /// Two questions, two answers. *Where is the line?* The product of an end's image and of the **edge's** image: a short edge far away
    /// has corners whose images agree in nearly all digits. It starts at the nearer end, whose image has the smaller error.
    /// *On which side is c?* By the **corners'** images, exactly: they are what sectors are made of, and a side of c that contradicts
    /// them would tear the image, and all samples beyond the tear would be wrong. (Products of two float32 are exact in float64.)
    #[must_use]
    pub fn new(view: &LightView, edge: &OccluderEdge) -> Self {
        let [low, high] = [edge.low, edge.high].map(Vec3::from);
        Self::from_images([low, high].map(|v| view.project(v - view.position)), view.project(high - low))
    }

    /// From the images of its ends and of the way between them.
    #[must_use]
    pub fn from_images(ends: [Vec3; 2], along: Vec3) -> Self {
        let size = |g: Vec3| g.abs().element_sum();
        let nearer = if size(ends[0]) <= size(ends[1]) { ends[0] } else { ends[1] };
        let line = nearer.cross(along);
        let [from, to] = ends.map(direction);
        Self { ends, line, has_reference_left: from.perp_dot(to) >= 0.0 }
    }

    /// Directions of the ends from c, low first; `None` when nothing of it lies ahead of the receiver.
    ///
    /// An end behind the receiver's plane is replaced by where the edge crosses that plane, which is infinitely far: a direction,
    /// the ends weighted with each other's depth. No division, no epsilon.
    #[must_use]
    pub fn directions(&self) -> Option<[DVec2; 2]> {
        let [low, high] = self.ends;
        let along = || high.truncate().as_dvec2() * f64::from(low.z) - low.truncate().as_dvec2() * f64::from(high.z);
        match [low.z > 0.0, high.z > 0.0] {
            [true, true] => Some([direction(low), direction(high)]),
            [true, false] => Some([direction(low), along()]),
            [false, true] => Some([-along(), direction(high)]),
            [false, false] => None,
        }
    }

    /// On which side of the *line* c counts, for a sample in the sector of these directions.
    ///
    /// Where the line passes c within rounding, its own sign is noise. If c lies between the ends the sector is nearly a half plane,
    /// and λ says which; if the edge points at c the sector is nearly nothing, and the line's own sign is the better one.
    #[must_use]
    pub fn line_has_reference_left(&self, [from, to]: [DVec2; 2]) -> bool {
        if from.dot(to) < 0.0 { self.has_reference_left } else { self.line.z >= 0.0 }
    }

    /// Whether both ends lie beyond one side of these bounds of the light: then no way from c to the light crosses it.
    #[must_use]
    pub fn misses(&self, [low, high]: [[f32; 2]; 2]) -> bool {
        let [a, b] = self.ends;
        let beyond = |outside: &dyn Fn(Vec3) -> bool| outside(a) && outside(b);
        beyond(&|g| g.x > high[0] * g.z)
            || beyond(&|g| g.x < low[0] * g.z)
            || beyond(&|g| g.y > high[1] * g.z)
            || beyond(&|g| g.y < low[1] * g.z)
    }

    /// The part in front of a sphere's disc; `None` when there is none.
    ///
    /// An edge that passes the disc's plane does so outside the disc (else it would touch the ball), so the new end is never
    /// crossed and needs not be shared with a neighbour.
    #[must_use]
    pub fn before(mut self, view: &LightView, edge: &OccluderEdge) -> Option<Self> {
        let Some((towards, limit)) = view.limit else { return Some(self) };
        let depths = [edge.low, edge.high].map(|v| towards.dot(Vec3::from(v) - view.position));
        match depths.map(|depth| depth < limit) {
            [true, true] => {}
            [false, false] => return None,
            [low_is_before, _] => {
                let t = (limit - depths[0]) / (depths[1] - depths[0]);
                let cut = self.ends[0] + (self.ends[1] - self.ends[0]) * t;
                self.ends[usize::from(low_is_before)] = cut;
            }
        }
        Some(self)
    }
}

/// The direction of an image. One that falls on c itself has none and gets one, the same for every edge that ends there.
fn direction(image: Vec3) -> DVec2 {
    let direction = image.truncate().as_dvec2();
    if direction == DVec2::ZERO { DVec2::X } else { direction }
}
