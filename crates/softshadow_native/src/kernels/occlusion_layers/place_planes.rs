//! The twin of `occlusion_layers/place_planes.wgsl`.

use glam::{Vec2, Vec3};

use super::casters::{CasterRange, bound, number_of};
use super::layers::{LayerFrame, LayerPlaces};
use crate::engine::Call;
use crate::kernels::records_mut;

pub(super) fn place_planes(call: &mut Call) {
    let has_items = !call.items.is_empty();
    let (frame, range): (LayerFrame, CasterRange) = (call.uniform("layer_frame"), call.uniform("caster_range"));
    let [bounds, places] = call.buffers(["caster_bounds", "layer_places"]);
    let [places, ..] = records_mut::<LayerPlaces>(places) else { return };
    let has_casters = has_items && bounds[bound::COUNT] > 0;
    let window = &mut places.window;
    window.slices = if has_casters { frame.slices } else { 0 };
    window.resolution = frame.resolution;
    window.inverse_distance = range.inverse_distance;
    window.reserved = 0;
    if !has_casters {
        return;
    }
    let low = Vec3::from_array([0, 1, 2].map(|axis| number_of(!bounds[bound::LOW + axis])));
    let high = Vec3::from_array([0, 1, 2].map(|axis| number_of(bounds[bound::HIGH + axis])));
    let [low_across, high_across] = [low, high].map(|v| v.truncate());
    let extent = high_across - low_across;
    let fitted = if range.is_square == 0 { extent } else { Vec2::splat(extent.max_element()) };
    let size = fitted.max(Vec2::splat(1e-6));
    window.low = (low_across + high_across - size) * 0.5;
    window.texels = frame.resolution as f32 / size;
    // Even in depth before the projection. The last plane a hair behind the farthest caster, which must not fall out by rounding.
    let inverse = range.inverse_distance;
    let [near, far] = [low.z, high.z].map(|z| z / (1.0 - z * inverse));
    for (k, plane) in places.planes.iter_mut().take(frame.slices as usize).enumerate() {
        let z = near + (far - near) * ((k + 1) as f32 / frame.slices as f32);
        *plane = z / (1.0 + z * inverse);
    }
    places.planes[frame.slices as usize - 1] = high.z + 1e-6 * (high.z.abs() + low.z.abs());
}
