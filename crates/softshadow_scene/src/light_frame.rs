//! A light as silhouette edges see it: a plane with the light in a known place, float32, one for all receivers.
//!
//! Flat lights: x and y run along the light, so that a rectangle is `[-1, 1]²` and a disc the unit disc; z points from the light into
//! the scene. The frame is the light's own turned by π about its x axis (y and z change sign): a rotation, never a mirror.
//! Sun and sphere are the unit disc at distance 1 / tangent of their half angle; a sphere's frame turns with the receiver.
//!
//! All directions and lines are taken about a **reference point** near the light's centre. It is a little off the centre because
//! scenes are axis-aligned and lattices meet in centres: there its side of an edge would be a tie.

use glam::{DVec2, DVec3};

use crate::frame::LocalFrame;
use crate::light::{Light, LightShape};
use crate::light_samples::{LightSamples, cap_reach};
use crate::occluders::LightBoundary;

/// Where the reference point lies, in half sizes of the light; nothing in a scene stands in such a place by construction.
const REFERENCE: DVec2 = DVec2::new(0.0137, 0.00713);

/// Suns with a smaller tangent of the half angle have so even a measure that area is visibility to 1e-5: their density in the plane varies
/// by 3/2 of the squared tangent, which moves a share of the area by at most a fifth of that. The sun of the Earth has 0.0046.
const NARROW_TANGENT: f64 = 0.005;

/// What makes a receiver's view of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// A light in a plane, with a front.
    Flat {
        /// Centre of the frame.
        origin: [f32; 3],
        /// Frame coordinates of a way from the centre: `rows·way`.
        rows: [[f32; 3]; 3],
        /// Ways from the centre to (1, 0) and (0, 1).
        axes: [[f32; 3]; 2],
    },
    /// A disc at infinity.
    Sun {
        /// Unit axes of x and y, and the direction from the scene to the sun.
        axes: [[f32; 3]; 3],
        /// Tangent of half the angle that the sun spans; 1 for a sun that spans none.
        tangent: f32,
    },
    /// A ball, seen as a disc by each receiver.
    Sphere {
        /// Its centre.
        center: [f32; 3],
        /// Its radius.
        radius: f32,
    },
}

/// The border of a light, relative to the reference point.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// Corners, counter-clockwise.
    Polygon(Vec<[f32; 2]>),
    /// A disc of radius 1 around this point.
    Disc([f32; 2]),
}

impl Outline {
    /// The area within, in units of the frame.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Disc(_) => std::f64::consts::PI,
            Self::Polygon(corners) => {
                let wide: Vec<DVec2> = corners.iter().map(|c| DVec2::from(c.map(f64::from))).collect();
                twice_area(&wide) * 0.5
            }
        }
    }
}

/// The light's frame, its border and its reference point.
#[derive(Debug, Clone, PartialEq)]
pub struct LightFrame {
    /// What makes a receiver's view.
    pub kind: LightKind,
    /// The reference point.
    pub reference: [f32; 2],
    /// Smallest box around the light and the reference point, relative to the latter.
    pub bounds: [[f32; 2]; 2],
    /// The border, where visibility is a share of the area: not on a sphere, nor on a wide sun.
    pub outline: Option<Outline>,
    /// Where geometry stops to be in front of the light.
    pub boundary: LightBoundary,
}

