//! `D(c, p)`: what covers the reference point.

use glam::DVec2;
use softshadow_scene::occluders::{Face, NO_SIDE, Occluders};

use super::edge::ProjectedEdge;
use super::face::{Layers, side};
use super::reach::faces_on_the_way;
use super::view::{LightView, Receiver};

/// Two directions with a smaller sine between them are one, or opposite: a few roundings of the images that they come from.
const NO_TURN: f64 = 1e-6;

/// The layers between the receiver and c.
#[must_use]
pub fn depth_of_reference(view: &LightView, occluders: &Occluders, receiver: &Receiver) -> Layers {
    let mut depth = Layers::NONE;
    faces_on_the_way(view, occluders, |face| {
        if Some(face.triangle) != receiver.triangle {
            depth = depth.plus(Layers::of(face, cover(view, occluders, face)));
        }
    });
    depth
}

/// How often a face covers c, by the very signs with which its edges count: the face's side times how often its image turns around c.
///
/// The image is a loop of the images of its edges. A convex loop turns around c iff c lies on one side of all of them. The side of the
/// face is the same, unless rounding lets the two differ (seen edge-on, c within rounding of it): then its edges count the face as −1,
/// and so does c.
#[must_use]
pub fn cover(view: &LightView, occluders: &Occluders, face: &Face) -> i32 {
    let mut image = Loop::default();
    for &reference in face.sides.iter().filter(|reference| **reference != NO_SIDE) {
        image.add(&ProjectedEdge::new(view, &occluders.edges[(reference >> 1) as usize]), reference & 1 == 0);
    }
    let side = side(view, face);
    if is_before_limit(view, face) { side * image.turns_around_reference(side) } else { 0 }
}

/// The image of a face's border, as c sees it.
#[derive(Default)]
struct Loop {
    /// Whether c lies left of any edge, and right of any.
    has_left: bool,
    has_right: bool,
    /// Whether any edge spans more than a right angle, as one must if they are to turn all around c.
    has_wide: bool,
    /// Where some corners lie behind the receiver the loop runs out to infinity, and comes back from there.
    out: Option<DVec2>,
    back: Option<DVec2>,
}

impl Loop {
    /// Adds an edge in the order of the winding; one that lies wholly behind has no image.
    fn add(&mut self, edge: &ProjectedEdge, is_forward: bool) {
        let Some([low, high]) = edge.directions() else { return };
        let is_left = edge.has_reference_left == is_forward;
        self.has_left |= is_left;
        self.has_right |= !is_left;
        self.has_wide |= low.dot(high) < 0.0;
        let low_is_ahead = edge.ends[0].z > 0.0;
        if low_is_ahead != (edge.ends[1].z > 0.0) {
            let infinite = if low_is_ahead { high } else { low };
            *(if low_is_ahead == is_forward { &mut self.out } else { &mut self.back }) = Some(infinite);
        }
    }

    /// +1 counter-clockwise, −1 clockwise, 0 not at all. `side` is the face's.
    fn turns_around_reference(&self, side: i32) -> i32 {
        let all =
            |turn: i32| if turn > 0 { self.has_left && !self.has_right } else { self.has_right && !self.has_left };
        let if_all = |turn: i32| if all(turn) { turn } else { 0 };
        let either = if all(1) { 1 } else { if_all(-1) };
        let (Some(out), Some(back)) = (self.out, self.back) else { return either };
        // The arc at infinity that closes the loop is one more edge.
        let cross = out.perp_dot(back);
        let arc = if cross >= 0.0 { 1 } else { -1 };
        if cross.abs() > NO_TURN * out.length() * back.length() {
            if_all(arc)
        } else if out.dot(back) > 0.0 {
            // It has no length.
            if self.has_wide { either } else { 0 }
        } else if arc == side {
            // It is a half turn, and could be one the other way: the face's side says which of the two half planes is hidden.
            if_all(arc)
        } else if all(-side) {
            0
        } else {
            side
        }
    }
}

/// Whether the face meets the way to c before a sphere's disc. A face that does not touch the ball passes the disc's plane far from
/// this way or not at all.
fn is_before_limit(view: &LightView, face: &Face) -> bool {
    let Some((towards, limit)) = view.limit else { return true };
    let normal = glam::Vec3::from(face.normal);
    let height = normal.dot(glam::Vec3::from(face.point) - view.position);
    let slope = normal.dot(view.ways[2]);
    // height / slope · (towards·way) < limit, without dividing.
    let along = towards.dot(view.ways[2]);
    height * slope.signum() * along < limit * slope.abs()
}
