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
//! **Parameters.** `samples` a pass, up to 256; `pattern`, `seed`, `passes` as for `ray_traced`; `exact_area`, tiled only; `evaluation`.
//! Blended only: `initial_counts`, `rays` or the paper's `z_fail`; `counters`, `words` by atomics or the paper's `float` targets; `base`,
//! the smallest base of a digit; `batches`, 1 or the paper's 2, outer wedges before inner ones. A first draw bounds every receiver's
//! counters, and digits are as wide as the bounds demand: nothing overflows. One batch is the default: where digits are chosen by the
//! largest initial count, as published, outer-first order lets partial sums leave 2^24, and counts are lost silently (at base 64 in 16 % of
//! the pixels at 128 events each and in 94 % at 256, in simulation; in none in mixed order).
//!
//! **When it is wrong.** Areas are wrong where layers overlap between the samples (the first 64 of them say whether; at most by the
//! sampler's own error). They answer for rectangles, discs, polygons of up to 64 corners and suns up to half a degree; not for spheres and
//! wider suns, whose measure is solid angle, and for no light of a call in which any has a texture. Samples are off as for `ray_traced`. Foliage has no surface to take silhouettes of: every leaf's border is an edge, lists grow long, and the call ends
//! with an error that names `ray_traced`. Triangles that touch a sphere light are refused.
//! Blended: points are refused, and so are receivers that stand half a pixel from the middle of theirs, on triangles thinner than a pixel.
//! `z_fail` decides by rasterised depth what lies behind a receiver, which contradicts the edges for about 1 receiver of 7,000.

pub mod blended;
mod order;
mod settings;
mod tiled;
mod values;

use softshadow_plan::{Kernel, Origin, Over, Plan, ResourceId, Shape};

use crate::parts::resolve::{BLOCKED, Masks};
use crate::parts::{light_buffers, receivers, resolve};
use crate::request::{ReceiverSource, Request};
pub use settings::{Counters, DepthComplexity, Evaluation, InitialCounts};
pub use tiled::LIST_COUNTS;
use tiled::{SLOT_BYTES, TILE, tiles};
use values::MOST_SAMPLES;
pub(crate) use values::values;
pub use values::{ClusterRange, FoldSettings, FrameRecord};

const OPEN_MASKS: Kernel = Kernel { file: "depth_complexity/open_masks.wgsl", entry: "open_masks" };

/// Depth of the reference point for every receiver; lists of edges for every tile; counters folded over them.
pub(crate) fn plan(request: &Request<'_>, settings: &DepthComplexity) -> Plan {
    // `check_call` refuses wedges for points: they have no image to be drawn on.
    if let (Evaluation::Blended, ReceiverSource::Camera(camera)) = (settings.evaluation, request.receivers) {
        return blended::plan(request, settings, camera.size());
    }
    let mut plan = Plan::new("depth complexity");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = light_buffers::append(&mut plan, settings.samples);
    let reads = append_masks(&mut plan, request, settings, receivers, Origin::Transient);
    let occluders = request.occluders.filter(|occluders| occluders.edge_count > 0);
    let areas = occluders.map(|occluders| tiled::append_fold(&mut plan, request, occluders, &reads));

    let decided = plan.buffer("decided samples", count as u64 * 4);
    plan.clear("all samples decided", "every mask speaks for all samples", decided);
    let masks = Masks { blocked: reads.blocked, decided, areas: areas.filter(|_| settings.exact_area) };
    resolve::append(&mut plan, request, settings.samples, &light, receivers, masks);
    plan
}

/// The pass that opens the masks; slots and masks live as long as `origin` says.
fn append_masks(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &DepthComplexity,
    receivers: ResourceId,
    origin: Origin,
) -> Reads {
    let count = request.block.count;
    let frame = plan.parameter("light frame", size_of::<FrameRecord>() as u64);
    let samples = plan.parameter("frame samples", u64::from(MOST_SAMPLES) * 16);
    let order = plan.parameter("receiver order", count as u64 * 4);
    let slot_bytes = u64::from(tiles(request) * TILE) * SLOT_BYTES;
    let slots = plan.resource("slots", Shape::Buffer { bytes: slot_bytes }, origin);
    let mask_bytes = count as u64 * u64::from(settings.words()) * 4;
    let blocked = plan.resource(BLOCKED, Shape::Buffer { bytes: mask_bytes }, origin);
    let over = Over::Items { count: count as u32, work_per_item: settings.words() };
    let why = "blocks what lies below the horizon or behind the light";
    plan.compute("open masks", why, OPEN_MASKS, over)
        .bind("light_frame", frame)
        .bind("frame_samples", samples)
        .bind("receivers", receivers)
        .bind("order", order)
        .bind("slots", slots)
        .bind("blocked", blocked);
    Reads { frame, samples, receivers, slots, blocked }
}

/// What several passes read.
struct Reads {
    frame: ResourceId,
    samples: ResourceId,
    receivers: ResourceId,
    slots: ResourceId,
    blocked: ResourceId,
}
