//! # `depth_complexity`: silhouette edges instead of rays
//!
//! V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by Depth Complexity Sampling", Computer Graphics Forum 27(2), 2008.
//!
//! The number of triangles between a receiver and a light sample is counted at one reference point of the light, by a ray, and changes
//! only at the images of silhouette edges. So a receiver folds the edges between it and the light into one counter a sample, 64 samples at
//! a time; a sample is visible where its counter is 0. What counts as which side is decided once for each edge and face
//! (`softshadow_native::depth_complexity` is the same in Rust, and says why), so the answer is that of rays to the same samples.
//!
//! Beyond the paper: edges are not rasterised as wedges. Receivers are taken in tiles; every tile lists the edges that can be
//! silhouettes in the shaft between it and the light. And where the counters show a single depth, the *area* beyond the edges answers,
//! without sampling noise.
//!
//! **Parameters.** `samples` a pass, up to 256; `pattern`, `seed`, `passes`, `spread`, `tile` as for `ray_traced`, with the same sets for
//! the same receivers, but interleaved sets of at most 8,192 samples together; `exact_area`.
//!
//! **When it is wrong.** Areas are wrong where layers overlap between the samples (the first 64 of them say whether; at most by the
//! sampler's own error). They answer for rectangles, discs, polygons of up to 64 corners and suns up to half a degree; not for spheres and
//! wider suns, whose measure is solid angle, and for no light of a call in which any has a texture. Samples are off as for `ray_traced`, and
//! averages of interleaved ones leave what areas answered alone. Foliage has no surface to take silhouettes of: every leaf's border is an
//! edge, lists grow long, and the call ends with an error that names `ray_traced`. Triangles that touch a sphere light are refused.

mod order;
mod tiled;
mod values;

use serde::{Deserialize, Serialize};
use softshadow_plan::{Kernel, Over, Pass, Plan, ResourceId};
use softshadow_scene::{LightSampling, SamplePattern, SampleSpread, pass_seed};

use crate::TechniqueError;
use crate::parts::interleaving::{self, NOISY_BYTES};
use crate::parts::pattern_name;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{light_buffers, receivers, resolve, spread};
use crate::request::Request;
pub use tiled::LIST_COUNTS;
use tiled::{SLOT_BYTES, TILE, tiles};
pub(crate) use values::values;
pub use values::{ClusterRange, FoldSettings, FrameRecord};
use values::{MOST_SAMPLES, SET_SAMPLES, shares_samples};

/// Settings of `depth_complexity`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DepthComplexity {
    /// Light samples of one pass, 1 to 256.
    pub samples: u32,
    /// How they are spread.
    #[serde(with = "pattern_name")]
    pub pattern: SamplePattern,
    /// Which set of them.
    pub seed: u32,
    /// Progressive passes.
    pub passes: u32,
    /// Whether the light's visible area answers where a single layer hides it.
    pub exact_area: bool,
    /// Which receivers share a set of samples.
    #[serde(with = "spread")]
    pub spread: SampleSpread,
    /// Side of the square of pixels that interleaves, 2 to 8.
    pub tile: u32,
}

impl Default for DepthComplexity {
    fn default() -> Self {
        Self {
            samples: 64,
            pattern: SamplePattern::Stratified,
            seed: 0,
            passes: 1,
            exact_area: true,
            spread: SampleSpread::Correlated,
            tile: spread::TILE,
        }
    }
}

const OPEN_MASKS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks" };
const OPEN_MASKS_OF_SETS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks_of_sets" };

