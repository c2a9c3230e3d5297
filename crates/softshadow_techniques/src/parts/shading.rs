//! The picture: direct light on the receivers' materials, added up over lights and passes.

use serde::{Deserialize, Serialize};
use softshadow_plan::{Content, Kernel, Over, Plan, ResourceId, Values};
use softshadow_scene::{LightSampling, Material, SampleSpread};

use crate::parts::interleaving;
use crate::parts::light_buffers::{self, LightBuffers};
use crate::request::{ReceiverSource, Request};

/// How visibility and direct light are put together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shading {
    /// Every light sample with its own visibility (Forest et al., equation 6); exact areas do not enter. Techniques without samples are
    /// modulated.
    #[default]
    Integrated,
    /// The light without shadow, times the visibility (Forest et al., equation 3).
    Modulated,
}

/// Label of the colour buffer.
pub const COLOR: &str = "color";

const INTEGRATED: Kernel = Kernel { file: "shading/shade.wgsl", entry: "integrated" };
const INTEGRATED_ATTENUATED: Kernel = Kernel { file: "shading/shade.wgsl", entry: "integrated_attenuated" };
const MODULATED: Kernel = Kernel { file: "shading/shade.wgsl", entry: "modulated" };

/// `Material` of `shade.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MaterialRecord {
    base_color: [f32; 3],
    specular: f32,
    exponent: f32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

/// `Shading` of `shade.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ShadingRecord {
    eye: [f32; 3],
    adds: u32,
    weight: f32,
    channels: u32,
    reserved0: u32,
    reserved1: u32,
}

/// Where a technique's visibility is found when the picture is made.
#[derive(Debug, Clone, Copy)]
pub enum Seen {
    /// Masks of blocked samples, and how many samples each speaks for.
    Masks {
        /// Words of bits.
        blocked: ResourceId,
        /// Samples decided for each receiver.
        decided: ResourceId,
    },
    /// What passes to each sample, and how many samples speak for all.
    Transmittance {
        /// One share a sample.
        transmittance: ResourceId,
        /// Samples decided for each receiver.
        decided: ResourceId,
    },
    /// One value a channel.
    Values(ResourceId),
}

/// Materials as the kernels read them; one default material where there is no mesh.
#[must_use]
pub fn material_content(materials: &[Material]) -> Content {
    let record = |m: &Material| {
        // Blinn's exponent for a glTF roughness r: 2/α² − 2 with α = r².
        let alpha = (m.roughness * m.roughness).clamp(0.02, 1.0);
        MaterialRecord {
            base_color: m.base_color,
            specular: m.specular,
            exponent: 2.0 / (alpha * alpha) - 2.0,
            ..bytemuck::Zeroable::zeroed()
        }
    };
    let mut records: Vec<MaterialRecord> = materials.iter().map(record).collect();
    if records.is_empty() {
        records.push(record(&Material::default()));
    }
    Content::new(bytemuck::cast_slice(&records))
}

/// Adds the pass that adds this light's colour, and makes the colour an output where the block ends.
pub fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    receivers: ResourceId,
    light: &LightBuffers,
    seen: Seen,
    sampling: &LightSampling,
) {
    let radiance =
        plan.find("sample radiance").unwrap_or_else(|| light_buffers::append_radiance(plan, sampling.total()));
    let shading = plan.parameter("shading", size_of::<ShadingRecord>() as u64);
    let triangle_materials = plan.uploaded("triangle materials", &request.scene.triangle_materials);
    let materials = plan.uploaded("materials", &request.scene.materials);
    // A final visibility is averaged already.
    let is_noisy = sampling.spread == SampleSpread::Interleaved && !matches!(seen, Seen::Values(_));
    let added = match is_noisy {
        true => interleaving::noisy_color(plan, request),
        false => plan.persistent(COLOR, request.block.count as u64 * 16),
    };
    let over = Over::Items { count: request.block.count as u32, work_per_item: sampling.count / 8 + 1 };
    let (kernel, why) = match seen {
        Seen::Masks { .. } => (INTEGRATED, "adds the light of every sample that is not blocked"),
        Seen::Transmittance { .. } => (INTEGRATED_ATTENUATED, "adds the light that passes to every sample"),
        Seen::Values(_) => (MODULATED, "adds the light without shadow, times the visibility"),
    };
    let pass = plan.compute("shade", why, kernel, over);
    pass.bind("light", light.light)
        .bind("sampling", light.sampling)
        .bind("shading", shading)
        .bind("receivers", receivers)
        .bind("light_samples", light.samples)
        .bind("sample_radiance", radiance)
        .bind("triangle_materials", triangle_materials)
        .bind("materials", materials)
        .bind("color", added);
    match seen {
        Seen::Masks { blocked, decided } => pass.bind("blocked", blocked).bind("decided", decided),
        Seen::Transmittance { transmittance, decided } => {
            pass.bind("sample_transmittance", transmittance).bind("decided", decided)
        }
        Seen::Values(visibility) => pass.bind("visibility", visibility),
    };
    if !request.closes_block {
        return;
    }
    if is_noisy {
        let color = plan.persistent(COLOR, request.block.count as u64 * 16);
        interleaving::append_colors(plan, request, sampling.tile, [receivers, triangle_materials, added, color]);
        plan.outputs.push(color);
    } else {
        plan.outputs.push(added);
    }
}

/// The value of the parameter that [`append`] added. Light with samples' own visibility is added in every one of `passes`; light
/// times a final visibility once.
pub fn values(request: &Request<'_>, passes: u32, values: &mut Values) {
    let eye = match request.receivers {
        ReceiverSource::Camera(camera) => camera.local(&request.scene.local.frame).eye.as_vec3().to_array(),
        ReceiverSource::Points(_) => [0.0; 3],
    };
    let (begins, weight) = match request.wants.picture {
        Some(Shading::Modulated) => (request.first_light, 1.0),
        _ => (request.opens_block, 1.0 / passes as f32),
    };
    let record =
        ShadingRecord { eye, adds: u32::from(!begins), weight, channels: request.channels, reserved0: 0, reserved1: 0 };
    values.insert("shading".into(), bytemuck::bytes_of(&record).to_vec());
}
