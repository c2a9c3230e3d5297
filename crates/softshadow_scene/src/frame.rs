//! The local frame: float64 world coordinates become float32 without losing what matters.
//!
//! World data is moved to the centre of the scene's bounds and scaled by a power of two, in float64, before anything
//! is rounded. So a scene at UTM coordinates gives the image of the scene at the origin, and scaling a scene by a power of
//! two changes no bit. The frame depends on the scene alone, never on the receivers: results do not depend on how a
//! caller splits his points, and what was uploaded serves the next call.

use glam::{DMat4, DVec3};

use crate::error::SceneError;

/// `local = (world − origin)·2^−exponent`; every vertex of the scene lies in `[-1, 1]³`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFrame {
    origin: DVec3,
    exponent: i32,
}

impl LocalFrame {
    /// The frame of the box around all given points; the identity where there are none.
    #[must_use]
    pub fn around(bounds: Option<([f64; 3], [f64; 3])>) -> Self {
        let Some((low, high)) = bounds else { return Self { origin: DVec3::ZERO, exponent: 0 } };
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        // Halved before adding: the sum of two large coordinates must not overflow.
        let origin = low * 0.5 + high * 0.5;
        let half_extent = (high - origin).max(origin - low).max_element();
        Self { origin, exponent: exponent_above(half_extent) }
    }

    /// World units a local unit: a power of two.
    #[must_use]
    pub fn world_from_local_scale(&self) -> f64 {
        2f64.powi(self.exponent)
    }

    /// World position of the local origin.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin.to_array()
    }

    /// A world point in local float64.
    #[must_use]
    pub fn local_from_world(&self, world: [f64; 3]) -> DVec3 {
        (DVec3::from(world) - self.origin) / self.world_from_local_scale()
    }

    /// A local point in world coordinates.
    #[must_use]
    pub fn world_from_local(&self, local: [f32; 3]) -> [f64; 3] {
        (DVec3::from(local.map(f64::from)) * self.world_from_local_scale() + self.origin).to_array()
    }

    /// A world length in local units.
    #[must_use]
    pub fn local_length(&self, world: f64) -> f64 {
        world / self.world_from_local_scale()
    }
}

/// The smallest exponent `e` with `value ≤ 2^e`; 0 for an extent of zero (one point has no scale).
fn exponent_above(value: f64) -> i32 {
    if value <= 0.0 {
        return 0;
    }
    // log2 may round to either side of an integer: correct it by comparing.
    let mut exponent = value.log2().ceil() as i32;
    while 2f64.powi(exponent) < value {
        exponent += 1;
    }
    while exponent > -1000 && 2f64.powi(exponent - 1) >= value {
        exponent -= 1;
    }
    exponent.clamp(-1000, 1000)
}

/// Checks that a row-major matrix is a rotation and a translation, and returns it.
///
/// # Errors
/// [`SceneError::Invalid`] names the matrix and says what it is instead.
pub(crate) fn rigid(what: &str, rows: &[[f64; 4]; 4]) -> Result<DMat4, SceneError> {
    let m = DMat4::from_cols_array_2d(rows).transpose();
    if !m.is_finite() {
        return Err(SceneError::invalid(what, "holds a number that is not finite"));
    }
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err(SceneError::invalid(what, "the last row must be 0 0 0 1 (column vectors, translation in [:3, 3])"));
    }
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(glam::DVec4::truncate);
    let orthonormal =
        (0..3).all(|i| (0..3).all(|j| (axes[i].dot(axes[j]) - if i == j { 1.0 } else { 0.0 }).abs() < 1e-6));
    if !orthonormal {
        return Err(SceneError::invalid(
            what,
            "must be a rotation and a translation; give sizes in world units instead",
        ));
    }
    if axes[0].cross(axes[1]).dot(axes[2]) < 0.0 {
        return Err(SceneError::invalid(what, "is a mirror; use a rotation (determinant +1)"));
    }
    Ok(m)
}

