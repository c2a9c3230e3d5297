//! # `ray_traced`: shadow rays to light samples
//!
//! The reference on the GPU. For a receiver p and each light sample s, the segment from p to s is traced through a hierarchy
//! until anything is hit; V is the share of samples that are visible. Blocked is what lies below the receiver's horizon, what
//! is hidden by any triangle but the receiver's own, and everything behind a one-sided light. In scenes with semi-opaque triangles a ray
//! goes on to the first opaque one, and V is the mean over the samples of what passes: the product of 1 − opacity over the triangles crossed.
//!
//! **Parameters.** `samples` a pass; their `pattern` and `seed`; `passes`, averaged, each with its own samples, from whose
//! spread the standard error comes; `probes`: that many samples first, and all of them only where they disagree among
//! themselves or within the eight neighbouring pixels (0 traces all samples everywhere); `spread` and `tile`: which receivers share a set
//! of samples (Forest et al. 2008, section 5). `correlated`: all, so penumbrae show steps. `decorrelated`: each takes one of 16 to 256
//! stratified sets, drawn by its index, so steps become noise. `interleaved`: each pixel of a square of `tile` has a set of its own, which
//! together are one stratified set, and the shares of pixels side by side are averaged where they see one surface.
//!
//! **When it is wrong.** A share of n samples is off by about 0.016 at 64 stratified samples along a straight edge; more samples or passes
//! help. Interleaved shares are those of a neighbourhood: they are blurred by half of `tile`, which no number of passes undoes, and err more
//! than one set where penumbrae are only that wide. `probes` can miss an occluder that hides less than one probe's share of the light and
//! no neighbour's. A ray within rounding of an edge may fall to either side, but never between two triangles that share one;
//! through two semi-opaque ones it may count both.
//!
//! **Sources.** Determinant test with shared edges: Davidovič, Engelhardt, Georgiev, Slusallek, Dachsbacher 2012, section 4.
//! Hierarchy without stack: Smits 1998. The interval of a bundle of rays: Wald, Ize, Kensler, Knoll, Parker 2006. Interleaved samples:
//! Keller and Heidrich 2001.

use serde::{Deserialize, Serialize};
use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};
use softshadow_scene::{Light, LightSampling, MAX_SAMPLES, SamplePattern, SampleSpread, pass_seed};

use crate::TechniqueError;
use crate::parts::interleaving::{self, NOISY_BYTES};
use crate::parts::light_buffers::{self, Sampling};
use crate::parts::pattern_name;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{opacity, receivers, resolve, scene_buffers, shading, spread};
use crate::request::{ReceiverSource, Request};

/// Settings of `ray_traced`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RayTraced {
    /// Light samples of one pass, 1 to 32,768.
    pub samples: u32,
    /// How they are spread.
    #[serde(with = "pattern_name")]
    pub pattern: SamplePattern,
    /// Which set of them.
    pub seed: u32,
    /// Progressive passes.
    pub passes: u32,
    /// Samples that decide whether a receiver needs all; 0 traces all samples everywhere.
    pub probes: u32,
    /// Which receivers share a set of samples.
    #[serde(with = "spread")]
    pub spread: SampleSpread,
    /// Side of the square of pixels that interleaves, 2 to 8.
    pub tile: u32,
}

impl Default for RayTraced {
    fn default() -> Self {
        Self {
            samples: 64,
            pattern: SamplePattern::Stratified,
            seed: 0,
            passes: 1,
            probes: 0,
            spread: SampleSpread::Correlated,
            tile: spread::TILE,
        }
    }
}

/// Label, before a sub-scene's number, of how many receivers needed rays and how many rays a driver cut short.
pub const TRACE_COUNTS: &str = "trace counts";

const BEGIN: Kernel = Kernel { file: "ray_traced/begin.wgsl", entry: "begin" };
const GATHER: Kernel = Kernel { file: "ray_traced/gather.wgsl", entry: "gather" };
const NARROW: Kernel = Kernel { file: "ray_traced/narrow.wgsl", entry: "narrow" };
const COUNT_GROUPS: Kernel = Kernel { file: "ray_traced/count_groups.wgsl", entry: "count_groups" };
const TRACE: Kernel = Kernel { file: "ray_traced/trace.wgsl", entry: "trace" };
const CHOOSE: Kernel = Kernel { file: "ray_traced/choose.wgsl", entry: "choose" };
const TRACE_ATTENUATED: Kernel = Kernel { file: "ray_traced/trace.wgsl", entry: "trace_attenuated" };
const CHOOSE_ATTENUATED: Kernel = Kernel { file: "ray_traced/choose.wgsl", entry: "choose_attenuated" };

/// `TraceRange` of `hierarchy.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct TraceRange {
    first_sample: u32,
    end_sample: u32,
    node_count: u32,
    reserved: u32,
}

/// Bytes of `Candidate` of `hierarchy.wgsl`.
const CANDIDATE_BYTES: u64 = 12;
/// Bytes of `CandidateList` before its items.
const LIST_HEADER_BYTES: u64 = 16;

/// `ProbeImage` of `choose.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ProbeImage {
    width: u32,
    height: u32,
}

