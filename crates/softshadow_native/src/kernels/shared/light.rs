//! The twin of `shared/light.wgsl`.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

use crate::kernels::lanes::{LANES, Vec3x8};

pub(crate) const LIGHT_FLAT: u32 = 0;
pub(crate) const LIGHT_SPHERE: u32 = 1;
pub(crate) const LIGHT_SUN: u32 = 2;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Light {
    pub(crate) center: Vec3,
    pub(crate) kind: u32,
    pub(crate) emission: Vec3,
    /// Of a sphere.
    pub(crate) radius: f32,
    pub(crate) radiance: Vec3,
    /// Area of a flat light, solid angle of the sun.
    pub(crate) measure: f32,
    /// Box around all samples of a flat light, or around the directions towards the sun.
    pub(crate) low: Vec3,
    reserved0: u32,
    pub(crate) high: Vec3,
    reserved1: u32,
}

/// What a receiver sees of the light: where its samples lie.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LightView {
    x_axis: Vec3,
    y_axis: Vec3,
    /// 1 - cosine of the half angle of a sphere.
    pub(crate) cap: f32,
    /// Of that half angle.
    sine_squared: f32,
    distance: f32,
    /// False behind a flat light, where nothing is visible.
    pub(crate) exists: bool,
    /// The receiver lies inside a sphere light: everything is visible.
    pub(crate) inside: bool,
}

pub(crate) fn light_view(light: &Light, receiver: Vec3) -> LightView {
    let exists = light.kind != LIGHT_FLAT || (receiver - light.center).dot(light.emission) > 0.0;
    if light.kind != LIGHT_SPHERE {
        return LightView { exists, ..LightView::default() };
    }
    let axis = light.center - receiver;
    let squared = axis.dot(axis);
    let distance = squared.sqrt();
    let sine_squared = light.radius * light.radius / squared.max(1e-37);
    let cap = (sine_squared / (1.0 + (1.0 - sine_squared).max(0.0).sqrt())).min(0.999);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    let n = axis / distance.max(1e-37);
    let s = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    LightView {
        x_axis: Vec3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x),
        y_axis: Vec3::new(b, s + n.y * n.y * a, -n.y),
        cap,
        sine_squared: sine_squared.min(1.0),
        distance,
        exists,
        inside: sine_squared >= 1.0,
    }
}

/// The ways to eight samples: the whole segments, or directions towards the sun.
#[inline(always)]
pub(crate) fn eight_ways<S: Simd>(
    simd: S,
    light: &Light,
    view: &LightView,
    records: &[[f32; 4]; LANES],
    receiver: Vec3,
) -> Vec3x8<S> {
    let part = |i: usize| f32x8::from_fn(simd, |k| records[k][i]);
    let from = Vec3x8::splat(simd, receiver);
    let (x, y) = (part(0), part(1));
    if light.kind != LIGHT_SPHERE {
        return Vec3x8::new(x, y, part(2)) - from.scale(part(3));
    }
    let splat = |value: f32| f32x8::splat(simd, value);
    let (one, cap) = (splat(1.0), splat(view.cap));
    let share = x * x + y * y;
    let reach = (cap * (splat(2.0) - share * cap)).sqrt() / (one - share * cap);
    let (x_axis, y_axis) = (Vec3x8::splat(simd, view.x_axis), Vec3x8::splat(simd, view.y_axis));
    let offset = (x_axis.scale(x) + y_axis.scale(y)).scale(reach * splat(view.distance));
    let outside = splat(1.0 - view.sine_squared);
    let far = (one - (one + reach * reach * share) * outside).max(splat(0.0)).sqrt();
    let to_surface = outside / (one + far);
    (from + (Vec3x8::splat(simd, light.center - receiver) + offset).scale(to_surface)) - from
}

/// Lowest and highest corner of a box around all ways to the light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WayBounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
}

pub(crate) fn light_way_bounds(light: &Light, view: &LightView, receiver: Vec3) -> WayBounds {
    match light.kind {
        LIGHT_SUN => WayBounds { low: light.low, high: light.high },
        LIGHT_FLAT => WayBounds { low: light.low - receiver, high: light.high - receiver },
        _ => {
            let reach = view.distance * (view.cap * (2.0 - view.cap)).sqrt() / (1.0 - view.cap) * 1.00001;
            let axis = light.center - receiver;
            WayBounds { low: axis - reach, high: axis + reach }
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use glam::Vec4;

    use super::*;

    /// One at a time, as the WGSL has it: a point on the light and 1, or a direction towards the sun and 0.
    fn light_sample(light: &Light, view: &LightView, record: [f32; 4], receiver: Vec3) -> Vec4 {
        let [x, y, ..] = record;
        if light.kind != LIGHT_SPHERE {
            return record.into();
        }
        let share = x * x + y * y;
        let reach = (view.cap * (2.0 - share * view.cap)).sqrt() / (1.0 - share * view.cap);
        let offset = (view.x_axis * x + view.y_axis * y) * (reach * view.distance);
        let outside = 1.0 - view.sine_squared;
        let to_surface = outside / (1.0 + (1.0 - (1.0 + reach * reach * share) * outside).max(0.0).sqrt());
        (receiver + (light.center - receiver + offset) * to_surface).extend(1.0)
    }

    /// The way from a receiver to a sample: the whole segment, or a direction towards the sun.
    fn light_way(target_and_kind: Vec4, receiver: Vec3) -> Vec3 {
        target_and_kind.truncate() - target_and_kind.w * receiver
    }

    #[test]
    fn eight_ways_are_those_of_each_sample() {
        let records: [[f32; 4]; LANES] =
            std::array::from_fn(|k| [0.1 * k as f32 - 0.3, 0.7 - 0.2 * k as f32, 0.9, 1.0]);
        for kind in [LIGHT_FLAT, LIGHT_SPHERE, LIGHT_SUN] {
            let light = Light { center: Vec3::new(0.3, 0.4, 2.0), kind, radius: 0.6, ..Light::zeroed() };
            for receiver in [Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.3, 0.5, 1.9)] {
                let view = light_view(&light, receiver);
                let ways = dispatch!(Level::new(), simd => {
                    let ways = eight_ways(simd, &light, &view, &records, receiver);
                    std::array::from_fn::<Vec3, LANES, _>(|k| ways.lane(k))
                });
                let each = records.map(|record| light_way(light_sample(&light, &view, record, receiver), receiver));
                assert_eq!(ways, each, "kind {kind}");
            }
        }
    }
}
