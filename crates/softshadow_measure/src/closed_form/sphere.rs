//! A sphere in front of a rectangle, and in front of a spherical light.

use std::f64::consts::PI;

use super::AxisRectangle;
use super::quadrature::integrate_between;
use crate::MeasureError;
use crate::error::require_finite;
use crate::vector::{Vec3, cross, dot, length, sub};

/// A ball, as light or as occluder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// World position of the centre.
    pub center: [f64; 3],
    /// Radius, positive.
    pub radius: f64,
}

impl Sphere {
    fn check(&self, what: &'static str) -> Result<(), MeasureError> {
        require_finite(what, 0, &self.center)?;
        require_finite(what, 0, &[self.radius])?;
        if self.radius > 0.0 {
            Ok(())
        } else {
            Err(MeasureError::Degenerate { why: "a sphere needs a positive radius" })
        }
    }
}

/// Visibility of the rectangle `light` from `receiver` past one sphere.
///
/// With everything relative to the receiver, the direction d is blocked iff `(d·o)² > |d|²(|o|² − r²)`; on the light's
/// plane that is the inside of a conic. For each y its x-interval follows from a quadratic; the clipped length is
/// integrated over y between the points where it is not smooth (the tangents of the conic, its crossings with the light's
/// sides).
///
/// # Errors
/// `NotFinite`, `Degenerate`, or `OutsideDomain` when the sphere reaches through the receiver's plane (the conic is no
/// ellipse) or through the light's plane (the sphere is only partly between).
pub fn sphere_over_rectangle(
    receiver: [f64; 3],
    occluder: &Sphere,
    light: &AxisRectangle,
) -> Result<f64, MeasureError> {
    require_finite("receiver", 0, &receiver)?;
    occluder.check("occluder")?;
    light.check("light")?;
    let up = (light.z - receiver[2]).signum();
    let height = (light.z - receiver[2]).abs();
    if height == 0.0 {
        return Err(MeasureError::Degenerate { why: "the receiver lies in the plane of the light" });
    }
    let mut o = sub(occluder.center, receiver);
    o[2] *= up;
    let r = occluder.radius;
    if o[2] <= -r || o[2] - r >= height {
        return Ok(1.0);
    }
    if o[2] <= r {
        return Err(MeasureError::OutsideDomain {
            why: "the sphere reaches through the receiver's plane, so the conic is no ellipse",
        });
    }
    if o[2] + r > height {
        return Err(MeasureError::OutsideDomain { why: "the sphere reaches through the light's plane" });
    }
    let x = light.x.map(|side| side - receiver[0]);
    let y = light.y.map(|side| side - receiver[1]);
    let along_x = Chord { run: o[0], fixed: o[1], o, r, height };
    let along_y = Chord { run: o[1], fixed: o[0], ..along_x };
    let hidden_length = |y: f64| along_x.ends(y).map_or(0.0, |[low, high]| (high.min(x[1]) - low.max(x[0])).max(0.0));
    let mut breaks = Vec::from(along_x.tangents());
    breaks.extend(x.iter().filter_map(|&side| along_y.ends(side)).flatten());
    let hidden = integrate_between(&hidden_length, y[0], y[1], &breaks);
    Ok((1.0 - hidden / light.area()).clamp(0.0, 1.0))
}

/// The conic cut by lines along one axis: `run` and `fixed` are the sphere's coordinates along it and across it.
struct Chord {
    run: f64,
    fixed: f64,
    o: Vec3,
    r: f64,
    height: f64,
}

impl Chord {
    /// `|o|² − r²` without the coordinate that runs; positive because the sphere clears the receiver's plane.
    fn across(&self) -> f64 {
        self.fixed * self.fixed + self.o[2] * self.o[2] - self.r * self.r
    }

    /// Where the line at `fixed_at` enters and leaves the conic.
    fn ends(&self, fixed_at: f64) -> Option<[f64; 2]> {
        let tangent_length2 = dot(self.o, self.o) - self.r * self.r;
        let m = self.fixed * fixed_at + self.o[2] * self.height;
        let q = fixed_at * fixed_at + self.height * self.height;
        let discriminant = tangent_length2 * (m * m - self.across() * q);
        (discriminant > 0.0).then(|| {
            let root = discriminant.sqrt();
            [(self.run * m - root) / self.across(), (self.run * m + root) / self.across()]
        })
    }

    /// The two positions of the line at which it only touches the conic.
    fn tangents(&self) -> [f64; 2] {
        let depth2 = self.o[2] * self.o[2] - self.r * self.r;
        let spread = self.r * self.across().sqrt();
        [-spread, spread].map(|side| self.height * (self.fixed * self.o[2] + side) / depth2)
    }
}

/// Visible fraction of the solid angle of a spherical `light` past a spherical `occluder`: overlap of two caps.
///
/// At polar angle t from the light's axis the occluder's cap covers the azimuths within φ(t) of its own,
/// `sin²(φ/2) = sin((α_o + t − γ)/2) sin((α_o − t + γ)/2) / (sin t sin γ)`; this half-angle form of
/// `cos φ = (cos α_o − cos t cos γ)/(sin t sin γ)` keeps its digits for small caps. `2φ sin t` is integrated over the light.
///
/// # Errors
/// `NotFinite`, `Degenerate`, or `OutsideDomain` when the receiver is inside a sphere or the occluder is neither entirely
/// nearer than the light nor entirely beyond it.
pub fn sphere_over_sphere_light(receiver: [f64; 3], occluder: &Sphere, light: &Sphere) -> Result<f64, MeasureError> {
    require_finite("receiver", 0, &receiver)?;
    occluder.check("occluder")?;
    light.check("light")?;
    let (o, l) = (sub(occluder.center, receiver), sub(light.center, receiver));
    let (to_occluder, to_light) = (length(o), length(l));
    if to_occluder <= occluder.radius || to_light <= light.radius {
        return Err(MeasureError::OutsideDomain { why: "the receiver is inside a sphere" });
    }
    if to_occluder - occluder.radius >= to_light + light.radius {
        return Ok(1.0);
    }
    if to_occluder + occluder.radius > to_light - light.radius {
        return Err(MeasureError::OutsideDomain { why: "the occluder is not entirely nearer than the light" });
    }
    let light_angle = (light.radius / to_light).asin();
    let cap = (occluder.radius / to_occluder).asin();
    let apart = length(cross(o, l)).atan2(dot(o, l));
    let covered_azimuth = |t: f64| {
        let room = t.sin() * apart.sin();
        if room <= 0.0 {
            return if t + apart <= cap { PI } else { 0.0 };
        }
        let sine2 = ((cap + t - apart) / 2.0).sin() * ((cap - t + apart) / 2.0).sin() / room;
        2.0 * sine2.clamp(0.0, 1.0).sqrt().asin()
    };
    let hidden = integrate_between(
        &|t: f64| 2.0 * covered_azimuth(t) * t.sin(),
        0.0,
        light_angle,
        &[(apart - cap).abs(), apart + cap],
    );
    let half_sine = (light_angle / 2.0).sin();
    Ok((1.0 - hidden / (4.0 * PI * half_sine * half_sine)).clamp(0.0, 1.0))
}
