//! Twins of the kernels that place receivers.

mod place;
mod place_points;
mod trace_camera;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("place_points", "place") => place_points::place,
        ("trace_camera", "trace_camera") => trace_camera::trace_camera,
        _ => return None,
    })
}
