//! Shadow techniques, one file a published method, each a function from a request to a plan.
//!
//! A technique never names a device and never imports another; what two share lives in [`parts`].

mod block;
pub mod depth_complexity;
pub mod hard_shadow_map;
pub mod occlusion_camera;
pub mod occlusion_layers;
pub mod parts;
pub mod penumbra_map;
mod program;
pub mod ray_traced;
mod request;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use softshadow_plan::{Host, Plan, Values};
use softshadow_scene::{Light, LightSamples, LightSampling, SampleSpread, SceneError};

pub use block::{Block, blocks};
pub use depth_complexity::{Attenuation, DepthComplexity};
pub use hard_shadow_map::HardShadowMap;
pub use occlusion_camera::{CameraRamp, OcclusionCamera};
pub use occlusion_layers::OcclusionLayers;
pub use parts::occluder_buffers::OccluderContents;
pub use parts::scene_buffers::SceneContents;
pub use parts::shading::Shading;
use parts::spread;
pub use penumbra_map::PenumbraMap;
pub use program::{StageTask, VisibilityProgram};
pub use ray_traced::RayTraced;
pub use request::{ReceiverSource, Request, Wants};

/// Every technique there is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Technique {
    /// Shadow rays to light samples: the reference on the GPU.
    RayTraced(RayTraced),
    /// One depth map from the light's centre: what softness is compared with.
    HardShadowMap(HardShadowMap),
    /// A shadow map, and beside it the penumbra of what it shows: fast, and too dark.
    PenumbraMap(PenumbraMap),
    /// Penumbrae from one camera at the light's centre, whose rays bend around silhouettes.
    OcclusionCamera(OcclusionCamera),
    /// Slices of the scene, prefiltered: plausible, at a cost that hardly depends on scene and light.
    OcclusionLayers(OcclusionLayers),
    /// Silhouette edges and counters: as accurate as rays to the same samples.
    DepthComplexity(DepthComplexity),
}

