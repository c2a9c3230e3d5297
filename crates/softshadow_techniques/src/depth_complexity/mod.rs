//! # `depth_complexity`: silhouette edges instead of rays
//!
//! V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by Depth Complexity Sampling", Computer Graphics Forum 27(2), 2008.
//!
//! The number of triangles between a receiver and a light sample is counted at one reference point of the light, by a ray, and changes
//! only at the images of silhouette edges. So a receiver folds the edges between it and the light into one counter a sample, 64 samples at
//! a time; a sample is visible where its counter is 0. What counts as which side is decided once for each edge and face
//! (`softshadow_native::depth_complexity` is the same in Rust, and says why), so the answer is that of rays to the same samples.
//!
//! Edges find their receivers in one of two ways. *Tiled*, the default and beyond the paper: receivers are taken in tiles; every tile lists
//! the edges that can be silhouettes in the shaft between it and the light. And where the counters show a single depth, the *area* beyond
//! the edges answers, without sampling noise. *Blended*, the paper's own pipeline without a geometry shader: every edge is drawn as a wedge
//! over a camera's image, and packed counters are added up by the hardware. Both decide by the same predicates and see the same samples.
//!
//! **Semi-opaque occluders**, tiled only. Beside the count of opaque triangles goes a sum of units, one number a triangle crossed:
//! −log2(1 − opacity), in 4,096ths. A sample passes 0 where the count is not 0, else 2^−sum: the product of what passes each triangle, as
//! rays have it, for any number of sheets, to within 1/11,800 of it for each sheet (half a unit). An edge between two opacities feeds both
//! counters. Units are integers and nothing saturates, so what an edge adds another takes away; where more of them come together than sums
//! hold (2^27, 8,000 sheets of opacity 0.94), the call ends with an error. Scenes without such triangles carry nothing of this.
//!
//! **Soups.** Foliage has no surface to take silhouettes of: every leaf's border is an edge from everywhere. There the same predicates
//! answer triangle by triangle: a receiver walks the hierarchy over the triangles once for 64 samples, passes by what no visible sample
//! lies behind, and takes away the samples that a triangle hides: those inside its border, by the reference point and the edges that
//! are crossed on the way from it. The masks are those of edges, bit for bit where both were compared; there are no lists and no areas.
//!
//! **Parameters.** `samples` a pass, up to 256; `pattern`, `seed`, `passes`, `spread`, `tile` as for `ray_traced`, with the same sets for
//! the same receivers, but interleaved sets of at most 8,192 samples together; `exact_area` and `spread`, tiled only; `silhouettes`, all of
//! the light's (`accurate`) or those of one point (`standard`); `coverage`, `exact` or as published by `table`, for samples that stand
//! still; `attenuation`: `logarithmic`, or `sum`, the paper's own, which adds opacities up to all of the light; `unit`: `edges`,
//! `triangles`, or `auto`, which takes triangles for a light with more borders before it than faces and than a list has room for, where
//! spread is `correlated` and everything opaque; `evaluation`.
//! Blended only: `initial_counts`, `rays` or the paper's `z_fail`; `counters`, `words` by atomics or the paper's `float` targets; `base`,
//! the smallest base of a digit; `batches`, 1 or the paper's 2, outer wedges before inner ones. A first draw bounds every receiver's
//! counters, and digits are as wide as the bounds demand: nothing overflows. One batch is the default: where digits are chosen by the
//! largest initial count, as published, outer-first order lets partial sums leave 2^24, and counts are lost silently (at base 64 in 16 % of
//! the pixels at 128 events each and in 94 % at 256, in simulation; in none in mixed order).
//!
//! **When it is wrong.** Areas are wrong where layers overlap between the samples (the first 64 of them say whether; at most by the
//! sampler's own error). They answer for rectangles, discs, polygons of up to 64 corners and suns up to half a degree; not for spheres and
//! wider suns, whose measure is solid angle, not where any face before a light is semi-opaque, and for no light of a call in which any has a
//! texture. Samples are off as for `ray_traced`, and averages of interleaved ones leave what areas answered alone. Where too many
//! edges lie before one receiver, or a walk over triangles takes too many steps for a software driver, the call ends with an error that names
//! the way out. On a canopy of 20,000 leaves triangles cost what `ray_traced` costs, and not less: 1.01 times its CPU time for 16 samples at
//! 512 × 512 on Mesa's software driver, 1.13 for 64, 1.7 for 256, at the same error. Edges cannot run there. Triangles
//! that touch a sphere light are tried against every sample as rays would; refused where anything is semi-opaque, or
//! blended. `attenuation: sum` is right for one sheet alone: two of opacity 0.5 hide everything, where a quarter
//! passes, and a closed body is two sheets.
//! `table` puts samples within a cell of an edge on either side of it: some in a thousand.
//! `standard` silhouettes are for comparison: a body casts the shadow of the flat one within the loop of edges that c sees.
//! Blended: points are refused, and so are scenes with semi-opaque triangles, and receivers that stand half a pixel from the middle of
//! theirs, on triangles thinner than a pixel. `z_fail` decides by rasterised depth what lies behind a receiver, which contradicts the edges
//! for about 1 receiver of 7,000.

