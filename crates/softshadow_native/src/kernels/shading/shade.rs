//! The twin of `shading/shade.wgsl`: eight samples of one receiver at a time.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*, u32x8};
use glam::Vec3;
use rayon::prelude::*;

use super::pow::pow;
use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::light::{LIGHT_FLAT, LIGHT_SPHERE, Light, LightView, eight_ways, light_view};
use crate::kernels::shared::receiver::{RECEIVER_NONE, Receiver};
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records, records_mut};

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Material {
    base_color: Vec3,
    specular: f32,
    exponent: f32,
    reserved: [u32; 3],
}

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Shading {
    eye: Vec3,
    /// 0 for the first light and pass: replaces what is there.
    adds: u32,
    /// 1 / progressive passes.
    weight: f32,
    /// Of the visibility that modulates.
    channels: u32,
    reserved: [u32; 2],
}

/// What receivers see of the samples.
enum Seen<'a> {
    /// All or nothing of each.
    Masks { decided: &'a [u32], blocked: &'a [u32] },
    /// What passes to each.
    Transmittance { decided: &'a [u32], samples: &'a [f32] },
    /// A share of all of them, by channel.
    Visibility(&'a [f32]),
}

#[rustfmt::skip]
pub(super) fn integrated(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, blocked, surfaces @ ..] = call.buffers([
        "decided", "blocked",
        "receivers", "light_samples", "sample_radiance", "triangle_materials", "materials", "color",
    ]);
    pass.shade(surfaces, &Seen::Masks { decided, blocked });
}

#[rustfmt::skip]
pub(super) fn integrated_attenuated(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, samples, surfaces @ ..] = call.buffers([
        "decided", "sample_transmittance",
        "receivers", "light_samples", "sample_radiance", "triangle_materials", "materials", "color",
    ]);
    pass.shade(surfaces, &Seen::Transmittance { decided, samples: records(samples) });
}

#[rustfmt::skip]
pub(super) fn modulated(call: &mut Call) {
    let pass = Pass::of(call);
    let [visibility, surfaces @ ..] = call.buffers([
        "visibility",
        "receivers", "light_samples", "sample_radiance", "triangle_materials", "materials", "color",
    ]);
    pass.shade(surfaces, &Seen::Visibility(records(visibility)));
}

/// What all receivers are shaded by.
struct Pass {
    items: Range<usize>,
    level: Level,
    light: Light,
    sampling: Sampling,
    shading: Shading,
}

/// A pass, and what its surfaces and samples are like.
struct Shader<'a> {
    pass: &'a Pass,
    seen: &'a Seen<'a>,
    light_samples: &'a [[f32; 4]],
    sample_radiance: &'a [[f32; 4]],
    triangle_materials: &'a [u32],
    materials: &'a [Material],
}

impl Pass {
    fn of(call: &mut Call) -> Self {
        let (light, sampling, shading) = (call.uniform("light"), call.uniform("sampling"), call.uniform("shading"));
        Self { items: call.item_range(), level: call.level, light, sampling, shading }
    }

    fn shade(&self, surfaces: [&mut [u32]; 6], seen: &Seen<'_>) {
        let [receivers, light_samples, sample_radiance, triangle_materials, materials, color] = surfaces;
        let shader = Shader {
            pass: self,
            seen,
            light_samples: records(light_samples),
            sample_radiance: records(sample_radiance),
            triangle_materials,
            materials: records(materials),
        };
        let receivers = &records::<Receiver>(receivers)[self.items.clone()];
        let color = &mut records_mut::<[f32; 4]>(color)[self.items.clone()];
        let runs = color.par_chunks_mut(RUN).zip(receivers.par_chunks(RUN)).enumerate();
        runs.for_each(|(run, (color, receivers))| {
            let first = self.items.start + run * RUN;
            dispatch!(self.level, simd => shader.shade_run(simd, first, receivers, color));
        });
    }
}

impl Seen<'_> {
    /// How much a receiver sees of eight samples of its set.
    #[inline(always)]
    fn of_eight<S: Simd>(&self, simd: S, sampling: &Sampling, receiver: usize, first: usize) -> f32x8<S> {
        match self {
            Self::Masks { decided, blocked } => {
                let masks = &blocked[receiver * sampling.words as usize..];
                // Where only probes were traced they agree, and speak for all samples.
                let mask = match only_probes(sampling, decided[receiver]) {
                    true if masks[0] & 1 != 0 => u32::MAX,
                    _ => masks[first / 32] >> (first % 32),
                };
                f32x8::from_fn(simd, |k| if mask >> k & 1 == 0 { 1.0 } else { 0.0 })
            }
            Self::Transmittance { decided, samples } => {
                let samples = &samples[receiver * sampling.count as usize..(receiver + 1) * sampling.count as usize];
                match only_probes(sampling, decided[receiver]) {
                    true => f32x8::splat(simd, samples[0]),
                    false => f32x8::from_fn(simd, |k| samples[(first + k).min(samples.len() - 1)]),
                }
            }
            Self::Visibility(_) => f32x8::splat(simd, 1.0),
        }
    }

    /// The share of all samples, by channel, that their sum does not yet have.
    #[inline(always)]
    fn of_all(&self, shading: &Shading, receiver: usize) -> Vec3 {
        let Self::Visibility(visibility) = self else { return Vec3::ONE };
        let last = shading.channels as usize - 1;
        let at = receiver * shading.channels as usize;
        Vec3::new(visibility[at], visibility[at + last.min(1)], visibility[at + last.min(2)])
    }
}

