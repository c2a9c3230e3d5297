//! # `occlusion_layers`: the scene as a few layers of bits, prefiltered
//!
//! Plausible soft shadows whose cost does not depend on the size of the light, and hardly on the scene. What lies between light and receivers is
//! cut into slices parallel to the light; each is projected onto its far plane, as one bit a texel. A receiver sees the light through a box of
//! every slice: the share of set texels in it, exact from a summed-area table, is what the slice hides. Shares are put together as if slices knew
//! nothing of each other: V is the product of 1 − share. Both are wrong by themselves, and better for parts of the light: with `split` m the light
//! is cut into m × m boxes, slices are put together in each, and V is their mean. As m grows, V becomes that of the layered scene.
//!
//! The technique is known as occlusion textures; glTF uses that name for something else.
//!
//! **Parameters.** `slices`, 1 to 128; `resolution` of each, 64 to 2,048 texels a side; `split`; `filter`: `summed_area`, which is exact, and for comparison
//! the published `nbuffer` and `mipmap`; `combine`: `product`, or for comparison
//! `maximum`, which is never too dark, and `sum`, which is never too bright; `projection`: from a point behind the light (`perspective`), or along its emission
//! (`parallel`), for comparison; `near`: what lies before the first slice is found by short `rays` to the middle of each part of the light, or
//! ignored, and that slice fades in (`fade`), as published; `repair_leaks`: every slice is also written into the next one.
//!
//! **Where slices lie.** The centre of projection stands as far behind the light as the frustum through its border holds all receivers. Texels
//! and planes, even in depth, are fitted to the triangles that can hide anything: those whose plane parts the light from some receiver. A floor under everything is none of
//! them, so receivers on it see all slices.
//!
//! **When it is wrong.** A caster is moved to the far plane of its slice: shadows of what is near are off by its thickness, and with
//! `fade` a receiver misses what hides it within its own slice. n slices that hide the same x of a part of the light
//! let xⁿ pass where x is right. Surfaces seen from the side (walls under the light) vanish, whatever the number of slices; the
//! result's notes say how much of the casters that is. Shadows are off by up to a texel. Semi-opaque triangles are taken for opaque, and every result says so.
//! Discs, polygons and suns are boxes with the same area, centre and variance as their parts; a sphere is the disc that a receiver sees, stretched along the axes of one frame.
//!
//! **Sources.** Eisemann and Décoret 2008, "Occlusion Textures for Plausible Soft Shadows"; Crow 1984 for summed-area tables. Parts of the light are ours.

mod frame;
mod light_parts;
mod settings;
mod tables;

use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};
use softshadow_scene::Light;

pub use frame::{CasterRange, LayerFrame};
pub use light_parts::LightParts;
use settings::NEAR_BYTES;
pub use settings::{Combine, Filter, Near, OcclusionLayers, Projection};
pub use tables::{CASTER_BOUNDS, CASTER_BOUNDS_BYTES, LAYER_PLACES_BYTES, LevelRange, edge_on_share};

use crate::TechniqueError;
use crate::parts::VISIBILITY;
use crate::parts::light_buffers::LightRecord;
use crate::parts::{receivers, scene_buffers, seen_values};
use crate::request::Request;

const LOOK_UP: Kernel = Kernel { file: "occlusion_layers/look_up.wgsl", entry: "look_up" };
const LOOK_UP_BEYOND: Kernel = Kernel { file: "occlusion_layers/look_up.wgsl", entry: "look_up_beyond" };
const TRACE_NEAR: Kernel = Kernel { file: "occlusion_layers/look_up.wgsl", entry: "trace_near" };

/// Rays of one invocation of `trace_near`.
const RAYS: u32 = 8;
/// Label of how many runs of short rays were traced, and how many rays a driver cut short.
pub const NEAR_COUNTS: &str = "near counts";

/// Slices, tables, then a lookup a receiver.
pub(crate) fn plan(request: &Request<'_>, settings: &OcclusionLayers) -> Plan {
    let mut plan = Plan::new("occlusion layers");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = plan.parameter("light", size_of::<LightRecord>() as u64);
    let frame = plan.parameter("layer frame", tables::FRAME_BYTES);
    let layers = tables::append(&mut plan, request, settings, frame);
    let parts = plan.parameter("light parts", size_of::<LightParts>() as u64);
    let visibility = plan.persistent(VISIBILITY, count as u64 * 4 * u64::from(request.channels));
    let near = (settings.near == Near::Rays && !request.scene.local.sub_scenes.is_empty())
        .then(|| append_near(&mut plan, request, settings, [light, frame, parts, receivers, layers.places]));
    // A lookup is sixteen loads: a fourth of a ray at most.
    let lookups = settings.split * settings.split * settings.slices;
    let over = Over::Items { count: count as u32, work_per_item: lookups.div_ceil(4) };
    let kernel = if near.is_some() { LOOK_UP_BEYOND } else { LOOK_UP };
    let pass = plan.compute("look up", "puts the slices before each receiver together", kernel, over);
    pass.bind("light", light)
        .bind("layer_frame", frame)
        .bind("light_parts", parts)
        .bind("receivers", receivers)
        .bind("layer_places", layers.places)
        .bind("layer_tables", layers.layer_tables)
        .bind("visibility", visibility);
    if let Some(near) = near {
        pass.bind("near_blocked", near);
    }
    seen_values::append(&mut plan, request, receivers, light, visibility);
    plan
}

/// The bits of parts of the light that something hides before the first slice, and how many rays were traced for them.
fn append_near(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &OcclusionLayers,
    [light, frame, parts, receivers, places]: [ResourceId; 5],
) -> ResourceId {
    let corners = scene_buffers::append_corners(plan, request.scene);
    let nodes = scene_buffers::append_nodes(plan, request.scene);
    let count = request.block.count as u32;
    let blocked = plan.buffer("near blocked", u64::from(count) * NEAR_BYTES);
    plan.clear("nothing near", "no part of the light is hidden at first", blocked);
    let counts = plan.buffer(NEAR_COUNTS, 8);
    plan.clear("no near rays", "counts begin at nothing", counts);
    let runs = light_parts::part_count(request.light, settings).div_ceil(RAYS);
    let over = Over::Items { count: count * runs, work_per_item: RAYS };
    for (index, (corners, nodes)) in corners.into_iter().zip(nodes).enumerate() {
        let why = "finds what hides parts of the light before the first slice";
        plan.compute(format!("trace near {index}"), why, TRACE_NEAR, over)
            .bind("light", light)
            .bind("layer_frame", frame)
            .bind("light_parts", parts)
            .bind("receivers", receivers)
            .bind("layer_places", places)
            .bind("nodes", nodes)
            .bind("corners", corners)
            .bind("near_blocked", blocked)
            .bind("near_counts", counts);
    }
    plan.outputs.push(counts);
    blocked
}

/// The values of the plan's parameters for one light.
pub(crate) fn values(
    request: &Request<'_>,
    settings: &OcclusionLayers,
    light: &Light,
) -> Result<Values, TechniqueError> {
    let mut values = seen_values::values(request, light)?;
    let axes = frame::LightAxes::new(request, light);
    values.insert("layer frame".into(), bytemuck::bytes_of(&axes.record(settings)).to_vec());
    if tables::are_made(request) {
        let range = axes.range(request, settings)?;
        values.insert("caster range".into(), bytemuck::bytes_of(&range).to_vec());
        tables::level_values(settings, &mut values);
    }
    let parts = LightParts::new(light, &axes, settings, request.channels);
    values.insert("light parts".into(), bytemuck::bytes_of(&parts).to_vec());
    Ok(values)
}
