//! What passes triangles, as the kernels read it: one number a triangle, and only for scenes in which some are semi-opaque.

use softshadow_plan::{Content, Kernel, Over, Plan, ResourceId};
use softshadow_scene::LocalScene;
use softshadow_scene::occluders::{OPAQUE, attenuation};

use crate::request::Request;

/// Label of what passes to each sample of each receiver.
pub const SAMPLE_TRANSMITTANCE: &str = "sample transmittance";
/// Label of what passes each triangle.
pub const TRIANGLE_TRANSMITTANCE: &str = "triangle transmittance";

/// Units of attenuation in all of the light, where opacities are added up as they are.
pub const UNITS_PER_WHOLE: f64 = 65_536.0;

const OPEN_SAMPLES: Kernel = Kernel { file: "resolve/open_samples.wgsl", entry: "open_samples" };

/// The opacities of a scene's triangles in the forms that techniques ask for.
#[derive(Debug, Clone)]
pub struct OpacityContents {
    /// The share that passes, in float32.
    pub transmittances: Content,
    /// Units of attenuation of which 4,096 halve the light; [`OPAQUE`] where nothing passes.
    pub halvings: Content,
    /// Units of which [`UNITS_PER_WHOLE`] are all of the light; [`OPAQUE`] where nothing passes.
    pub shares: Content,
}

impl OpacityContents {
    /// `None` where every triangle is opaque.
    #[must_use]
    pub fn new(local: &LocalScene) -> Option<Self> {
        let opacities = &local.opacities;
        let share = |opacity: f32| match opacity {
            1.0.. => OPAQUE,
            _ => (f64::from(opacity) * UNITS_PER_WHOLE).round() as u32,
        };
        let transmittances: Vec<f32> = opacities.iter().map(|opacity| 1.0 - opacity).collect();
        let halvings: Vec<u32> = opacities.iter().map(|opacity| attenuation(*opacity)).collect();
        let shares: Vec<u32> = opacities.iter().map(|opacity| share(*opacity)).collect();
        (!opacities.is_empty()).then(|| Self {
            transmittances: Content::new(bytemuck::cast_slice(&transmittances)),
            halvings: Content::new(bytemuck::cast_slice(&halvings)),
            shares: Content::new(bytemuck::cast_slice(&shares)),
        })
    }

    /// All contents, for an engine to upload by key.
    pub fn contents(&self) -> impl Iterator<Item = &Content> {
        [&self.transmittances, &self.halvings, &self.shares].into_iter()
    }
}

/// Bytes of what passes to the samples of one receiver.
#[must_use]
pub fn bytes_per_receiver(samples: u32) -> u64 {
    u64::from(samples) * 4
}

/// Adds what passes to each sample, and the pass that opens it with masks.
pub fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    samples: u32,
    sampling: ResourceId,
    blocked: ResourceId,
) -> ResourceId {
    let count = request.block.count;
    let transmittance = plan.buffer(SAMPLE_TRANSMITTANCE, count as u64 * bytes_per_receiver(samples));
    let over = Over::Items { count: count as u32, work_per_item: samples / 8 + 1 };
    plan.compute("open samples", "lets all light pass to samples that are not blocked", OPEN_SAMPLES, over)
        .bind("sampling", sampling)
        .bind("blocked", blocked)
        .bind("sample_transmittance", transmittance);
    transmittance
}
