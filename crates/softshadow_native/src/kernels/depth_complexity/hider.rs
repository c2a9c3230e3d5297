//! Which samples a face hides from eight receivers: those inside its border, by the reference point and the edges that are crossed on the
//! way from it.

use fearless_simd::{Simd, i32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;

use super::cover::{Loop, cover};
use super::cover_faces::{GROUP, Seen};
use super::coverage::Crossing;
use super::edge::{Vec2x8, before_limit, edge_image, image_matters};
use super::frame::{FrameView, LightFrame};
use super::occluders::{Face, NO_SIDE, OccluderEdge, side_of_plane};

/// Eight receivers and their samples.
pub(super) struct Hider<'a, S: Simd> {
    pub(super) frame: &'a LightFrame,
    pub(super) view: FrameView<S>,
    /// That the receivers lie on.
    pub(super) triangles: u32x8<S>,
    pub(super) samples: &'a [Vec2x8<S>; GROUP],
}

impl<S: Simd> Hider<'_, S> {
    /// Takes away the samples, of those that are near it, that a face hides.
    #[inline(always)]
    pub(super) fn hide(&self, simd: S, face: &Face, corners: &[Vec3; 4], near: u64, seen: &mut Seen) {
        let view = &self.view;
        // One seen edge-on hides nothing, nor does the receivers' own.
        let side = side_of_plane(simd, face.normal, face.point, face.flatness, view.position);
        let is_own = self.triangles.simd_eq(u32x8::splat(simd, face.triangle));
        let hides = !(side.simd_eq(i32x8::splat(simd, 0)) | is_own);
        if !hides.any_true() {
            return;
        }
        let near = near & seen.any;
        let mut border = Loop::empty(simd);
        let mut crossed = [mask32x8::splat(simd, false); GROUP];
        for (k, side) in face.sides.into_iter().enumerate().filter(|(_, side)| *side != NO_SIDE) {
            let is_forward = side & 1 == 0;
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            let (low, high) = if is_forward { (a, b) } else { (b, a) };
            let edge = OccluderEdge { low, high, first_incidence: 0, incidence_count: 0 };
            let image = edge_image(simd, view, &edge);
            border.add(simd, &image, is_forward);
            let image = before_limit(simd, view, &edge, image);
            let matters = image_matters(simd, self.frame, &image);
            if matters.any_true() {
                let crossing = Crossing::of(simd, &image);
                let mut waiting = near;
                while waiting != 0 {
                    let i = waiting.trailing_zeros() as usize;
                    waiting &= waiting - 1;
                    crossed[i] ^= crossing.crosses(simd, self.samples[i]) & matters;
                }
            }
        }
        let one = i32x8::splat(simd, 1);
        let covers = (cover(simd, view, face, &border) & one).simd_eq(one);
        let mut waiting = near;
        while waiting != 0 {
            let i = waiting.trailing_zeros() as usize;
            waiting &= waiting - 1;
            seen.take_away(i, ((crossed[i] ^ covers) & hides).to_bitmask());
        }
    }
}
