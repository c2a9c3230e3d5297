//! `D(c, p)`: what covers the reference point.

use softshadow_scene::occluders::{Face, NO_SIDE, Occluders};

use super::edge::ProjectedEdge;
use super::face::{Layers, side};
use super::reach::faces_on_the_way;
use super::view::{LightView, Receiver};

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

/// How often a face covers c, by the very signs with which its edges count.
///
/// c is covered iff it lies on one side of all edges, and the face is ahead. Ahead of the receiver means that this side is the
/// face's own; else the face is met in the opposite direction. For a face that is wholly ahead there is no opposite direction: where
/// rounding lets the two signs disagree (seen edge-on, c within rounding of it) the edges count it as −1, and so does c.
#[must_use]
pub fn cover(view: &LightView, occluders: &Occluders, face: &Face) -> i32 {
    let side = side(view, face);
    let mut around = 0;
    let mut ahead = true;
    for &reference in face.sides.iter().filter(|reference| **reference != NO_SIDE) {
        let edge = ProjectedEdge::new(view, &occluders.edges[(reference >> 1) as usize]);
        let left = if edge.has_reference_left() == (reference & 1 == 0) { 1 } else { -1 };
        if around == -left {
            return 0;
        }
        around = left;
        ahead &= edge.ends[0].z > 0.0 && edge.ends[1].z > 0.0;
    }
    if (ahead || around == side) && is_before_limit(view, face) { around * side } else { 0 }
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
