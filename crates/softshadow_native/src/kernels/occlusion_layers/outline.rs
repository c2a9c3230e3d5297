//! The twin of `occlusion_layers/outline.wgsl`.

use glam::Vec3;

use super::layers::{LAYERS_SUN, LayerFrame, in_light_frame, projected};

/// A side from one end to the other: a corner comes first, and of two the one that comes first in the triangle.
#[derive(Clone, Copy, Default)]
pub(super) struct Side {
    pub(super) a: Vec3,
    pub(super) b: Vec3,
    pub(super) exists: bool,
}

#[derive(Clone, Copy)]
pub(super) struct Outline {
    /// Three of the triangle, and where the light's plane cuts it.
    pub(super) sides: [Side; 4],
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    pub(super) exists: bool,
}

/// What of a side lies before the light, and where it ends there.
fn front_of(a: Vec3, b: Vec3, unbounded: bool) -> Side {
    let [a_is_front, b_is_front] = [a, b].map(|end| unbounded || end.z >= 0.0);
    if a_is_front == b_is_front {
        return Side { a, b, exists: a_is_front };
    }
    let end = a + (b - a) * (a.z / (a.z - b.z));
    Side { a: if a_is_front { a } else { b }, b: end.with_z(0.0), exists: true }
}

pub(super) fn outline_of(frame: &LayerFrame, inverse_distance: f32, corners: [Vec3; 3]) -> Outline {
    let unbounded = frame.kind == LAYERS_SUN;
    let [q0, q1, q2] = corners.map(|p| in_light_frame(frame, p));
    let [s0, s1, s2] = [(q0, q1), (q0, q2), (q1, q2)].map(|(a, b)| front_of(a, b, unbounded));
    let [cut0, cut1, cut2] = [(q0, q1), (q0, q2), (q1, q2)].map(|(a, b)| (a.z < 0.0) != (b.z < 0.0));
    // Two sides are cut, or none.
    let (first, second) = (if cut0 { s0 } else { s1 }, if cut2 { s2 } else { s1 });
    let cut = Side { a: first.b, b: second.b, exists: !unbounded && (cut0 || cut1 || cut2) };
    let (low, high) = (Vec3::splat(1e30), Vec3::splat(-1e30));
    let mut outline = Outline { sides: [s0, s1, s2, cut], low, high, exists: false };
    for side in outline.sides.iter_mut().filter(|side| side.exists) {
        side.a = projected(side.a, inverse_distance);
        side.b = projected(side.b, inverse_distance);
        outline.low = outline.low.min(side.a.min(side.b));
        outline.high = outline.high.max(side.a.max(side.b));
        outline.exists = true;
    }
    outline
}
