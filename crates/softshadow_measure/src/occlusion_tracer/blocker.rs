//! The float64 test of one triangle: the determinants of [`crate::ray_reference`], from the same operands in the same
//! order, so that every sign is the same.

use super::beam::Pyramid;
use crate::Triangle;
use crate::vector::{Vec3, cross, dot, sub};

#[derive(Debug, Clone)]
pub(super) struct Blocker {
    corners: Triangle,
    /// e1×e2.
    normal: Vec3,
    /// Which of the caller's triangles it is.
    pub(super) index: usize,
}

impl Blocker {
    /// `None` for a triangle that blocks nothing, as its plane is no plane.
    pub(super) fn new(index: usize, corners: &Triangle) -> Option<Self> {
        let [v0, v1, v2] = *corners;
        let normal = cross(sub(v1, v0), sub(v2, v0));
        (normal != [0.0; 3]).then_some(Self { corners: *corners, normal, index })
    }

    pub(super) fn corners(&self) -> &Triangle {
        &self.corners
    }

    /// The linear functions of the direction that must have one sign: E01, E12 and −E02.
    fn edges(&self, origin: Vec3) -> [Vec3; 3] {
        let [v0, v1, v2] = self.corners;
        let (a, b) = (sub(v0, origin), sub(v1, origin));
        [cross(a, sub(v1, v0)), cross(b, sub(v2, v1)), cross(sub(v2, v0), a)]
    }

    fn volume(&self, origin: Vec3) -> f64 {
        dot(self.normal, sub(self.corners[0], origin))
    }

    /// Whether it blocks the ray.
    #[inline]
    pub(super) fn blocks(&self, origin: Vec3, direction: Vec3, at_infinity: bool) -> bool {
        let (volume, depth) = (self.volume(origin), dot(self.normal, direction));
        let front = volume > 0.0 && depth > 0.0 && (at_infinity || volume < depth);
        let back = volume < 0.0 && depth < 0.0 && (at_infinity || volume > depth);
        if !(front || back) {
            return false;
        }
        let edges = self.edges(origin).map(|edge| dot(edge, direction));
        if front { edges.iter().all(|e| *e >= 0.0) } else { edges.iter().all(|e| *e <= 0.0) }
    }

    /// False only when [`Self::blocks`] is false for every ray of the pyramid.
    pub(super) fn may_block(&self, origin: Vec3, pyramid: &Pyramid) -> bool {
        let volume = self.volume(origin);
        let [least, greatest] = pyramid.range(self.normal);
        let front = volume > 0.0 && greatest > 0.0 && (pyramid.holds_directions() || volume < greatest);
        let back = volume < 0.0 && least < 0.0 && (pyramid.holds_directions() || volume > least);
        if !(front || back) {
            return false;
        }
        self.edges(origin).iter().all(|edge| {
            let [least, greatest] = pyramid.range(*edge);
            if front { greatest >= 0.0 } else { least <= 0.0 }
        })
    }
}