pub mod blended;
mod coverage_table;
mod covered;
mod order;
mod settings;
mod tiled;
mod touching;
mod unit;
mod values;

use softshadow_plan::{Kernel, Origin, Over, Pass, Plan, ResourceId, Shape};

use crate::parts::opacity;
use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{light_buffers, receivers, resolve};
use crate::request::{ReceiverSource, Request};
pub use covered::{CoverSettings, SampleBins};
pub use settings::{Attenuation, Counters, Coverage, DepthComplexity, Evaluation, InitialCounts, Silhouettes};
pub use tiled::LIST_COUNTS;
use tiled::{SLOT_BYTES, TILE, tiles};
pub use touching::TouchingRange;
pub use unit::OccluderUnit;
use unit::{Unit, unit_of};
pub(crate) use values::values;
pub use values::{AttenuationScale, ClusterRange, FoldSettings, FrameRecord};
use values::{MOST_SAMPLES, SET_SAMPLES, is_attenuated, shares_samples};

const OPEN_MASKS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks" };
const OPEN_MASKS_OF_SETS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks_of_sets" };

/// Depth of the reference point for every receiver; lists of edges for every tile; counters folded over them.
pub(crate) fn plan(request: &Request<'_>, settings: &DepthComplexity) -> Plan {
    // `check_call` refuses wedges for points: they have no image to be drawn on.
    if let (Evaluation::Blended, ReceiverSource::Camera(camera)) = (settings.evaluation, request.receivers) {
        return blended::plan(request, settings, camera.size());
    }
    let mut plan = Plan::new("depth complexity");
    let receivers = receivers::append(&mut plan, request);
    let sampling = settings.sampling(0);
    let light = light_buffers::append(&mut plan, sampling.total());
    let samples = if shares_samples(request.light, settings) {
        Samples::shared(&mut plan)
    } else {
        Samples::Own { sets: plan.parameter("sample sets", u64::from(SET_SAMPLES) * 8), sampling: light.sampling }
    };
    let reads = append_masks(&mut plan, request, settings, samples, receivers, Origin::Transient);
    let occluders = request.occluders.filter(|occluders| occluders.edge_count > 0);
    let contents = request.scene.opacity.as_ref().filter(|_| is_attenuated(request));
    let attenuated = contents.map(|contents| Attenuated {
        scale: plan.parameter("attenuation scale", size_of::<AttenuationScale>() as u64),
        triangles: plan.uploaded("triangle attenuation", settings.attenuation.of(contents)),
        samples: opacity::append(&mut plan, request, settings.samples, light.sampling, reads.blocked),
    });
    let areas = occluders.and_then(|occluders| match unit_of(request, settings, occluders) {
        Unit::Edges => tiled::append_fold(&mut plan, request, settings, occluders, &reads, attenuated.as_ref()),
        Unit::Triangles => {
            covered::append_covers(&mut plan, request, settings, occluders, &reads);
            None
        }
    });
    touching::append(&mut plan, request, settings, &light, receivers, reads.blocked);

    let decided = plan.buffer("decided samples", request.block.count as u64 * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks =
        Masks { blocked: reads.blocked, decided, areas, transmittance: attenuated.map(|passing| passing.samples) };
    resolve::append(&mut plan, request, &sampling, &light, receivers, masks);
    plan
}

/// The pass that opens the masks; slots and masks live as long as `origin` says.
fn append_masks(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    samples: Samples,
    receivers: ResourceId,
    origin: Origin,
) -> Reads {
    let count = request.block.count;
    let frame = plan.parameter("light frame", size_of::<FrameRecord>() as u64);
    let order = plan.parameter("receiver order", count as u64 * 4);
    let slot_bytes = u64::from(tiles(request) * TILE) * SLOT_BYTES;
    let slots = plan.resource("slots", Shape::Buffer { bytes: slot_bytes }, origin);
    let mask_bytes = count as u64 * u64::from(settings.words()) * 4;
    let blocked = plan.resource(BLOCKED, Shape::Buffer { bytes: mask_bytes }, origin);
    let over = Over::Items { count: count as u32, work_per_item: settings.words() };
    let why = "blocks what lies below the horizon or behind the light";
    let pass = plan.compute("open masks", why, samples.kernel(OPEN_MASKS, OPEN_MASKS_OF_SETS), over);
    samples.bind(pass.bind("light_frame", frame));
    pass.bind("receivers", receivers).bind("order", order).bind("slots", slots).bind("blocked", blocked);
    Reads { frame, samples, receivers, slots, blocked }
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
    fn shared(plan: &mut Plan) -> Self {
        Self::Shared(plan.parameter("frame samples", u64::from(MOST_SAMPLES) * 16))
    }

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

/// What the passes over semi-opaque faces read and write besides.
struct Attenuated {
    scale: ResourceId,
    triangles: ResourceId,
    samples: ResourceId,
}
