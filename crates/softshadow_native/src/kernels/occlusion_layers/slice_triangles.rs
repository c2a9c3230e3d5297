//! The twin of `occlusion_layers/slice_triangles.wgsl`.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::casters::{CasterRange, can_hide};
use super::layers::{LayerFrame, LayerPlaces, in_light_frame};
use super::outline::{Outline, outline_of};
use crate::engine::{Call, atomic_words};
use crate::kernels::shared::triangle::Corner;
use crate::kernels::{RUN, records};

const MOST_ROWS: u32 = 64;
const GROUP: u32 = 64;
const LARGEST_DISPATCH: u32 = 65_535;

/// Words of `TallTriangles` before its list.
const TALL_HEADER: usize = 4;

/// Rows of a triangle that a thread takes at once.
const ROWS: usize = 16;

/// A triangle over texels: its outline, and its depth, which is linear over them.
struct Sliced {
    outline: Outline,
    depth: f32,
    slope: Vec2,
    first_row: u32,
    end_row: u32,
    first_slice: u32,
    last_slice: u32,
}

struct Slicing<'a> {
    frame: LayerFrame,
    range: CasterRange,
    places: LayerPlaces,
    triangles: &'a [[Corner; 3]],
    bits: &'a [AtomicU32],
}

impl<'a> Slicing<'a> {
    fn new(call: &'a mut Call) -> (Self, &'a mut [u32]) {
        let (frame, range) = (call.uniform("layer_frame"), call.uniform("caster_range"));
        let [corners, places, bits, tall] = call.buffers(["corners", "layer_places", "slice_bits", "tall"]);
        let places = records::<LayerPlaces>(places)[0];
        (Self { frame, range, places, triangles: records(corners), bits: atomic_words(bits) }, tall)
    }

    fn sliced(&self, index: u32) -> Option<Sliced> {
        let corners = self.triangles[index as usize].map(|corner| corner.position);
        let [p0, p1, p2] = corners;
        let (window, slices) = (&self.places.window, self.places.window.slices);
        let mut outline = outline_of(&self.frame, self.range.inverse_distance, corners);
        let is_there = slices > 0 && outline.exists && outline.low.z < self.range.farthest;
        if !is_there || !can_hide(&self.range, p0, (p1 - p0).cross(p2 - p0)) {
            return None;
        }
        let scale = window.texels.extend(1.0);
        let begin = window.low.extend(0.0);
        for side in &mut outline.sides {
            side.a = (side.a - begin) * scale;
            side.b = (side.b - begin) * scale;
        }
        let row = |y: f32| ((y - begin.y) * scale.y - 0.5).ceil().clamp(0.0, window.resolution as f32) as u32;
        // The plane n·q = c becomes n.x u + n.y v + (n.z + c / d) t = c.
        let q0 = in_light_frame(&self.frame, p0);
        let n = (in_light_frame(&self.frame, p1) - q0).cross(in_light_frame(&self.frame, p2) - q0);
        let steep = n.z + n.dot(q0) * self.range.inverse_distance;
        // A corner before the light: every side that exists begins at one.
        let corner: Vec3 = outline.sides[usize::from(!outline.sides[0].exists)].a;
        let is_seen = steep.abs() > 1e-6 * n.length();
        let slope = if is_seen { -n.truncate() / (steep * scale.truncate()) } else { Vec2::ZERO };
        Some(Sliced {
            depth: corner.z - slope.dot(corner.truncate()),
            slope,
            first_row: row(outline.low.y),
            end_row: row(outline.high.y),
            first_slice: self.places.slices_before(outline.low.z),
            last_slice: self.places.slices_before(outline.high.z),
            outline,
        })
    }