fn only_probes(sampling: &Sampling, known: u32) -> bool {
    known < sampling.count && known > 0
}

impl Shader<'_> {
    #[inline(always)]
    fn shade_run<S: Simd>(&self, simd: S, first: usize, receivers: &[Receiver], color: &mut [[f32; 4]]) {
        let shading = &self.pass.shading;
        for (k, (receiver, color)) in receivers.iter().zip(color).enumerate() {
            if receiver.kind == RECEIVER_NONE {
                *color = [0.0; 4];
                continue;
            }
            let sum = self.sum_of_samples(simd, first + k, receiver) * self.seen.of_all(shading, first + k);
            let [red, green, blue, _] = *color;
            let before = if shading.adds == 0 { Vec3::ZERO } else { Vec3::new(red, green, blue) };
            *color = (before + sum * shading.weight).extend(1.0).to_array();
        }
    }

    #[inline(always)]
    fn sum_of_samples<S: Simd>(&self, simd: S, index: usize, receiver: &Receiver) -> Vec3 {
        let sampling = &self.pass.sampling;
        let view = light_view(&self.pass.light, receiver.position);
        let material = &self.materials[self.triangle_materials[receiver.triangle as usize] as usize];
        let set = match self.seen {
            // Without shadow there is nothing to decorrelate: the first set serves all.
            Seen::Visibility(_) if view.exists => 0,
            Seen::Visibility(_) => return Vec3::ZERO,
            _ => sampling.first_sample(index as u32) as usize,
        };
        let zero = f32x8::splat(simd, 0.0);
        let count = sampling.count as usize;
        let mut sum = Vec3::ZERO;
        for first in (0..count).step_by(LANES) {
            let seen = self.seen.of_eight(simd, sampling, index, first);
            let exists = u32x8::from_fn(simd, |k| k as u32).simd_lt((count - first) as u32);
            let is_seen = exists & seen.simd_gt(zero);
            if !is_seen.any_true() {
                continue;
            }
            let samples = std::array::from_fn(|k| set + (first + k).min(count - 1));
            let added = self.contributions(simd, receiver, &view, samples, material).scale(seen);
            let added = Vec3x8::select(is_seen, added, Vec3x8::new(zero, zero, zero));
            // One after the other: floats do not add up the same in another order.
            sum = (0..LANES).fold(sum, |sum, k| sum + added.lane(k));
        }
        sum
    }

    /// Radiance that eight unblocked samples send from the receiver to the eye.
    #[inline(always)]
    fn contributions<S: Simd>(
        &self,
        simd: S,
        receiver: &Receiver,
        view: &LightView,
        samples: [usize; LANES],
        material: &Material,
    ) -> Vec3x8<S> {
        let light = &self.pass.light;
        let splat = |value: f32| f32x8::splat(simd, value);
        let (zero, tiny, count) = (splat(0.0), splat(1e-30), self.pass.sampling.count as f32);
        if view.inside {
            // Light from everywhere: a Lambert surface returns its share of it.
            return Vec3x8::splat(simd, light.radiance * material.base_color / count);
        }
        let way = eight_ways(simd, light, view, &samples.map(|sample| self.light_samples[sample]), receiver.position);
        let squared = way.dot(way).max(tiny);
        let direction = way.scale(1.0 / squared.sqrt());
        let normal = Vec3x8::splat(simd, receiver.normal);
        let cosine = normal.dot(direction).max(zero);
        let solid_angle = match light.kind {
            LIGHT_FLAT => light.measure * (-Vec3x8::splat(simd, light.emission).dot(direction)).max(zero) / squared,
            LIGHT_SPHERE => splat(TAU * view.cap),
            _ => splat(light.measure),
        };
        let base = material.base_color * FRAC_1_PI;
        let mut reflected = Vec3x8::splat(simd, base);
        // Most surfaces are matt, and powers are slow.
        if material.specular != 0.0 {
            let to_eye = self.pass.shading.eye - receiver.position;
            let towards_eye = to_eye * (1.0 / to_eye.dot(to_eye).max(1e-30).sqrt());
            let halfway = direction + Vec3x8::splat(simd, towards_eye);
            let length = halfway.dot(halfway).max(tiny).sqrt();
            let lobe = (normal.dot(halfway) * (1.0 / length)).max(zero);
            // Blinn's lobe scaled to reflect its share whatever the exponent.
            let scale = material.specular * (material.exponent + 8.0) * 0.125 * FRAC_1_PI;
            let specular = scale * pow(simd, lobe.max(splat(1e-6)), material.exponent);
            reflected = reflected + Vec3x8::new(specular, specular, specular);
        }
        let radiance = Vec3x8::from_fn(simd, |k| {
            let [red, green, blue, _] = self.sample_radiance[samples[k]];
            light.radiance * Vec3::new(red, green, blue)
        });
        let sent = (radiance * reflected).scale(cosine).scale(solid_angle);
        Vec3x8::new(sent.x / count, sent.y / count, sent.z / count)
    }
}
