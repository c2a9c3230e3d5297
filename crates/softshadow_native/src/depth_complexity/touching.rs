//! Triangles that dip into a ball of light, one by one.
//!
//! What hides a sample of a ball must lie before the ball's surface. Where a triangle passes through the surface its shadow ends in a
//! curve that is no edge. So these triangles are left out of the edges and tried against every sample, as rays would.

use glam::{Vec2, Vec3};
use softshadow_scene::occluders::{OPAQUE, Occluders};

use super::counters::Counters;
use super::coverage::Mask;
use super::view::{Cap, LightView, Receiver};

/// Adds the touching triangles to the samples that they hide: opaque ones to `hidden`, others to `attenuation`.
pub fn add_touching<const W: usize>(
    view: &LightView,
    occluders: &Occluders,
    receiver: &Receiver,
    reference: [f32; 2],
    samples: &[[f32; 2]],
    hidden: &mut Mask<W>,
    attenuation: &mut Counters<W>,
) {
    let Some(cap) = view.cap else { return };
    for triangle in occluders.touching.iter().filter(|t| Some(t.triangle) != receiver.triangle) {
        let shadow = Shadow::new(view.position, triangle.corners.map(Vec3::from));
        let mut mask = [0; W];
        for (word, chunk) in mask.iter_mut().zip(samples.chunks(64)) {
            for (bit, sample) in chunk.iter().enumerate() {
                *word |= u64::from(shadow.holds(view.way_to(*sample) * to_surface(cap, reference, *sample))) << bit;
            }
        }
        if triangle.attenuation == OPAQUE {
            hidden.iter_mut().zip(mask).for_each(|(all, one)| *all |= one);
        } else {
            attenuation.add(&mask, triangle.attenuation as i32);
        }
    }
}

/// How far along the way to a point of the disc, which is 1 long along the axis, the ball's surface is met.
fn to_surface(cap: Cap, reference: [f32; 2], [x, y]: [f32; 2]) -> f32 {
    let from_axis = Vec2::new(x + reference[0], y + reference[1]);
    // 1 − |way|²·(1 − sine²), without the cancellation.
    let depth_squared = cap.sine_squared * (1.0 - from_axis.length_squared()).max(0.0);
    cap.distance * (1.0 - cap.sine_squared) / (1.0 + depth_squared.sqrt())
}

/// No sample gets more attenuation than that from them.
#[must_use]
pub fn most_touching(occluders: &Occluders) -> i64 {
    let units = occluders.touching.iter().map(|t| t.attenuation).filter(|units| *units != OPAQUE);
    units.map(i64::from).sum()
}

/// What lies behind a triangle as seen from a receiver. Every determinant has an edge of the triangle for a factor, so that rounding is
/// in proportion to the triangle.
struct Shadow {
    sides: [Vec3; 3],
    normal: Vec3,
    height: f32,
}

impl Shadow {
    fn new(position: Vec3, [v0, v1, v2]: [Vec3; 3]) -> Self {
        let (a, b) = (v0 - position, v1 - position);
        let normal = (v1 - v0).cross(v2 - v0);
        Self { sides: [a.cross(v1 - v0), b.cross(v2 - v1), (v2 - v0).cross(a)], normal, height: a.dot(normal) }
    }

    fn holds(&self, way: Vec3) -> bool {
        let sides = self.sides.map(|side| side.dot(way));
        let slope = self.normal.dot(way);
        let inside = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
        inside && self.height * slope > 0.0 && self.height.abs() < slope.abs()
    }
}