impl RayTraced {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        let fail = |setting, reason: String| Err(TechniqueError::Setting { technique: "ray_traced", setting, reason });
        if self.samples == 0 || self.samples > MAX_SAMPLES {
            return fail("samples", format!("must lie between 1 and {MAX_SAMPLES}, got {}", self.samples));
        }
        if self.passes == 0 {
            return fail("passes", "must be at least 1".into());
        }
        if self.probes >= self.samples && self.probes != 0 {
            return fail("probes", format!("must be fewer than the {} samples, or 0 for none", self.samples));
        }
        spread::check("ray_traced", &self.sampling(0), u32::MAX)
    }

    /// From 16 samples on, each 1.5 or 1.33 times as many; beyond 1,024 twice as many passes each time, with samples of their own.
    pub(crate) fn rising_quality(&self) -> impl Iterator<Item = Self> {
        spread::rising_samples(1024).map(|(samples, passes)| Self { samples, passes, ..self.clone() })
    }

    /// How a pass samples the light.
    #[must_use]
    pub fn sampling(&self, pass: u32) -> LightSampling {
        let Self { samples, pattern, seed, spread, tile, .. } = *self;
        LightSampling { pattern, count: samples, seed: pass_seed(seed, pass), spread, tile }
    }

    pub(crate) fn halo_rows(&self) -> u32 {
        // Averages are of pixels that have looked at their neighbours' probes.
        interleaving::halo_rows(&self.sampling(0)) + u32::from(self.probes > 0)
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64, sub_scenes: u64, is_semi_opaque: bool) -> u64 {
        let passes = if is_semi_opaque { opacity::bytes_per_receiver(self.samples) } else { 0 };
        // Masks, the number of samples decided, both lists of candidates, values and their errors, and values of one pass.
        let noisy = if self.spread == SampleSpread::Interleaved { NOISY_BYTES } else { 0 };
        u64::from(self.words()) * 4 + 4 + 2 * sub_scenes * CANDIDATE_BYTES + 8 * channels + noisy + passes
    }

    fn words(&self) -> u32 {
        self.samples.div_ceil(32)
    }
}

