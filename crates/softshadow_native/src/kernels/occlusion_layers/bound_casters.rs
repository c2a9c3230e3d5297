//! The twin of `occlusion_layers/bound_casters.wgsl`.

use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;
use rayon::prelude::*;

use super::casters::{CasterRange, bound, can_hide, key_of};
use super::layers::LayerFrame;
use super::outline::outline_of;
use crate::engine::{Call, atomic_words};
use crate::kernels::shared::triangle::Corner;
use crate::kernels::{RUN, records};

/// Seen at less than this share of its area, a triangle is seen from the side.
const EDGE_ON: f32 = 0.08;

/// What bounds are made of; areas are whole numbers, so that no order matters.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
    count: u32,
    edge_on: u32,
    area: u32,
}

pub(super) fn bound_casters(call: &mut Call) {
    let items = call.item_range();
    let (frame, range): (LayerFrame, CasterRange) = (call.uniform("layer_frame"), call.uniform("caster_range"));
    let [corners, bounds] = call.buffers(["corners", "caster_bounds"]);
    let triangles = &records::<[Corner; 3]>(corners)[items];
    let words = atomic_words(bounds);
    triangles.par_chunks(RUN).for_each(|triangles| {
        let none = Bounds { low: Vec3::splat(f32::MAX), high: Vec3::splat(f32::MIN), count: 0, edge_on: 0, area: 0 };
        let found = triangles.iter().fold(none, |found, triangle| joined(&frame, &range, triangle, found));
        if found.count == 0 {
            return;
        }
        for axis in 0..3 {
            words[bound::LOW + axis].fetch_max(!key_of(found.low[axis]), Relaxed);
            words[bound::HIGH + axis].fetch_max(key_of(found.high[axis]), Relaxed);
        }
        for (at, value) in [(bound::COUNT, found.count), (bound::EDGE_ON, found.edge_on), (bound::AREA, found.area)] {
            words[at].fetch_add(value, Relaxed);
        }
    });
}

fn joined(frame: &LayerFrame, range: &CasterRange, triangle: &[Corner; 3], bounds: Bounds) -> Bounds {
    let corners = triangle.map(|corner| corner.position);
    let [p0, p1, p2] = corners;
    let normal = (p1 - p0).cross(p2 - p0);
    let outline = outline_of(frame, range.inverse_distance, corners);
    if !outline.exists || outline.low.z >= range.farthest || !can_hide(range, p0, normal) {
        return bounds;
    }
    let low = outline.low.max(range.hull_low.extend(-1e30));
    let high = outline.high.min(range.hull_high.extend(range.farthest));
    if low.x > high.x || low.y > high.y {
        return bounds;
    }
    let middle = (p0 + p1 + p2) / 3.0;
    let eye_way = (middle - frame.origin) * range.inverse_distance + frame.row_z;
    let cosine = normal.dot(eye_way).abs() / (normal.length() * eye_way.length()).max(1e-30);
    let unit = 0.25 * 4_194_304.0 / range.box_half.dot(range.box_half).max(1e-30);
    let area = (0.5 * normal.length() * unit).min(4_194_304.0) as u32;
    Bounds {
        low: bounds.low.min(low),
        high: bounds.high.max(high),
        count: bounds.count + 1,
        edge_on: bounds.edge_on.wrapping_add(if cosine < EDGE_ON { area } else { 0 }),
        area: bounds.area.wrapping_add(area),
    }
}
