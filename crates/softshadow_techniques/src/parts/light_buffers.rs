//! The light and its samples as the kernels read them.

use glam::{DVec3, Vec3};
use softshadow_plan::{Plan, ResourceId, Values};
use softshadow_scene::{Light, LightSamples, LightSampling, LightShape, SampleSpread, SceneError};

use crate::request::{ReceiverSource, Request};

/// `Light` of `shared/light.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LightRecord {
    center: [f32; 3],
    kind: u32,
    emission: [f32; 3],
    radius: f32,
    radiance: [f32; 3],
    measure: f32,
    low: [f32; 3],
    reserved0: u32,
    high: [f32; 3],
    reserved1: u32,
}

/// `Sampling` of `shared/samples.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Sampling {
    /// Samples of the light.
    pub count: u32,
    /// 32-bit words of a receiver's mask.
    pub words: u32,
    /// Samples traced for every receiver.
    pub probes: u32,
    /// Progressive pass, from 0.
    pub pass_index: u32,
    /// Progressive passes in all.
    pub passes: u32,
    /// Sets of samples; with a row, the side of the square of pixels that has them all.
    pub sets: u32,
    /// Pixels of a row, where sets are taken by place; 0 where they are drawn.
    pub row: u32,
    /// First receiver of the block among all of the call.
    pub first_receiver: u32,
}

impl Sampling {
    /// Pass `pass_index` of `passes` in which every sample is traced for every receiver.
    #[must_use]
    pub fn new(request: &Request<'_>, sampling: &LightSampling, pass_index: u32, passes: u32) -> Self {
        let (sets, row) = match (sampling.spread, request.receivers) {
            (SampleSpread::Interleaved, ReceiverSource::Camera(camera)) => (sampling.tile, camera.size()[0]),
            _ => (sampling.sets(), 0),
        };
        let first = if sampling.spread == SampleSpread::Correlated { 0 } else { request.block.first as u32 };
        let (count, words) = (sampling.count, sampling.count.div_ceil(32));
        Self { count, words, probes: count, pass_index, passes, sets, row, first_receiver: first }
    }
}

const FLAT: u32 = 0;
const SPHERE: u32 = 1;
const SUN: u32 = 2;

/// The parameters of a light in a plan.
#[derive(Debug, Clone, Copy)]
pub struct LightBuffers {
    /// `Light`.
    pub light: ResourceId,
    /// `Sampling`.
    pub sampling: ResourceId,
    /// One vec4 a sample of any set.
    pub samples: ResourceId,
}

/// Adds the light's parameters for `count` samples of all sets.
pub fn append(plan: &mut Plan, count: u32) -> LightBuffers {
    LightBuffers {
        light: plan.parameter("light", size_of::<LightRecord>() as u64),
        sampling: plan.parameter("sampling", size_of::<Sampling>() as u64),
        samples: plan.parameter("light samples", u64::from(count) * 16),
    }
}

/// Adds one vec4 of relative radiance a sample of any set.
pub fn append_radiance(plan: &mut Plan, count: u32) -> ResourceId {
    plan.parameter("sample radiance", u64::from(count) * 16)
}

/// The values of the parameters that [`append`] and [`append_radiance`] added, but for `sampling`; and the samples.
///
/// # Errors
/// As [`LightSamples::new`].
pub fn values(
    request: &Request<'_>,
    light: &Light,
    sampling: &LightSampling,
    values: &mut Values,
) -> Result<LightSamples, SceneError> {
    let samples = LightSamples::new(light, &request.scene.local.frame, sampling)?;
    values.insert("light".into(), bytemuck::bytes_of(&record(request, light, &samples)).to_vec());
    values.insert("light samples".into(), bytemuck::cast_slice(&samples.records).to_vec());
    let radiance: Vec<[f32; 4]> = samples.radiance.iter().map(|r| [r[0], r[1], r[2], 0.0]).collect();
    values.insert("sample radiance".into(), bytemuck::cast_slice(&radiance).to_vec());
    Ok(samples)
}

fn record(request: &Request<'_>, light: &Light, samples: &LightSamples) -> LightRecord {
    let frame = &request.scene.local.frame;
    let place = light.local(frame);
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for r in &samples.records {
        let p = Vec3::new(r[0], r[1], r[2]);
        (low, high) = (low.min(p), high.max(p));
    }
    let (kind, radius, measure) = match light.shape() {
        LightShape::Rectangle { width, height } => (FLAT, 0.0, width * height),
        LightShape::Disc { radius } => (FLAT, 0.0, std::f64::consts::PI * radius * radius),
        LightShape::Polygon { outline } => (FLAT, 0.0, shoelace(outline)),
        LightShape::Sphere { radius } => (SPHERE, frame.local_length(*radius), 0.0),
        LightShape::Sun { angular_diameter } => {
            (SUN, 0.0, std::f64::consts::TAU * (1.0 - (angular_diameter * 0.5).cos()))
        }
    };
    let area_scale = if kind == FLAT { place.length_scale * place.length_scale } else { 1.0 };
    let f32s = |v: DVec3| v.as_vec3().to_array();
    LightRecord {
        center: if kind == SUN { [0.0; 3] } else { f32s(place.center) },
        kind,
        emission: f32s(place.emission),
        radius: radius as f32,
        radiance: light.radiance(),
        measure: (measure * area_scale) as f32,
        low: low.to_array(),
        reserved0: 0,
        high: high.to_array(),
        reserved1: 0,
    }
}

fn shoelace(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs() * 0.5
}