    fn fill(&self, slice: u32, row: u32, first: u32, end: u32) {
        let window = &self.places.window;
        if first >= end || slice >= window.slices {
            return;
        }
        let words = window.resolution / 32;
        let base = (slice * window.resolution + row) * words;
        for word in first / 32..=(end - 1) / 32 {
            let from_bit = first.max(word * 32) - word * 32;
            let bits = end.min(word * 32 + 32) - word * 32 - from_bit;
            let mask = (u32::MAX >> (32 - bits)) << from_bit;
            self.bits[(base + word) as usize].fetch_or(mask, Relaxed);
        }
    }

    /// Sets the bits of one row, in every slice that the triangle passes there.
    fn fill_row(&self, triangle: &Sliced, row: u32) {
        let y = row as f32 + 0.5;
        let [left, right] = span(&triangle.outline, y);
        let column = |x: f32| (x - 0.5).ceil().clamp(0.0, self.places.window.resolution as f32) as u32;
        let (mut begin, end) = (column(left), column(right));
        let at_row = triangle.depth + triangle.slope.y * y;
        let slope = triangle.slope.x;
        let rises = slope >= 0.0;
        let count = triangle.last_slice - triangle.first_slice + 1;
        for k in 0..count {
            if begin >= end {
                return;
            }
            let index = if rises { triangle.first_slice + k } else { triangle.last_slice - k };
            let mut until = end;
            if k + 1 < count {
                let depth = self.places.planes[if rises { index } else { index - 1 } as usize];
                let flat = slope.abs() < 1e-20;
                let steep = if !flat {
                    slope
                } else if rises {
                    1e-20
                } else {
                    -1e-20
                };
                let crossing = (depth - at_row) / steep;
                until = (crossing - 0.5).ceil().clamp(begin as f32, end as f32) as u32;
            }
            self.fill(index, row, begin, until);
            if self.frame.successors != 0 {
                self.fill(index + 1, row, begin, until);
            }
            begin = until;
        }
    }
}

/// Where the row through the texels' centres at `y` enters and leaves. A side that ends there belongs to the row below.
fn span(outline: &Outline, y: f32) -> [f32; 2] {
    let mut ends = [1e30_f32, -1e30_f32];
    for side in outline.sides.iter().filter(|side| side.exists && (side.a.y <= y) != (side.b.y <= y)) {
        let x = side.a.x + (y - side.a.y) * ((side.b.x - side.a.x) / (side.b.y - side.a.y));
        ends = [ends[0].min(x), ends[1].max(x)];
    }
    ends
}

pub(super) fn slice_triangles(call: &mut Call) {
    let items = call.items.clone();
    let (slicing, tall) = Slicing::new(call);
    let (header, list) = atomic_words(tall).split_at(TALL_HEADER);
    items.into_par_iter().with_min_len(RUN).for_each(|index| {
        let Some(triangle) = slicing.sliced(index) else { return };
        let rows = triangle.end_row.saturating_sub(triangle.first_row);
        if rows > MOST_ROWS {
            list[header[0].fetch_add(1, Relaxed) as usize].store(index, Relaxed);
        } else {
            (0..rows).for_each(|k| slicing.fill_row(&triangle, triangle.first_row + k));
        }
    });
}

pub(super) fn size_rows(call: &mut Call) {
    let items = call.items.len() as u32;
    let [places, tall, dispatch_size] = call.buffers(["layer_places", "tall", "dispatch_size"]);
    let groups = tall[0] * records::<LayerPlaces>(places)[0].window.resolution.div_ceil(GROUP) * items;
    dispatch_size.copy_from_slice(&[groups.min(LARGEST_DISPATCH), groups.div_ceil(LARGEST_DISPATCH), 1]);
}

pub(super) fn slice_rows(call: &mut Call) {
    let (slicing, tall) = Slicing::new(call);
    let (header, list) = tall.split_at(TALL_HEADER);
    for triangle in list[..header[0] as usize].iter().filter_map(|index| slicing.sliced(*index)) {
        let rows = triangle.first_row..triangle.end_row;
        rows.into_par_iter().with_min_len(ROWS).for_each(|row| slicing.fill_row(&triangle, row));
    }
}
