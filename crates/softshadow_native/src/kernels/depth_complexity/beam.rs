//! What a bundle of receivers sees of boxes and faces on the light, eight boxes or faces at a time.
//!
//! The kernel's own bounds are one receiver's (`sample_bins.wgsl`). Receivers of a bundle are neighbours and see nearly the same: so one
//! view with intervals for coefficients stands for all, and its bounds hold those of each. Bounds only choose what is looked at: masks are
//! the same whatever they let through.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::Vec3;

use super::edge::Vec2x8;
use super::frame::{FRAME_SPHERE, FrameView, LightFrame};
use super::sample_bins::Bins;
use crate::kernels::lanes::{LANES, Vec3x8};

/// What rounding can cost an image, as a share of the products before they cancel; with room to spare.
const SLACK: f32 = 4e-6;

/// One row of the receivers' projections: `(row ± row_reach)·(v − origin) + (offset ± reach)`.
struct Row {
    row: Vec3,
    row_reach: Vec3,
    offset: f32,
    reach: f32,
}

/// What lies on one side of the light: `(x − end·z)` of the images.
struct Side {
    row: Vec3,
    end: f32,
}

/// The views of eight receivers as one.
pub(super) struct Beam {
    /// About which images are expanded: receivers differ least in what they see there, beside the light.
    origin: Vec3,
    rows: [Row; 3],
    /// Borders of the light along x and y, low and high.
    sides: [[Side; 2]; 2],
    /// From bounds of images to where samples were before a sphere moved them,
    offset: [f32; 2],
    /// and how far they were moved at most.
    widest: f32,
}

/// Middle of numbers, and how far they reach from it.
fn interval(values: [f32; LANES]) -> (f32, f32) {
    let low = values.into_iter().fold(f32::INFINITY, f32::min);
    let high = values.into_iter().fold(f32::NEG_INFINITY, f32::max);
    ((low + high) * 0.5, (high - low) * 0.5)
}

impl Row {
    /// `size` is how far anything lies from where the coordinates begin.
    #[inline(always)]
    fn new<S: Simd>(rows: Vec3x8<S>, to_origin: Vec3x8<S>, size: Vec3x8<S>) -> Self {
        let (x, y, z) = (interval(rows.x.to_array()), interval(rows.y.to_array()), interval(rows.z.to_array()));
        let (offset, reach) = interval(rows.dot(to_origin).to_array());
        let slack = (rows.abs().dot(size) * SLACK).to_array().into_iter().fold(0.0, f32::max);
        Self { row: Vec3::new(x.0, y.0, z.0), row_reach: Vec3::new(x.1, y.1, z.1), offset, reach: reach + slack }
    }

    /// Where points are, without the reach.
    #[inline(always)]
    fn at<S: Simd>(&self, v: &Vec3x8<S>) -> f32x8<S> {
        v.x * self.row.x + v.y * self.row.y + v.z * self.row.z + self.offset
    }

    /// How far receivers differ about points no farther from the origin than this.
    #[inline(always)]
    fn reach<S: Simd>(&self, far: &Vec3x8<S>) -> f32x8<S> {
        far.x * self.row_reach.x + far.y * self.row_reach.y + far.z * self.row_reach.z + self.reach
    }
}

/// A product with the absolute components of one vector.
#[inline(always)]
fn spread<S: Simd>(row: Vec3, half: &Vec3x8<S>) -> f32x8<S> {
    half.x * row.x.abs() + half.y * row.y.abs() + half.z * row.z.abs()
}

#[inline(always)]
fn least<S: Simd>([a, b, c, d]: [f32x8<S>; 4]) -> f32x8<S> {
    a.min(b).min(c.min(d))
}

#[inline(always)]
fn most<S: Simd>([a, b, c, d]: [f32x8<S>; 4]) -> f32x8<S> {
    a.max(b).max(c.max(d))
}

