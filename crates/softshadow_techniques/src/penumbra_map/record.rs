//! The light as `penumbra_map` draws it.

use glam::{DVec2, DVec3};
use softshadow_scene::{Light, LightShape};

use super::Ramp;
use crate::parts::shadow_views;
use crate::request::Request;

/// Corners of a polygon that a record holds.
pub(super) const MOST_CORNERS: usize = 64;

/// Lights smaller than this, in local units, have no penumbra that float32 resolves; of a line this is the width.
const SMALLEST: f64 = 1e-9;

/// `PenumbraLight` of `light.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PenumbraLight {
    x_axis: [f32; 3],
    far: f32,
    y_axis: [f32; 3],
    radius: f32,
    z_axis: [f32; 3],
    corner_count: u32,
    half_size: [f32; 2],
    area: f32,
    ramp: u32,
    outline: [[f32; 4]; MOST_CORNERS],
}

/// `MapLayer` of `light.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MapLayer {
    layer: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

impl MapLayer {
    pub(super) fn new(layer: u32) -> Self {
        Self { layer, reserved0: 0, reserved1: 0, reserved2: 0 }
    }
}

/// Whether a light has a penumbra at all.
pub(super) fn has_size(light: &Light) -> bool {
    match light.shape() {
        LightShape::Rectangle { width, height } => *width > 0.0 || *height > 0.0,
        LightShape::Disc { radius } | LightShape::Sphere { radius } => *radius > 0.0,
        LightShape::Sun { angular_diameter } => *angular_diameter > 0.0,
        LightShape::Polygon { .. } => true,
    }
}

impl PenumbraLight {
    pub(super) fn new(request: &Request<'_>, light: &Light, ramp: Ramp) -> Self {
        let place = light.local(&request.scene.local.frame);
        let size = |length: f64| (length * place.length_scale).max(SMALLEST) as f32;
        let f32s = |v: DVec3| v.as_vec3().to_array();
        let mut record = Self {
            x_axis: f32s(place.x_axis),
            far: farthest(request, light) as f32,
            y_axis: f32s(-place.y_axis),
            z_axis: f32s(place.emission),
            ramp: ramp as u32,
            ..bytemuck::Zeroable::zeroed()
        };
        match light.shape() {
            LightShape::Rectangle { width, height } => record.half_size = [size(width * 0.5), size(height * 0.5)],
            LightShape::Disc { radius } | LightShape::Sphere { radius } => record.radius = size(*radius),
            LightShape::Sun { angular_diameter } => {
                record.radius = (angular_diameter * 0.5).tan().max(SMALLEST) as f32;
            }
            LightShape::Polygon { outline } => {
                let corners = convex_hull(outline).into_iter().map(|c| c * place.length_scale).collect();
                record.take_outline(corners);
            }
        }
        record
    }

    fn take_outline(&mut self, corners: Vec<DVec2>) {
        self.corner_count = corners.len().min(MOST_CORNERS) as u32;
        let next = corners.iter().cycle().skip(1);
        self.area = (corners.iter().zip(next.clone()).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() * 0.5) as f32;
        for (record, (a, b)) in self.outline.iter_mut().zip(corners.iter().zip(next)) {
            let normal = -(*b - *a).perp();
            let line = normal / normal.dot(*a);
            *record = [a.x as f32, a.y as f32, line.x as f32, line.y as f32];
        }
    }
}

/// The farthest that anything lies from the eye of the views, along the light's way, or from a sphere's centre; 0 without casters.
fn farthest(request: &Request<'_>, light: &Light) -> f64 {
    let Some(corners) = shadow_views::hull(request) else { return 0.0 };
    let place = light.local(&request.scene.local.frame);
    let along = corners.map(|c| c.dot(place.emission));
    let (nearest, most) =
        (along.iter().copied().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max));
    match light.shape() {
        LightShape::Sun { .. } => most - nearest,
        LightShape::Sphere { .. } => corners.iter().map(|c| (*c - place.center).length()).fold(0.0, f64::max),
        _ => most - place.center.dot(place.emission),
    }
}

/// Corners of the hull of an outline in the light's frame, counter-clockwise there: y is turned, as the light looks along z.
pub(super) fn convex_hull(outline: &[[f64; 2]]) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = outline.iter().map(|c| DVec2::new(c[0], -c[1])).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    // Andrew's monotone chain: the lower side from the left, the upper one from the right.
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut kept: Vec<DVec2> = Vec::new();
        for p in points {
            while kept.len() >= 2
                && (kept[kept.len() - 1] - kept[kept.len() - 2]).perp_dot(p - kept[kept.len() - 1]) <= 0.0
            {
                kept.pop();
            }
            kept.push(p);
        }
        kept.pop();
        kept
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

/// Whether the light's origin lies within a hull, and not on its border.
pub(super) fn holds_its_center(hull: &[DVec2]) -> bool {
    let next = hull.iter().cycle().skip(1);
    let size = hull.iter().map(|c| c.length()).fold(0.0, f64::max);
    hull.len() >= 3 && hull.iter().zip(next).all(|(a, b)| a.perp_dot(*b) > 1e-6 * size * (*b - *a).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_are_convex_and_wind_the_light_way() {
        // A triangle with a corner inside, a point in the middle of a side, and a corner twice; y is turned.
        let outline = [[-1.0, -1.0], [1.0, -1.0], [1.0, -1.0], [0.0, -0.5], [0.0, 2.0], [0.0, -1.0]];
        let hull = convex_hull(&outline);
        assert_eq!(hull, [DVec2::new(-1.0, 1.0), DVec2::new(0.0, -2.0), DVec2::new(1.0, 1.0)]);
        let next = hull.iter().cycle().skip(1);
        assert!(hull.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() > 0.0, "counter-clockwise");
        assert!(holds_its_center(&hull));
    }

    #[test]
    fn a_center_on_the_border_or_outside_is_none() {
        let at = |x: f64| convex_hull(&[[x, -1.0], [x + 2.0, -1.0], [x + 2.0, 1.0], [x, 1.0]]);
        assert!(holds_its_center(&at(-1.0)) && holds_its_center(&at(-0.01)));
        assert!(!holds_its_center(&at(0.0)) && !holds_its_center(&at(0.5)));
        assert!(!holds_its_center(&convex_hull(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])), "a line has no inside");
    }
}
