//! The twin of `depth_complexity/sides.wgsl`: the side of a face by which an edge is weighed.

use fearless_simd::{Simd, i32x8, prelude::*};
use glam::Vec3;

use super::frame::{FRAME_FLAT, FRAME_SUN, FrameView, LightFrame};
use super::occluders::{IncidentFace, side_of_plane};

/// The side that the light's reference point is on, as seen from beyond the face.
fn side_from_reference(frame: &LightFrame, face: &IncidentFace) -> i32 {
    let c = frame.reference;
    let height = match frame.kind {
        FRAME_SUN => face.normal.dot(frame.z_row + (frame.x_row * c.x + frame.y_row * c.y) * frame.size),
        kind => {
            let offset = if kind == FRAME_FLAT { frame.x_way * c.x + frame.y_way * c.y } else { Vec3::ZERO };
            face.normal.dot(frame.origin + offset - face.point)
        }
    };
    i32::from(height < -face.flatness) - i32::from(height > face.flatness)
}

/// As eight receivers see it, turned the way that the face goes at its edge. Standard silhouettes are those of the light's reference point, and
/// so are their sides.
#[inline(always)]
pub(super) fn weighing_side<S: Simd>(
    simd: S,
    frame: &LightFrame,
    view: &FrameView<S>,
    face: &IncidentFace,
) -> i32x8<S> {
    let side = if frame.weighs_from_light == 0 {
        side_of_plane(simd, face.normal, face.point, face.flatness, view.position)
    } else {
        i32x8::splat(simd, side_from_reference(frame, face))
    };
    if face.reference & 1 != 0 { -side } else { side }
}
