//! The twin of `shared/continuity.wgsl`: which pixels see one surface, for eight pixels at a time.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;

use super::receiver::{RECEIVER_SURFACE, Receiver};
use crate::kernels::lanes::{LANES, Vec3x8};

/// A block of an image whose pixels are averaged with their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Interleaving {
    eye: Vec3,
    tile: u32,
    width: u32,
    height: u32,
    pub(crate) channels: u32,
    reserved: u32,
}

const LEAST_COSINE: f32 = 0.99;
const MOST_STEP: f32 = 0.5;

#[derive(Clone, Copy)]
struct Receivers<S: Simd> {
    position: Vec3x8<S>,
    normal: Vec3x8<S>,
    is_surface: mask32x8<S>,
}

impl<S: Simd> Receivers<S> {
    #[inline(always)]
    fn new(simd: S, receivers: &[Receiver], at: [usize; LANES]) -> Self {
        Self {
            position: Vec3x8::from_fn(simd, |k| receivers[at[k]].position),
            normal: Vec3x8::from_fn(simd, |k| receivers[at[k]].normal),
            is_surface: u32x8::from_fn(simd, |k| receivers[at[k]].kind).simd_eq(RECEIVER_SURFACE),
        }
    }
}

#[inline(always)]
fn length<S: Simd>(v: Vec3x8<S>) -> f32x8<S> {
    v.dot(v).sqrt()
}

/// Whether both lie on one surface, as seen by `a`: where the ray to `b` meets the plane of `a`, and how far `b` is from there,
/// both times what would divide them.
#[inline(always)]
fn is_continuous<S: Simd>(a: &Receivers<S>, b: &Receivers<S>, eye: Vec3x8<S>) -> mask32x8<S> {
    let to_a = a.position - eye;
    let to_b = b.position - eye;
    let way = b.position - a.position;
    let height = a.normal.dot(to_a);
    let rise = a.normal.dot(way);
    let off = length(to_b) * rise.abs();
    let across = length(way.scale(height) - to_a.scale(rise));
    let is_ahead = (height * (height + rise)).simd_gt(0.0);
    let is_near = off.simd_le(MOST_STEP * across) & a.normal.dot(b.normal).simd_ge(LEAST_COSINE);
    a.is_surface & b.is_surface & is_ahead & is_near
}

/// The weight of a neighbour so many pixels aside, along one axis.
fn share_of_box(offset: i32, tile: u32) -> f32 {
    if 2 * offset.unsigned_abs() == tile { 0.5 } else { 1.0 }
}

/// A neighbour of each of eight pixels, all to the same side.
pub(crate) struct Neighbours<S: Simd> {
    /// The pixels themselves where that is outside the image.
    pub(crate) at: [usize; LANES],
    /// Whether there is one in the image.
    pub(crate) exist: mask32x8<S>,
    /// Whether both see one surface, as far as geometry says.
    pub(crate) continuous: mask32x8<S>,
    /// Whether each is the pixel itself.
    pub(crate) own: bool,
    /// Share of the box.
    pub(crate) share: f32,
}

impl Interleaving {
    /// Visits the pixels around eight pixels, in the order of rows.
    #[inline(always)]
    pub(crate) fn around<S: Simd>(
        &self,
        simd: S,
        receivers: &[Receiver],
        pixels: [usize; LANES],
        mut visit: impl FnMut(&Neighbours<S>),
    ) {
        let (width, height) = (self.width as i32, self.height as i32);
        let here = pixels.map(|pixel| [pixel as i32 % width, pixel as i32 / width]);
        let own = Receivers::new(simd, receivers, pixels);
        let eye = Vec3x8::splat(simd, self.eye);
        let reach = (self.tile / 2) as i32;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let there = here.map(|[here_x, here_y]| {
                    let (x, y) = (here_x + x, here_y + y);
                    (x >= 0 && x < width && y >= 0 && y < height).then_some((y * width + x) as usize)
                });
                let at = std::array::from_fn(|k| there[k].unwrap_or(pixels[k]));
                visit(&Neighbours {
                    at,
                    exist: u32x8::from_fn(simd, |k| u32::from(there[k].is_some())).simd_eq(1),
                    continuous: is_continuous(&own, &Receivers::new(simd, receivers, at), eye),
                    own: x == 0 && y == 0,
                    share: share_of_box(x, self.tile) * share_of_box(y, self.tile),
                });
            }
        }
    }
}
