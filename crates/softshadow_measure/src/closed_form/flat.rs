//! Occluders parallel to the light: half-planes, rectangles, discs.

use std::f64::consts::PI;

use crate::MeasureError;
use crate::error::require_finite;

/// An axis-aligned rectangle in a plane of constant z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisRectangle {
    /// Lowest and highest x.
    pub x: [f64; 2],
    /// Lowest and highest y.
    pub y: [f64; 2],
    /// Height of its plane.
    pub z: f64,
}

impl AxisRectangle {
    pub(crate) fn check(&self, what: &'static str) -> Result<(), MeasureError> {
        require_finite(what, 0, &[self.x[0], self.x[1], self.y[0], self.y[1], self.z])?;
        if self.x[0] < self.x[1] && self.y[0] < self.y[1] {
            Ok(())
        } else {
            Err(MeasureError::Degenerate { why: "a rectangle needs ranges of positive length" })
        }
    }

    /// Area of the rectangle.
    #[must_use]
    pub fn area(&self) -> f64 {
        (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])
    }
}

/// Visible fraction of a rectangle of half sizes `half_size`, centred at the origin of its plane, whose points x are
/// visible where `n·x >= distance` with `n = (cos angle, sin angle)` (radians).
///
/// `n·x` of a uniform point is the sum of two uniform variables, so the hidden fraction is the trapezoid distribution
/// function. It is written by branches: the equivalent corner formula
/// `[R(d+u+v) − R(d+u−v) − R(d−u+v) + R(d−u−v)] / 8uv`, `R(t) = max(t,0)²`, cancels when the edge is nearly axis aligned.
///
/// # Errors
/// `NotFinite`, or `Degenerate` when a half size is not positive.
pub fn half_plane_over_rectangle(distance: f64, angle: f64, half_size: [f64; 2]) -> Result<f64, MeasureError> {
    require_finite("half-plane", 0, &[distance, angle, half_size[0], half_size[1]])?;
    if half_size[0] <= 0.0 || half_size[1] <= 0.0 {
        return Err(MeasureError::Degenerate { why: "half sizes must be positive" });
    }
    let (u, v) = ((half_size[0] * angle.cos()).abs(), (half_size[1] * angle.sin()).abs());
    let (long, short) = (u.max(v), u.min(v));
    // By symmetry the smaller of the two parts is computed, and the other is what is left.
    let to_corner = long + short - distance.abs();
    let smaller_part = if to_corner <= 0.0 {
        0.0
    } else if to_corner < 2.0 * short {
        to_corner * to_corner / (8.0 * long * short)
    } else {
        0.5 - distance.abs() / (2.0 * long)
    };
    Ok(if distance > 0.0 { smaller_part } else { 1.0 - smaller_part })
}

/// Visibility of the rectangle `light` from `receiver` past the parallel rectangle `occluder`.
///
/// The occluder is scaled from the receiver on to the light's plane, where the overlap is a product of two intervals.
/// An occluder that is not strictly between the two planes hides nothing.
///
/// # Errors
/// `NotFinite`, or `Degenerate` for reversed ranges and for a receiver in the light's plane.
pub fn rectangle_over_rectangle(
    receiver: [f64; 3],
    occluder: &AxisRectangle,
    light: &AxisRectangle,
) -> Result<f64, MeasureError> {
    require_finite("receiver", 0, &receiver)?;
    occluder.check("occluder")?;
    light.check("light")?;
    let (to_light, to_occluder) = (light.z - receiver[2], occluder.z - receiver[2]);
    if to_light == 0.0 {
        return Err(MeasureError::Degenerate { why: "the receiver lies in the plane of the light" });
    }
    if to_occluder * to_light <= 0.0 || to_occluder.abs() >= to_light.abs() {
        return Ok(1.0);
    }
    let magnification = to_light / to_occluder;
    let covered = |origin: f64, shade: [f64; 2], lamp: [f64; 2]| {
        let [low, high] = shade.map(|edge| origin + (edge - origin) * magnification);
        (high.min(lamp[1]) - low.max(lamp[0])).max(0.0) / (lamp[1] - lamp[0])
    };
    Ok(1.0 - covered(receiver[0], occluder.x, light.x) * covered(receiver[1], occluder.y, light.y))
}

/// Visibility of a disc of radius `light_radius` past a disc of radius `occluder_radius` that has already been projected
/// on to the light's plane, their centres `distance` apart: one minus the circular lens over the light's area.
///
/// # Errors
/// `NotFinite`, or `Degenerate` for a light without area, a negative radius or a negative distance.
pub fn disc_over_disc(distance: f64, occluder_radius: f64, light_radius: f64) -> Result<f64, MeasureError> {
    require_finite("disc", 0, &[distance, occluder_radius, light_radius])?;
    if light_radius <= 0.0 || occluder_radius < 0.0 || distance < 0.0 {
        return Err(MeasureError::Degenerate { why: "discs need radii and a distance that are not negative" });
    }
    let (d, r, big_r) = (distance, occluder_radius, light_radius);
    if d >= r + big_r {
        return Ok(1.0);
    }
    if d <= (big_r - r).abs() {
        let inner = r.min(big_r) / big_r;
        return Ok(1.0 - inner * inner);
    }
    let sector = |radius: f64, other: f64| {
        let cosine = (d * d + radius * radius - other * other) / (2.0 * d * radius);
        radius * radius * cosine.clamp(-1.0, 1.0).acos()
    };
    let kite = ((r + big_r - d) * (d + r - big_r) * (d - r + big_r) * (d + r + big_r)).sqrt() / 2.0;
    let lens = sector(r, big_r) + sector(big_r, r) - kite;
    Ok((1.0 - lens / (PI * big_r * big_r)).clamp(0.0, 1.0))
}
