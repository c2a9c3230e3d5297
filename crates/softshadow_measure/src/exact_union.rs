//! The exact visibility of a rectangular light past a small mesh.
//!
//! Every triangle is clipped to the light's frustum in homogeneous coordinates relative to the receiver, so that nothing is
//! divided before it is known to lie ahead and no epsilon is needed; then it is projected on to the light, and the area of
//! the union of all projections is what the mesh hides.
//!
//! Error: about 1e-12 of the light's area; a triangle that passes the receiver at a distance g adds up to about
//! 2^-52 · |corner − receiver| / g, the rounding of its corners as the receiver sees it. Cost: see
//! [`rectangle_visibility`].

use crate::error::require_finite;
use crate::polygon::{area_of_union, clip};
use crate::receiver::check_triangles;
use crate::vector::{Vec3, add, cross, dot, length, scale, sub};
use crate::{MeasureError, Receiver, Target, Triangle};

/// How far from square the half axes may be, as a cosine.
const ORTHOGONALITY: f64 = 1e-6;

/// A one-sided rectangular light, `center ± half_u ± half_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectangleLight {
    center: Vec3,
    half_u: Vec3,
    half_v: Vec3,
    normal: Vec3,
}

impl RectangleLight {
    /// A light that emits to the side of `front`, which needs not be a unit vector nor exactly normal to the rectangle.
    ///
    /// # Errors
    /// `NotFinite`, or `Degenerate` when an axis is zero, the axes are not orthogonal (to float32 accuracy) or `front` lies
    /// within the light's plane.
    pub fn new(center: [f64; 3], half_u: [f64; 3], half_v: [f64; 3], front: [f64; 3]) -> Result<Self, MeasureError> {
        for vector in [center, half_u, half_v, front] {
            require_finite("light", 0, &vector)?;
        }
        let area = length(half_u) * length(half_v);
        if area == 0.0 || dot(half_u, half_v).abs() > ORTHOGONALITY * area {
            return Err(MeasureError::Degenerate { why: "the light needs two orthogonal half axes that are not zero" });
        }
        let across = cross(half_u, half_v);
        let facing = dot(across, front);
        if facing.abs() <= ORTHOGONALITY * length(across) * length(front) {
            return Err(MeasureError::Degenerate { why: "the light's front direction lies within its plane" });
        }
        let normal = scale(across, facing.signum() / length(across));
        Ok(Self { center, half_u, half_v, normal })
    }

    /// Whether `point` is strictly on the side to which the light emits.
    #[must_use]
    pub fn faces(&self, point: [f64; 3]) -> bool {
        self.height_of(point) > 0.0
    }

    /// The light's point at `uv` in [0, 1]², uniform in area.
    #[must_use]
    pub fn target(&self, uv: [f64; 2]) -> Target {
        let [u, v] = uv.map(|t| 2.0 * t - 1.0);
        Target::Point(add(self.center, add(scale(self.half_u, u), scale(self.half_v, v))))
    }

    fn height_of(&self, point: Vec3) -> f64 {
        dot(self.normal, sub(point, self.center))
    }
}

/// A point in the receiver's homogeneous view of the light: the light is |u| <= w, |v| <= w.
type Homogeneous = [f64; 4];
const U: usize = 0;
const V: usize = 1;
/// Distance ahead of the receiver, towards the light's plane: the homogeneous weight.
const W: usize = 2;
/// Height above the light's plane, towards the receiver.
const ABOVE_LIGHT: usize = 3;

/// The fraction of `light` that `receiver` sees past `triangles`: 0 behind the light; what lies below the receiver's
/// horizon counts as hidden.
///
/// Triangles within the light's plane hide nothing (they are not strictly between). A receiver exactly on a triangle that it
/// does not exclude takes one of the two one-sided limits. Time grows with the number of projected crossings times the
/// number of triangles stacked over them: some thousand triangles are comfortable, not some million.
///
/// # Errors
/// `NotFinite`.
pub fn rectangle_visibility(
    light: &RectangleLight,
    triangles: &[Triangle],
    receiver: &Receiver,
) -> Result<f64, MeasureError> {
    receiver.check(0)?;
    check_triangles(triangles)?;
    if !light.faces(receiver.origin) {
        return Ok(0.0);
    }
    let mut hidden: Vec<Vec<[f64; 2]>> = triangles
        .iter()
        .enumerate()
        .filter(|(index, _)| receiver.excluded_triangle != Some(*index))
        .map(|(_, triangle)| shadow_on_light(light, triangle, receiver.origin))
        .collect();
    hidden.extend(receiver.normal.map(|normal| {
        let to_center = dot(normal, sub(light.center, receiver.origin));
        let slope = [dot(normal, light.half_u), dot(normal, light.half_v)];
        let whole = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        clip(&whole, |uv| -(to_center + slope[0] * uv[0] + slope[1] * uv[1]))
    }));
    Ok((1.0 - area_of_union(&hidden) / 4.0).clamp(0.0, 1.0))
}

/// The triangle's shadow on the light, in the light's coordinates [-1, 1]²; empty when there is none.
fn shadow_on_light(light: &RectangleLight, triangle: &Triangle, origin: Vec3) -> Vec<[f64; 2]> {
    let height = light.height_of(origin);
    let to_center = sub(light.center, origin);
    // A point x projects to u = (height · x_u / x_w − center_u) / |half_u|; multiplied by x_w that is linear in x.
    let across =
        |axis: Vec3, x: Vec3, ahead: f64| (height * dot(axis, x) - dot(axis, to_center) * ahead) / dot(axis, axis);
    let corners: [Homogeneous; 3] = triangle.map(|corner| {
        let x = sub(corner, origin);
        let ahead = -dot(light.normal, x);
        [across(light.half_u, x, ahead), across(light.half_v, x, ahead), ahead, light.height_of(corner)]
    });
    if corners.iter().all(|corner| corner[ABOVE_LIGHT] <= 0.0) {
        return Vec::new();
    }
    // |u| <= w twice over implies w >= 0: what lies behind the receiver goes with the sides of the frustum.
    let bounds: [fn(&Homogeneous) -> f64; 5] =
        [|x| x[ABOVE_LIGHT], |x| x[W] - x[U], |x| x[W] + x[U], |x| x[W] - x[V], |x| x[W] + x[V]];
    let mut polygon = corners.to_vec();
    for bound in bounds {
        polygon = clip(&polygon, bound);
    }
    // The apex itself, where a triangle has a corner at the receiver, has no projection and no area.
    polygon.iter().filter(|x| x[W] > 0.0).map(|x| [U, V].map(|axis| (x[axis] / x[W]).clamp(-1.0, 1.0))).collect()
}
