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
//! **Soups.** Foliage has no surface to take silhouettes of: every leaf's border is an edge from everywhere. There the same predicates
//! answer triangle by triangle: a receiver walks the hierarchy over the triangles once for 64 samples, passes by what no visible sample
//! lies behind, and takes away the samples that a triangle hides: those inside its border, by the reference point and the edges that
//! are crossed on the way from it. The masks are those of edges, bit for bit where both were compared; there are no lists and no areas.
//!
//! **Parameters.** `samples` a pass, up to 256; `pattern`, `seed`, `passes` as for `ray_traced`; `exact_area`; `unit`: `edges`,
//! `triangles`, or `auto`, which takes triangles for a light with more borders before it than faces and than a list has room for.
//!
//! **When it is wrong.** Areas are wrong where layers overlap between the samples (the first 64 of them say whether; at most by the
//! sampler's own error). They answer for rectangles, discs, polygons of up to 64 corners and suns up to half a degree; not for spheres and
//! wider suns, whose measure is solid angle, for no light of a call in which any has a texture, and not over triangles. Samples are off as
//! for `ray_traced`. Where too many edges lie before one receiver, or a walk over triangles takes too many steps for a software driver, the
//! call ends with an error that names the way out. On a canopy of 20,000 leaves triangles cost what `ray_traced` costs, and not less: 1.01
//! times its CPU time for 16 samples at 512 × 512 on Mesa's software driver, 1.13 for 64, 1.7 for 256, at the same error. Edges cannot
//! run there.
//!
//! Triangles that touch a sphere light are tried against every sample as rays would, after either unit.

mod covered;
mod order;
mod tiled;
mod touching;
mod unit;
mod values;

use serde::{Deserialize, Serialize};
use softshadow_plan::{Kernel, Over, Plan, ResourceId};
use softshadow_scene::SamplePattern;

use crate::TechniqueError;
use crate::parts::pattern_name;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{light_buffers, receivers, resolve};
use crate::request::Request;
pub use covered::{CoverSettings, SampleBins};
pub use tiled::LIST_COUNTS;
use tiled::{SLOT_BYTES, TILE, tiles};
pub use touching::TouchingRange;
pub use unit::OccluderUnit;
use unit::Unit;
use values::MOST_SAMPLES;
pub(crate) use values::values;
pub use values::{ClusterRange, FoldSettings, FrameRecord};

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
    /// What is folded: silhouette edges, or triangles.
    pub unit: OccluderUnit,
}

impl Default for DepthComplexity {
    fn default() -> Self {
        Self {
            samples: 64,
            pattern: SamplePattern::Stratified,
            seed: 0,
            passes: 1,
            exact_area: true,
            unit: OccluderUnit::Auto,
        }
    }
}

const OPEN_MASKS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks" };

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
        Ok(())
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64) -> u64 {
        // Order, slot, mask, decided samples, area; its part of a tile; values and their errors.
        4 + SLOT_BYTES + u64::from(self.words()) * 4 + 4 + 4 + tiled::list_bytes_per_receiver() + 8 * channels
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
    let light = light_buffers::append(&mut plan, settings.samples);
    let frame = plan.parameter("light frame", size_of::<FrameRecord>() as u64);
    let samples = plan.parameter("frame samples", u64::from(MOST_SAMPLES) * 16);
    let order = plan.parameter("receiver order", count as u64 * 4);
    let slots = plan.buffer("slots", u64::from(tiles(request) * TILE) * SLOT_BYTES);
    let blocked = plan.buffer(BLOCKED, count as u64 * u64::from(settings.words()) * 4);
    let items = |n: u32, work_per_item: u32| Over::Items { count: n, work_per_item };
    let why = "blocks what lies below the horizon or behind the light";
    plan.compute("open masks", why, OPEN_MASKS, items(count as u32, settings.words()))
        .bind("light_frame", frame)
        .bind("frame_samples", samples)
        .bind("receivers", receivers)
        .bind("order", order)
        .bind("slots", slots)
        .bind("blocked", blocked);
    let reads = Reads { frame, receivers, slots, blocked };
    let occluders = request.occluders.filter(|occluders| occluders.edge_count > 0);
    let areas = occluders.and_then(|occluders| match settings.unit.of(occluders) {
        Unit::Edges => tiled::append_fold(&mut plan, request, settings, occluders, &reads),
        Unit::Triangles => {
            covered::append_covers(&mut plan, request, settings, occluders, &reads);
            None
        }
    });

    touching::append(&mut plan, request, settings, &light, receivers, blocked);

    let decided = plan.buffer("decided samples", count as u64 * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks = Masks { blocked, decided, areas };
    resolve::append(&mut plan, request, settings.samples, &light, receivers, masks);
    plan
}

/// What several passes read.
struct Reads {
    frame: ResourceId,
    receivers: ResourceId,
    slots: ResourceId,
    blocked: ResourceId,
}