/// Masks open with the horizon, every sub-scene's hits are OR-ed in, and their share is the result.
pub(crate) fn plan(request: &Request<'_>, settings: &RayTraced) -> Plan {
    let mut plan = Plan::new("ray traced");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let sampling = settings.sampling(0);
    let light = light_buffers::append(&mut plan, sampling.total());
    let words = u64::from(settings.words());
    let blocked = plan.buffer(BLOCKED, count as u64 * words * 4);
    let decided = plan.buffer("decided samples", count as u64 * 4);
    let items = |work_per_item| Over::Items { count: count as u32, work_per_item };

    plan.compute("open masks", "blocks what lies below the horizon or behind the light", BEGIN, items(words as u32))
        .bind("light", light.light)
        .bind("sampling", light.sampling)
        .bind("receivers", receivers)
        .bind("light_samples", light.samples)
        .bind("blocked", blocked)
        .bind("decided", decided);

    let attenuated = request.scene.opacity.as_ref().map(|contents| Attenuated {
        triangles: plan.uploaded(opacity::TRIANGLE_TRANSMITTANCE, &contents.transmittances),
        samples: opacity::append(&mut plan, request, settings.samples, light.sampling, blocked),
    });
    if !request.scene.local.sub_scenes.is_empty() {
        let corners = scene_buffers::append_corners(&mut plan, request.scene);
        let nodes = scene_buffers::append_nodes(&mut plan, request.scene);
        let range = |plan: &mut Plan, stage: &str, index: usize| {
            plan.parameter(format!("{stage} range {index}"), size_of::<TraceRange>() as u64)
        };
        let size = |plan: &mut Plan, stage: &str, index: usize, range: ResourceId, candidates: ResourceId| {
            let size = plan.buffer(format!("{stage} dispatch {index}"), 12);
            let once = Over::Items { count: 1, work_per_item: 1 };
            plan.compute(format!("size {stage} {index}"), "sizes the dispatch over the candidates", COUNT_GROUPS, once)
                .bind("trace_range", range)
                .bind("candidates", candidates)
                .bind("dispatch_size", size);
            size
        };
        let list = |plan: &mut Plan, label: &str, index: usize| {
            let list = plan.buffer(format!("{label} {index}"), LIST_HEADER_BYTES + count as u64 * CANDIDATE_BYTES);
            plan.clear(format!("no {label} {index}"), "the list is empty at first", list);
            list
        };
        let mut candidates = Vec::with_capacity(corners.len());
        for (index, nodes) in nodes.iter().enumerate() {
            let gathered = list(&mut plan, "gathered", index);
            let gather_range = range(&mut plan, "gather", index);
            let why = "finds the receivers with any box between them and the light";
            plan.compute(format!("gather {index}"), why, GATHER, items(4))
                .bind("light", light.light)
                .bind("trace_range", gather_range)
                .bind("receivers", receivers)
                .bind("nodes", *nodes)
                .bind("decided", decided)
                .bind("candidates", gathered);
            let narrow_range = range(&mut plan, "narrow", index);
            let groups = size(&mut plan, "narrow", index, narrow_range, gathered);
            let narrowed = list(&mut plan, "candidates", index);
            let why = "keeps the receivers with a triangle between them and the light";
            plan.compute(format!("narrow {index}"), why, NARROW, Over::Indirect(groups))
                .bind("light", light.light)
                .bind("receivers", receivers)
                .bind("nodes", *nodes)
                .bind("corners", corners[index])
                .bind("candidates", gathered)
                .bind("narrowed", narrowed);
            candidates.push(narrowed);
        }
        let trace = |plan: &mut Plan, stage: &str, why: &str| {
            for index in 0..corners.len() {
                let trace_range = range(plan, stage, index);
                let groups = size(plan, stage, index, trace_range, candidates[index]);
                let kernel = if attenuated.is_some() { TRACE_ATTENUATED } else { TRACE };
                let pass = plan.compute(format!("{stage} {index}"), why, kernel, Over::Indirect(groups));
                pass.bind("light", light.light)
                    .bind("sampling", light.sampling)
                    .bind("trace_range", trace_range)
                    .bind("receivers", receivers)
                    .bind("light_samples", light.samples)
                    .bind("nodes", nodes[index])
                    .bind("corners", corners[index])
                    .bind("decided", decided)
                    .bind("candidates", candidates[index]);
                match &attenuated {
                    Some(passing) => pass
                        .bind("triangle_transmittance", passing.triangles)
                        .bind("sample_transmittance", passing.samples),
                    None => pass.bind("blocked", blocked),
                };
            }
        };
        if settings.probes == 0 {
            trace(&mut plan, "trace", "traces every sample of the candidates");
        } else {
            trace(&mut plan, "probe", "traces the first samples of the candidates");
            let why = "finds the receivers whose probes or neighbours disagree";
            let kernel = if attenuated.is_some() { CHOOSE_ATTENUATED } else { CHOOSE };
            let image = plan.parameter("probe image", size_of::<ProbeImage>() as u64);
            let pass = plan.compute("choose", why, kernel, items(settings.probes / 4 + 1));
            pass.bind("sampling", light.sampling).bind("probe_image", image).bind("receivers", receivers);
            match &attenuated {
                Some(passing) => pass.bind("sample_transmittance", passing.samples),
                None => pass.bind("blocked", blocked),
            };
            pass.bind("decided", decided);
            trace(&mut plan, "trace", "traces the other samples where the probes disagree");
        }
        for (index, list) in candidates.into_iter().enumerate() {
            let counts = plan.buffer(format!("{TRACE_COUNTS} {index}"), LIST_HEADER_BYTES);
            let why = "tells how many receivers needed rays, and whether any ray was cut short";
            plan.copy(format!("report {index}"), why, [list, counts], LIST_HEADER_BYTES);
            plan.outputs.push(counts);
        }
    }
    let masks = Masks { blocked, decided, areas: None, transmittance: attenuated.map(|passing| passing.samples) };
    resolve::append(&mut plan, request, &sampling, &light, receivers, masks);
    plan
}

/// What rays read and write instead of masks where triangles are semi-opaque.
struct Attenuated {
    triangles: ResourceId,
    samples: ResourceId,
}

/// The values of the plan's parameters for one light and pass.
pub(crate) fn values(
    request: &Request<'_>,
    settings: &RayTraced,
    light: &Light,
    pass: u32,
) -> Result<Values, TechniqueError> {
    let mut values = Values::new();
    receivers::values(request, &mut values);
    let sampling = settings.sampling(pass);
    light_buffers::values(request, light, &sampling, &mut values)?;
    interleaving::values(request, &sampling, &mut values);
    let mut record = Sampling::new(request, &sampling, pass, settings.passes);
    // Nothing is traced in an empty scene, so no probe could call for more.
    if settings.probes > 0 && !request.scene.local.sub_scenes.is_empty() {
        record.probes = settings.probes;
    }
    values.insert("sampling".into(), bytemuck::bytes_of(&record).to_vec());
    for (index, sub_scene) in request.scene.local.sub_scenes.iter().enumerate() {
        let node_count = sub_scene.nodes.len() as u32;
        let stages = [
            ("gather", 0, 1),
            ("narrow", 0, 1),
            ("probe", 0, settings.probes),
            ("trace", settings.probes, settings.samples),
        ];
        for (stage, first_sample, end_sample) in stages {
            let range = TraceRange { first_sample, end_sample, node_count, reserved: 0 };
            values.insert(format!("{stage} range {index}"), bytemuck::bytes_of(&range).to_vec());
        }
    }
    let image = match request.receivers {
        ReceiverSource::Camera(camera) => {
            ProbeImage { width: camera.size()[0], height: (request.block.count / camera.size()[0] as usize) as u32 }
        }
        ReceiverSource::Points(_) => ProbeImage { width: 0, height: 0 },
    };
    values.insert("probe image".into(), bytemuck::bytes_of(&image).to_vec());
    shading::values(request, settings.passes, &mut values);
    Ok(values)
}
