//! The last step of sampled techniques: masks become visibility and its standard error, and results leave.

use softshadow_plan::{Kernel, Over, Plan, ResourceId};
use softshadow_scene::{LightSampling, SampleSpread};

use crate::parts::VISIBILITY;
use crate::parts::interleaving::{self, Averaged};
use crate::parts::light_buffers::{self, LightBuffers};
use crate::parts::shading::{self, Seen};
use crate::request::Request;

/// Label of the standard errors.
pub const STANDARD_ERROR: &str = "standard error";
/// Label of the masks of blocked samples.
pub const BLOCKED: &str = "blocked samples";

const fn kernel(entry: &'static str) -> Kernel {
    Kernel { file: "resolve/resolve.wgsl", entry }
}

const RESOLVE: Kernel = kernel("resolve");
const RESOLVE_TEXTURED: Kernel = kernel("resolve_textured");
const RESOLVE_AREAS: Kernel = kernel("resolve_areas");
const RESOLVE_ATTENUATED: Kernel = kernel("resolve_attenuated");
const RESOLVE_ATTENUATED_TEXTURED: Kernel = kernel("resolve_attenuated_textured");
const KEEP_SAMPLES: Kernel = kernel("keep_samples");
const KEEP_TEXTURED: Kernel = kernel("keep_textured");
const KEEP_AREAS: Kernel = kernel("keep_areas");
const KEEP_ATTENUATED: Kernel = kernel("keep_attenuated");
const KEEP_ATTENUATED_TEXTURED: Kernel = kernel("keep_attenuated_textured");
const MASK_SAMPLES: Kernel = Kernel { file: "resolve/mask_samples.wgsl", entry: "mask_samples" };

/// What a technique found out about its samples.
#[derive(Debug, Clone, Copy)]
pub struct Masks {
    /// Words of blocked samples.
    pub blocked: ResourceId,
    /// For how many samples each mask speaks; 0 for all of them.
    pub decided: ResourceId,
    /// Visible share of the light's area where that is known, else negative.
    pub areas: Option<ResourceId>,
    /// What passes to each sample, where that may be a part of the light; else the masks say all.
    pub transmittance: Option<ResourceId>,
}

/// What turns masks, or what passes to samples, into values, kept where they are averaged.
fn kernel_for(masks: &Masks, by_area: bool, textured: bool, averaged: bool) -> Kernel {
    let [result, kept] = match (masks.transmittance, textured) {
        (Some(_), false) => [RESOLVE_ATTENUATED, KEEP_ATTENUATED],
        (Some(_), true) => [RESOLVE_ATTENUATED_TEXTURED, KEEP_ATTENUATED_TEXTURED],
        (None, true) => [RESOLVE_TEXTURED, KEEP_TEXTURED],
        (None, false) if by_area => [RESOLVE_AREAS, KEEP_AREAS],
        (None, false) => [RESOLVE, KEEP_SAMPLES],
    };
    if averaged { kept } else { result }
}

/// Adds the passes from masks to results, and the picture where one is wanted.
pub fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    sampling: &LightSampling,
    light: &LightBuffers,
    receivers: ResourceId,
    masks: Masks,
) {
    let bytes = request.block.count as u64 * 4 * u64::from(request.channels);
    let visibility = plan.persistent(VISIBILITY, bytes);
    let standard_error = plan.persistent(STANDARD_ERROR, bytes);
    let textured = request.channels == 3;
    let over = Over::Items { count: request.block.count as u32, work_per_item: sampling.count.div_ceil(32) };
    let radiance = textured.then(|| light_buffers::append_radiance(plan, sampling.total()));
    // A texture's light is in its samples, not in its area.
    let areas = masks.areas.filter(|_| !textured);
    let averaged = (sampling.spread == SampleSpread::Interleaved).then(|| interleaving::pass_values(plan, request));
    let kernel = kernel_for(&masks, areas.is_some(), textured, averaged.is_some());
    let why = match averaged {
        None => "turns masks into visibility and its standard error",
        Some(_) => "turns masks into what each pixel sees alone",
    };
    let pass = plan.compute("resolve", why, kernel, over);
    pass.bind("sampling", light.sampling);
    match masks.transmittance {
        Some(transmittance) => pass.bind("sample_transmittance", transmittance),
        None => pass.bind("blocked", masks.blocked),
    };
    match averaged {
        None => pass.bind("visibility", visibility).bind("standard_error", standard_error),
        Some(pass_values) => pass.bind("pass_values", pass_values),
    };
    match areas {
        Some(areas) => pass.bind("areas", areas),
        None => pass.bind("decided", masks.decided),
    };
    if let Some(radiance) = radiance {
        pass.bind("sample_radiance", radiance);
    }
    if let Some(pass_values) = averaged {
        let averaged = Averaged { sampling: light.sampling, receivers, pass_values, visibility, standard_error };
        interleaving::append(plan, request, sampling.tile, &averaged);
    }
    match request.wants.picture {
        None => {}
        Some(shading::Shading::Integrated) => {
            let decided = masks.decided;
            let seen = match masks.transmittance {
                Some(transmittance) => Seen::Transmittance { transmittance, decided },
                None => Seen::Masks { blocked: masks.blocked, decided },
            };
            shading::append(plan, request, receivers, light, seen, sampling);
        }
        // The visibility is known after the last pass only.
        Some(shading::Shading::Modulated) if !request.closes_light => {}
        Some(shading::Shading::Modulated) => {
            shading::append(plan, request, receivers, light, Seen::Values(visibility), sampling);
        }
    }
    if let Some(transmittance) = masks.transmittance.filter(|_| request.closes_light && request.wants.sample_masks) {
        plan.compute("mask samples", "marks the samples to which nothing passes", MASK_SAMPLES, over)
            .bind("sampling", light.sampling)
            .bind("sample_transmittance", transmittance)
            .bind("blocked", masks.blocked);
    }
    if request.closes_light {
        plan.outputs.push(visibility);
        plan.outputs.extend(request.wants.standard_error.then_some(standard_error));
        plan.outputs.extend(request.wants.sample_masks.then_some(masks.blocked));
    }
    // Everybody needs to know which pixels see anything, and that stands in the receivers.
    plan.outputs.extend(request.opens_block.then_some(receivers));
}
