//! The image of an edge on the light: its line, and the directions of its ends as seen from the reference point.

use glam::{Vec2, Vec3};
use softshadow_scene::occluders::OccluderEdge;

use super::view::LightView;

/// An edge as one receiver sees it, from its low corner to its high one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedEdge {
    /// Images of the corners.
    pub ends: [Vec3; 2],
    /// The line through them: `line·(x, y, 1)` is positive left of it. Its z is the side of c.
    pub line: Vec3,
}

impl ProjectedEdge {
    /// The image of an edge.
    ///
    /// The line is the product of a corner's image and of the *edge's* image, not of two corners': a short edge far away has
    /// corners whose images agree in nearly all digits.
    #[must_use]
    pub fn new(view: &LightView, edge: &OccluderEdge) -> Self {
        let [low, high] = [edge.low, edge.high].map(Vec3::from);
        let ends = [low, high].map(|v| view.project(v - view.position));
        Self { ends, line: ends[0].cross(view.project(high - low)) }
    }

    /// Whether c lies left of it (λ = +1). On the line counts as left, for everyone who asks.
    #[must_use]
    pub fn has_reference_left(&self) -> bool {
        self.line.z >= 0.0
    }

    /// Directions of the ends from c, low first; `None` when nothing of it lies ahead of the receiver.
    ///
    /// An end behind the receiver's plane is replaced by where the edge crosses that plane, which is infinitely far: the
    /// direction of the line itself. No division, no epsilon.
    #[must_use]
    pub fn directions(&self) -> Option<[Vec2; 2]> {
        let [low, high] = self.ends;
        let along = Vec2::new(self.line.y, -self.line.x);
        match [low.z > 0.0, high.z > 0.0] {
            [true, true] => Some([low.truncate(), high.truncate()]),
            [true, false] => Some([low.truncate(), along]),
            [false, true] => Some([-along, high.truncate()]),
            [false, false] => None,
        }
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