impl DepthComplexity {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        let fail =
            |setting, reason: String| Err(TechniqueError::Setting { technique: "depth_complexity", setting, reason });
        if self.samples == 0 || self.samples > MOST_SAMPLES {
            let reason = format!("must lie between 1 and {MOST_SAMPLES}, got {}; more come as passes", self.samples);
            return fail("samples", reason);
        }
        if self.passes == 0 {
            return fail("passes", "must be at least 1".into());
        }
        spread::check("depth_complexity", &self.sampling(0), SET_SAMPLES)
    }

    /// How a pass samples the light.
    #[must_use]
    pub fn sampling(&self, pass: u32) -> LightSampling {
        let Self { samples, pattern, seed, spread, tile, .. } = *self;
        LightSampling { pattern, count: samples, seed: pass_seed(seed, pass), spread, tile }
    }

    pub(crate) fn halo_rows(&self) -> u32 {
        interleaving::halo_rows(&self.sampling(0))
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64) -> u64 {
        let area = if self.exact_area && channels == 1 { 4 } else { 0 };
        let noisy = if self.spread == SampleSpread::Interleaved { NOISY_BYTES } else { 0 };
        // Order, slot, mask, decided samples; its part of a tile; values and their errors, and values of one pass.
        let masks = 4 + SLOT_BYTES + u64::from(self.words()) * 4 + 4;
        masks + area + tiled::list_bytes_per_receiver() + 8 * channels + noisy
    }

    fn words(&self) -> u32 {
        self.samples.div_ceil(32)
    }
}

/// Depth of the reference point for every receiver; lists of edges for every tile; counters folded over them.
pub(crate) fn plan(request: &Request<'_>, settings: &DepthComplexity) -> Plan {
    let mut plan = Plan::new("depth complexity");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let sampling = settings.sampling(0);
    let light = light_buffers::append(&mut plan, sampling.total());
    let frame = plan.parameter("light frame", size_of::<FrameRecord>() as u64);
    let samples = if shares_samples(request.light, settings) {
        Samples::Shared(plan.parameter("frame samples", u64::from(MOST_SAMPLES) * 16))
    } else {
        Samples::Own { sets: plan.parameter("sample sets", u64::from(SET_SAMPLES) * 8), sampling: light.sampling }
    };
    let order = plan.parameter("receiver order", count as u64 * 4);
    let slots = plan.buffer("slots", u64::from(tiles(request) * TILE) * SLOT_BYTES);
    let blocked = plan.buffer(BLOCKED, count as u64 * u64::from(settings.words()) * 4);
    let items = |n: u32, work_per_item: u32| Over::Items { count: n, work_per_item };
    let why = "blocks what lies below the horizon or behind the light";
    let kernel = samples.kernel(OPEN_MASKS, OPEN_MASKS_OF_SETS);
    let pass = plan.compute("open masks", why, kernel, items(count as u32, settings.words()));
    samples.bind(pass.bind("light_frame", frame));
    pass.bind("receivers", receivers).bind("order", order).bind("slots", slots).bind("blocked", blocked);
    let reads = Reads { frame, samples, receivers, slots, blocked };
    let occluders = request.occluders.filter(|occluders| occluders.edge_count > 0);
    let areas = occluders.and_then(|occluders| tiled::append_fold(&mut plan, request, settings, occluders, &reads));

    let decided = plan.buffer("decided samples", count as u64 * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks = Masks { blocked, decided, areas };
    resolve::append(&mut plan, request, &sampling, &light, receivers, masks);
    plan
}

/// Where the samples of a receiver stand.
#[derive(Clone, Copy)]
enum Samples {
    /// One set for all.
    Shared(ResourceId),
    /// One of several sets, and what says which.
    Own { sets: ResourceId, sampling: ResourceId },
}

impl Samples {
    fn kernel(self, shared: Kernel, own: Kernel) -> Kernel {
        match self {
            Self::Shared(_) => shared,
            Self::Own { .. } => own,
        }
    }

    fn bind(self, pass: &mut Pass) {
        match self {
            Self::Shared(samples) => pass.bind("frame_samples", samples),
            Self::Own { sets, sampling } => pass.bind("sample_sets", sets).bind("sampling", sampling),
        };
    }
}

/// What several passes read.
struct Reads {
    frame: ResourceId,
    samples: Samples,
    receivers: ResourceId,
    slots: ResourceId,
    blocked: ResourceId,
}