impl LightFrame {
    /// The frame of a light in a scene's local frame.
    #[must_use]
    pub fn new(light: &Light, frame: &LocalFrame) -> Self {
        let place = light.local(frame);
        let flat = |middle: DVec2, half: DVec2| {
            // A light without width keeps a scale across: any will do, its samples lie on the line.
            let largest = if half.max_element() > 0.0 { half.max_element() } else { 1.0 };
            let scale = DVec2::select(half.cmpgt(DVec2::ZERO), half, DVec2::splat(largest)) * place.length_scale;
            let [x, y, z] = [place.x_axis, -place.y_axis, place.emission];
            let origin = place.center
                + place.x_axis * (middle.x * place.length_scale)
                + place.y_axis * (middle.y * place.length_scale);
            LightKind::Flat {
                origin: single(origin),
                rows: [single(x / scale.x), single(y / scale.y), single(z)],
                axes: [single(x * scale.x), single(y * scale.y)],
            }
        };
        let plane = LightBoundary::Plane { point: place.center.to_array(), normal: place.emission.to_array() };
        match light.shape() {
            LightShape::Rectangle { width, height } => {
                let half = DVec2::new(*width, *height) * 0.5;
                let extent = DVec2::select(half.cmpgt(DVec2::ZERO), DVec2::ONE, DVec2::ZERO);
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| DVec2::from(c) * extent);
                Self::polygonal(flat(DVec2::ZERO, half), &corners, REFERENCE * extent, plane)
            }
            LightShape::Polygon { outline } => {
                let (middle, half) = polygon_box(outline);
                let mut corners: Vec<DVec2> = outline.iter().map(|c| polygon_point(*c, middle, half)).collect();
                if twice_area(&corners) < 0.0 {
                    corners.reverse();
                }
                Self::polygonal(flat(middle, DVec2::splat(half)), &corners, REFERENCE, plane)
            }
            LightShape::Disc { radius } => {
                Self::round(flat(DVec2::ZERO, DVec2::splat(*radius)), *radius, plane, *radius > 0.0)
            }
            LightShape::Sun { angular_diameter } => {
                let tangent = (angular_diameter * 0.5).tan();
                let kind = LightKind::Sun {
                    axes: [place.x_axis, -place.y_axis, -place.emission].map(single),
                    tangent: if tangent > 0.0 { tangent as f32 } else { 1.0 },
                };
                Self::round(kind, tangent, LightBoundary::None, tangent > 0.0 && tangent < NARROW_TANGENT)
            }
            LightShape::Sphere { radius } => {
                let local_radius = radius * place.length_scale;
                let kind = LightKind::Sphere { center: single(place.center), radius: local_radius as f32 };
                let ball = LightBoundary::Ball { center: place.center.to_array(), radius: local_radius };
                Self::round(kind, *radius, ball, false)
            }
        }
    }

    fn polygonal(kind: LightKind, corners: &[DVec2], reference: DVec2, boundary: LightBoundary) -> Self {
        let relative: Vec<DVec2> = corners.iter().map(|c| *c - reference).collect();
        let low = relative.iter().fold(DVec2::ZERO, |low, c| low.min(*c));
        let high = relative.iter().fold(DVec2::ZERO, |high, c| high.max(*c));
        let outline = (twice_area(&relative) > 0.0)
            .then(|| Outline::Polygon(relative.iter().map(|c| c.as_vec2().to_array()).collect()));
        let bounds = [low.as_vec2().to_array(), high.as_vec2().to_array()];
        Self { kind, reference: reference.as_vec2().to_array(), bounds, outline, boundary }
    }

    fn round(kind: LightKind, radius: f64, boundary: LightBoundary, area_is_visibility: bool) -> Self {
        // A light without size keeps its reference point where all its samples are.
        let (reference, extent) = if radius > 0.0 { (REFERENCE, 1.0) } else { (DVec2::ZERO, 0.0) };
        let bounds = [-extent - reference, extent - reference].map(|c: DVec2| c.as_vec2().to_array());
        let outline = area_is_visibility.then(|| Outline::Disc((-reference).as_vec2().to_array()));
        Self { kind, reference: reference.as_vec2().to_array(), bounds, outline, boundary }
    }

    /// Samples in this frame. On flat lights and suns relative to the reference point; on a sphere the points of the unit disc that
    /// each receiver stretches to its own view.
    #[must_use]
    pub fn samples(&self, light: &Light, samples: &LightSamples) -> Vec<[f32; 2]> {
        let reference = DVec2::from(self.reference.map(f64::from));
        let place = |p: &[f32; 2]| {
            let p = p.map(f64::from);
            let turned = DVec2::new(p[0], -p[1]);
            match light.shape() {
                LightShape::Rectangle { width, height } => {
                    // No width: every sample lies on the line.
                    turned * DVec2::new(f64::from(u8::from(*width > 0.0)), f64::from(u8::from(*height > 0.0)))
                        - reference
                }
                LightShape::Disc { radius } => turned * f64::from(u8::from(*radius > 0.0)) - reference,
                LightShape::Polygon { outline } => {
                    let (middle, half) = polygon_box(outline);
                    polygon_point(p, middle, half) - reference
                }
                LightShape::Sphere { .. } => turned,
                LightShape::Sun { angular_diameter } => {
                    let half_angle = angular_diameter * 0.5;
                    // A sun that spans no angle has all its samples in one place.
                    let stretch = cap_reach(1.0 - half_angle.cos(), turned.length_squared()) / half_angle.tan();
                    turned * if half_angle > 0.0 { stretch } else { 0.0 } - reference
                }
            }
        };
        samples.parameters.iter().map(|p| place(p).as_vec2().to_array()).collect()
    }
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// Middle and half of the larger side of the box around a polygon.
fn polygon_box(outline: &[[f64; 2]]) -> (DVec2, f64) {
    let points = outline.iter().map(|c| DVec2::from(*c));
    let low = points.clone().fold(DVec2::INFINITY, DVec2::min);
    let high = points.fold(DVec2::NEG_INFINITY, DVec2::max);
    ((low + high) * 0.5, ((high - low) * 0.5).max_element())
}

fn polygon_point(point: [f64; 2], middle: DVec2, half: f64) -> DVec2 {
    let p = (DVec2::from(point) - middle) / half;
    DVec2::new(p.x, -p.y)
}

fn twice_area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}