/// A setting out of range, or a request that a technique cannot serve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TechniqueError {
    /// A setting that has no meaning.
    #[error("{technique} {setting}: {reason}")]
    Setting {
        /// The technique's name.
        technique: &'static str,
        /// The setting's name.
        setting: &'static str,
        /// Why it cannot be, and what can.
        reason: String,
    },
    /// The light's samples cannot be made.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Technique {
    /// Every technique with its default settings.
    #[must_use]
    pub fn defaults() -> Vec<Self> {
        vec![
            Self::RayTraced(RayTraced::default()),
            Self::HardShadowMap(HardShadowMap::default()),
            Self::PenumbraMap(PenumbraMap::default()),
            Self::OcclusionCamera(OcclusionCamera::default()),
            Self::DepthComplexity(DepthComplexity::default()),
            Self::OcclusionLayers(OcclusionLayers::default()),
        ]
    }

    /// Settings in rising quality, of which a search for the cheapest that is good enough takes one; empty where more effort does not
    /// lead to the truth.
    #[must_use]
    pub fn rising_quality(&self) -> Vec<Self> {
        match self {
            Self::RayTraced(settings) => settings.rising_quality().map(Self::RayTraced).collect(),
            Self::DepthComplexity(settings) => settings.rising_quality().map(Self::DepthComplexity).collect(),
            Self::HardShadowMap(_) | Self::OcclusionLayers(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) => {
                Vec::new()
            }
        }
    }

    /// The root mean square error in penumbrae that its samples lead to expect, where nothing else makes it wrong. It has to be measured
    /// for all others.
    #[must_use]
    pub fn expected_error(&self) -> Option<f64> {
        match self {
            Self::RayTraced(_) | Self::DepthComplexity(_) => {
                Some(spread::expected_error(self.samples(), self.passes()))
            }
            Self::HardShadowMap(_) | Self::OcclusionLayers(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) => None,
        }
    }

    /// The name by which settings files and the command line know it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::RayTraced(_) => "ray_traced",
            Self::HardShadowMap(_) => "hard_shadow_map",
            Self::PenumbraMap(_) => "penumbra_map",
            Self::OcclusionCamera(_) => "occlusion_camera",
            Self::OcclusionLayers(_) => "occlusion_layers",
            Self::DepthComplexity(_) => "depth_complexity",
        }
    }

    /// Whether it works on silhouette edges, and wants to know what hides each light.
    #[must_use]
    pub fn wants_occluders(&self) -> bool {
        matches!(self, Self::PenumbraMap(_) | Self::OcclusionCamera(_) | Self::DepthComplexity(_))
    }

    /// Checks the settings.
    ///
    /// # Errors
    /// [`TechniqueError::Setting`] names the first one out of range.
    pub fn check(&self) -> Result<(), TechniqueError> {
        match self {
            Self::RayTraced(settings) => settings.check(),
            Self::HardShadowMap(settings) => settings.check(),
            Self::PenumbraMap(settings) => settings.check(),
            Self::OcclusionCamera(settings) => settings.check(),
            Self::OcclusionLayers(settings) => settings.check(),
            Self::DepthComplexity(settings) => settings.check(),
        }
    }

    /// Whether it needs a host that draws triangles.
    #[must_use]
    pub fn draws(&self) -> bool {
        match self {
            Self::RayTraced(_) | Self::OcclusionLayers(_) => false,
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) => true,
            Self::DepthComplexity(settings) => settings.evaluation == depth_complexity::Evaluation::Blended,
        }
    }

    /// Checks whether the settings can serve such receivers and lights on such a host.
    ///
    /// # Errors
    /// [`TechniqueError::Setting`] names the setting, and one that can.
    pub fn check_call(
        &self,
        receivers: ReceiverSource<'_>,
        lights: &[Light],
        host: &Host,
    ) -> Result<(), TechniqueError> {
        spread::check_receivers(self.name(), self.interleaves(), receivers)?;
        if self.draws() && !host.features.raster {
            let reason = "it draws triangles, which this one does not; use 'gpu' or 'software'".to_owned();
            return Err(TechniqueError::Setting { technique: self.name(), setting: "device", reason });
        }
        match self {
            Self::PenumbraMap(settings) => settings.check_call(lights),
            Self::OcclusionCamera(settings) => settings.check_call(lights, host),
            Self::DepthComplexity(settings) => settings.check_call(receivers, lights, host),
            Self::OcclusionLayers(settings) => settings.check_call(host),
            Self::RayTraced(_) | Self::HardShadowMap(_) => Ok(()),
        }
    }

    /// Checks whether the settings can serve such a scene.
    ///
    /// # Errors
    /// [`TechniqueError::Setting`] names the setting, and one that can.
    pub fn check_scene(&self, scene: &SceneContents) -> Result<(), TechniqueError> {
        match self {
            Self::DepthComplexity(settings) => settings.check_scene(scene),
            Self::RayTraced(_)
            | Self::HardShadowMap(_)
            | Self::PenumbraMap(_)
            | Self::OcclusionCamera(_)
            | Self::OcclusionLayers(_) => Ok(()),
        }
    }

    /// Checks whether the settings can serve what hides the lights.
    ///
    /// # Errors
    /// [`TechniqueError::Setting`] names the setting, and one that can.
    pub fn check_occluders(&self, occluders: &[Arc<OccluderContents>]) -> Result<(), TechniqueError> {
        match self {
            Self::DepthComplexity(settings) => settings.check_occluders(occluders),
            Self::OcclusionCamera(settings) => settings.check_occluders(occluders.iter().map(Arc::as_ref)),
            Self::RayTraced(_) | Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionLayers(_) => Ok(()),
        }
    }

    /// Checks whether a request's light can be served.
    ///
    /// # Errors
    /// [`TechniqueError`] says why not.
    pub fn check_light(&self, request: &Request<'_>) -> Result<(), TechniqueError> {
        let (light, frame) = (request.light, &request.scene.local.frame);
        let has_samples = |sampling: &LightSampling| Ok(LightSamples::new(light, frame, sampling).map(drop)?);
        match self {
            Self::RayTraced(settings) => has_samples(&settings.sampling(0)),
            Self::DepthComplexity(settings) => has_samples(&settings.sampling(0)),
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) => Ok(()),
            Self::OcclusionLayers(settings) => occlusion_layers::values(request, settings, light).map(drop),
        }
    }

    /// Whether pixels are averaged with their neighbours.
    #[must_use]
    pub fn interleaves(&self) -> bool {
        match self {
            Self::RayTraced(settings) => settings.spread == SampleSpread::Interleaved,
            Self::DepthComplexity(settings) => settings.spread == SampleSpread::Interleaved,
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) | Self::OcclusionLayers(_) => {
                false
            }
        }
    }

    /// Stages that one pass takes: more than one where a stage is chosen by what the one before found.
    #[must_use]
    pub fn stages(&self) -> u32 {
        match self {
            Self::DepthComplexity(settings) => settings.stages(),
            Self::RayTraced(_)
            | Self::HardShadowMap(_)
            | Self::PenumbraMap(_)
            | Self::OcclusionCamera(_)
            | Self::OcclusionLayers(_) => 1,
        }
    }

    /// Progressive passes that one light takes.
    #[must_use]
    pub fn passes(&self) -> u32 {
        match self {
            Self::RayTraced(settings) => settings.passes,
            Self::DepthComplexity(settings) => settings.passes,
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) | Self::OcclusionLayers(_) => 1,
        }
    }

    /// Light samples that one receiver asks for in one pass.
    #[must_use]
    pub fn samples(&self) -> u32 {
        match self {
            Self::RayTraced(settings) => settings.samples,
            Self::DepthComplexity(settings) => settings.samples,
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) | Self::OcclusionLayers(_) => 1,
        }
    }

    /// Rows of an image beyond a block that its results depend on.
    #[must_use]
    pub fn halo_rows(&self) -> u32 {
        match self {
            Self::RayTraced(settings) => settings.halo_rows(),
            Self::DepthComplexity(settings) => settings.halo_rows(),
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) | Self::OcclusionLayers(_) => 0,
        }
    }

    /// Bytes on the device that one receiver takes, beyond the receiver itself, in a scene of so many sub-scenes, with or without
    /// semi-opaque triangles.
    #[must_use]
    pub fn bytes_per_receiver(&self, channels: u64, sub_scenes: u64, is_semi_opaque: bool) -> u64 {
        match self {
            Self::RayTraced(settings) => settings.bytes_per_receiver(channels, sub_scenes, is_semi_opaque),
            Self::HardShadowMap(_) | Self::PenumbraMap(_) | Self::OcclusionCamera(_) => 4 * channels,
            Self::OcclusionLayers(settings) => settings.bytes_per_receiver(channels),
            Self::DepthComplexity(settings) => settings.bytes_per_receiver(channels, is_semi_opaque),
        }
    }

    /// The plan for one light and one block of receivers.
    #[must_use]
    pub fn plan(&self, request: &Request<'_>) -> Plan {
        match self {
            Self::RayTraced(settings) => ray_traced::plan(request, settings),
            Self::HardShadowMap(settings) => hard_shadow_map::plan(request, settings),
            Self::PenumbraMap(settings) => penumbra_map::plan(request, settings),
            Self::OcclusionCamera(settings) => occlusion_camera::plan(request, settings),
            Self::OcclusionLayers(settings) => occlusion_layers::plan(request, settings),
            Self::DepthComplexity(settings) => depth_complexity::plan(request, settings),
        }
    }

    /// The values of that plan's parameters for one progressive pass.
    ///
    /// # Errors
    /// [`TechniqueError`] when the light's samples cannot be made.
    pub fn values(&self, request: &Request<'_>, light: &Light, pass: u32) -> Result<Values, TechniqueError> {
        match self {
            Self::RayTraced(settings) => ray_traced::values(request, settings, light, pass),
            Self::HardShadowMap(settings) => hard_shadow_map::values(request, settings, light),
            Self::PenumbraMap(settings) => penumbra_map::values(request, settings, light),
            Self::OcclusionCamera(settings) => occlusion_camera::values(request, settings, light),
            Self::OcclusionLayers(settings) => occlusion_layers::values(request, settings, light),
            Self::DepthComplexity(settings) => depth_complexity::values(request, settings, light, pass),
        }
    }
}