/// A rigid matrix at `eye` whose local −Z points at `target` and whose +Y lies towards `up`.
///
/// Without `up` it is world +Y, or world −Z where the view is vertical.
///
/// # Errors
/// [`SceneError::Invalid`] when eye and target coincide or `up` is parallel to the view.
pub fn look_at(eye: [f64; 3], target: [f64; 3], up: Option<[f64; 3]>) -> Result<[[f64; 4]; 4], SceneError> {
    let (e, t) = (DVec3::from(eye), DVec3::from(target));
    if !(e.is_finite() && t.is_finite() && up.is_none_or(|u| DVec3::from(u).is_finite())) {
        return Err(SceneError::invalid("look_at", "eye, target and up must be finite"));
    }
    let Some(back) = (e - t).try_normalize() else {
        return Err(SceneError::invalid("look_at", "eye and target are the same point; move one of them"));
    };
    let right = match up {
        Some(up) => DVec3::from(up)
            .cross(back)
            .try_normalize()
            .filter(|_| DVec3::from(up).try_normalize().is_some_and(|u| u.cross(back).length() > 1e-9)),
        None if back.y.abs() > 0.999_999 => DVec3::NEG_Z.cross(back).try_normalize(),
        None => DVec3::Y.cross(back).try_normalize(),
    };
    let Some(right) = right else {
        return Err(SceneError::invalid("look_at", "up is zero or parallel to the view; give another direction"));
    };
    let above = back.cross(right);
    let (r, a, b) = (right, above, back);
    Ok([[r.x, a.x, b.x, e.x], [r.y, a.y, b.y, e.y], [r.z, a.z, b.z, e.z], [0.0, 0.0, 0.0, 1.0]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_scale_changes_no_local_bit() {
        let bounds = ([-0.3, 0.1, -7.7], [1.3, 2.9, 0.4]);
        let point = [0.123_456, 1.9, -3.3];
        let base = LocalFrame::around(Some(bounds)).local_from_world(point);
        for power in [-20, -3, 1, 20] {
            let s = 2f64.powi(power);
            let scaled = LocalFrame::around(Some((bounds.0.map(|x| x * s), bounds.1.map(|x| x * s))));
            assert_eq!(scaled.local_from_world(point.map(|x| x * s)), base);
        }
        let off = LocalFrame::around(Some((bounds.0.map(|x| x * 3.0), bounds.1.map(|x| x * 3.0))));
        assert_ne!(off.local_from_world(point.map(|x| x * 3.0)), base, "3 is no power of two");
    }

    #[test]
    fn the_scene_fills_the_unit_cube_and_world_comes_back() {
        let frame = LocalFrame::around(Some(([5e5, 4e6, 0.0], [5e5 + 3.0, 4e6 + 1.0, 2.0])));
        let corner = frame.local_from_world([5e5 + 3.0, 4e6, 2.0]);
        assert!(corner.abs().max_element() <= 1.0 && corner.abs().max_element() > 0.5);
        let local = corner.as_vec3().to_array();
        assert_eq!(frame.world_from_local(local), [5e5 + 3.0, 4e6, 2.0]);
    }

    #[test]
    fn exponents_are_tight() {
        for (value, exponent) in [(1.0, 0), (1.000_001, 1), (0.5, -1), (0.75, 0), (3.0, 2), (0.0, 0)] {
            assert_eq!(exponent_above(value), exponent, "{value}");
        }
    }

    #[test]
    fn look_at_is_rigid_and_refuses_nonsense() {
        for (eye, target) in [([1.0, 2.0, 3.0], [0.0; 3]), ([0.0, 5.0, 0.0], [0.0; 3]), ([0.0, -5.0, 0.0], [0.0; 3])] {
            let m = look_at(eye, target, None).unwrap();
            assert!(rigid("m", &m).is_ok());
            let forward = [-m[0][2], -m[1][2], -m[2][2]];
            let way: f64 = (0..3).map(|k| forward[k] * (target[k] - eye[k])).sum();
            assert!((way - DVec3::from(eye).length()).abs() < 1e-12);
        }
        assert!(look_at([1.0; 3], [1.0; 3], None).is_err());
        assert!(look_at([0.0, 1.0, 0.0], [0.0; 3], Some([0.0, 2.0, 0.0])).is_err());
        let mirror = [[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        assert!(rigid("m", &mirror).unwrap_err().to_string().contains("mirror"));
    }
}