impl Beam {
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, frame: &LightFrame, view: &FrameView<S>, low: Vec3, high: Vec3) -> Self {
        let origin = frame.origin;
        let to_origin = Vec3x8::splat(simd, origin) - view.position;
        let size = view.position.abs() + Vec3x8::splat(simd, low.abs().max(high.abs()) + origin.abs());
        let rows = [view.x_row, view.y_row, view.z_row].map(|row| Row::new(row, to_origin, size));
        let side = |axis: usize, end: f32| Side { row: rows[axis].row - rows[2].row * end, end };
        let sides = [[side(0, frame.low.x), side(0, frame.high.x)], [side(1, frame.low.y), side(1, frame.high.y)]];
        let is_sphere = frame.kind == FRAME_SPHERE;
        let stretch = view.tangent / (view.cap.max(f32x8::splat(simd, 1e-37)) * 2.0).sqrt();
        let moves = view.cap.simd_gt(0.0) & mask32x8::splat(simd, is_sphere);
        let widest = moves.select(stretch, f32x8::splat(simd, 1.0)).to_array().into_iter().fold(1.0, f32::max);
        Self { origin, rows, sides, offset: if is_sphere { frame.reference.to_array() } else { [0.0; 2] }, widest }
    }

    /// The samples that can lie behind boxes.
    #[inline(always)]
    pub(super) fn behind_boxes<S: Simd>(&self, simd: S, bins: &Bins, [low, high]: [Vec3x8<S>; 2]) -> [u64; LANES] {
        let half = (high - low).scale(f32x8::splat(simd, 0.5));
        let middle = low + half - Vec3x8::splat(simd, self.origin);
        let far = middle.abs() + half;
        let z = self.rows[2].at(&middle);
        let z_reach = self.rows[2].reach(&far);
        let depth = spread(self.rows[2].row, &half) + z_reach;
        let nearest = z - depth;
        let mut beyond = (z + depth).simd_le(0.0);
        let share = 1.0 / z.max(f32x8::splat(simd, 1e-37));
        let near_share = 1.0 / nearest.max(f32x8::splat(simd, 1e-37));
        let mut bounds = [[f32x8::splat(simd, 0.0); 2]; 2];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            let row = &self.rows[axis];
            let at = row.at(&middle);
            let reach = row.reach(&far);
            let [under, over] = &self.sides[axis];
            beyond |= (z * under.end - at).simd_gt(spread(under.row, &half) + reach + z_reach * under.end.abs())
                | (at - z * over.end).simd_gt(spread(over.row, &half) + reach + z_reach * over.end.abs());
            // Distances from the image of the middle: (x − q·z) / z, where the numerator is 0 in the middle.
            let q = at * share;
            let z_row = self.rows[2].row;
            let across = half.x * (row.row.x - q * z_row.x).abs()
                + half.y * (row.row.y - q * z_row.y).abs()
                + half.z * (row.row.z - q * z_row.z).abs();
            let reach = (across + reach + q.abs() * z_reach) * near_share;
            *bounds = [q - reach, q + reach];
        }
        self.within(simd, bins, bounds, nearest, beyond)
    }

    /// The samples that can lie behind faces of four corners.
    #[inline(always)]
    pub(super) fn behind_faces<S: Simd>(&self, simd: S, bins: &Bins, corners: &[Vec3x8<S>; 4]) -> [u64; LANES] {
        let origin = Vec3x8::splat(simd, self.origin);
        let [a, b, c, d] = [corners[0] - origin, corners[1] - origin, corners[2] - origin, corners[3] - origin];
        let far = a.abs().max(b.abs()).max(c.abs().max(d.abs()));
        let depth = &self.rows[2];
        let z = [depth.at(&a), depth.at(&b), depth.at(&c), depth.at(&d)];
        let z_reach = depth.reach(&far);
        let nearest = least(z) - z_reach;
        let mut beyond = (most(z) + z_reach).simd_le(0.0);
        let tiny = f32x8::splat(simd, 1e-37);
        let share = [1.0 / z[0].max(tiny), 1.0 / z[1].max(tiny), 1.0 / z[2].max(tiny), 1.0 / z[3].max(tiny)];
        let near_share = 1.0 / nearest.max(tiny);
        let mut bounds = [[f32x8::splat(simd, 0.0); 2]; 2];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            let row = &self.rows[axis];
            let at = [row.at(&a), row.at(&b), row.at(&c), row.at(&d)];
            let reach = row.reach(&far);
            let [from, to] = [self.sides[axis][0].end, self.sides[axis][1].end];
            let under = least([z[0] * from - at[0], z[1] * from - at[1], z[2] * from - at[2], z[3] * from - at[3]]);
            let over = least([at[0] - z[0] * to, at[1] - z[1] * to, at[2] - z[2] * to, at[3] - z[3] * to]);
            beyond |= under.simd_gt(reach + z_reach * from.abs()) | over.simd_gt(reach + z_reach * to.abs());
            let q = [at[0] * share[0], at[1] * share[1], at[2] * share[2], at[3] * share[3]];
            let (low, high) = (least(q), most(q));
            let pad = (reach + low.abs().max(high.abs()) * z_reach) * near_share;
            *bounds = [low - pad, high + pad];
        }
        self.within(simd, bins, bounds, nearest, beyond)
    }

    /// The samples within bounds; all where something reaches behind a receiver, none where all of it lies beyond the light.
    #[inline(always)]
    fn within<S: Simd>(
        &self,
        simd: S,
        bins: &Bins,
        bounds: [Vec2x8<S>; 2],
        nearest: f32x8<S>,
        beyond: mask32x8<S>,
    ) -> [u64; LANES] {
        if beyond.all_true() {
            return [0; LANES];
        }
        let is_ahead = nearest.simd_gt(0.0);
        // Far beyond every sample, and far from where products of them would have no value.
        let lowest = f32x8::splat(simd, -1e18);
        let highest = f32x8::splat(simd, 1e18);
        let mut ends = [[lowest; 2]; 2];
        for axis in 0..2 {
            let [low, high] = bounds[axis];
            let low = is_ahead.select(low.max(lowest), lowest) + self.offset[axis];
            let high = is_ahead.select(high.min(highest), highest) + self.offset[axis];
            ends[0][axis] = low.min(low * self.widest);
            ends[1][axis] = high.max(high * self.widest);
        }
        let within = bins.between(simd, ends[0], ends[1]);
        let beyond = beyond.to_bitmask();
        std::array::from_fn(|k| if beyond >> k & 1 == 0 { within[k] } else { 0 })
    }
}
