//! Soft shadows from area lights, as numbers and as pictures.
//!
//! ```no_run
//! use softshadow::{Camera, Context, DeviceChoice, Light, LightShape, Options, Receivers, Technique, look_at};
//!
//! let scene = softshadow::scene_file::load("bunny.glb".as_ref())?;
//! let pose = look_at([1.5, 3.5, 1.0], [0.0, 0.3, 0.0], None)?;
//! let light = Light::new(LightShape::Rectangle { width: 1.0, height: 1.0 }, pose)?;
//! let camera = Camera::look_at([2.2, 1.9, 3.0], [0.0, 0.4, 0.0], None, 40.0, [512, 512])?;
//! let context = Context::new(&DeviceChoice::Auto)?;
//! let technique = Technique::RayTraced(Default::default());
//! let result = softshadow::visibility(
//!     &context, &scene, &[light], &Receivers::Camera(camera), &technique, &Options::default(), &mut |_, _| true,
//! )?;
//! println!("{} ms", result.info.wall_ms);
//! # Ok::<(), softshadow::Error>(())
//! ```

pub mod choose;
mod compare;
mod context;
pub mod drawing;
mod error;
mod foreign;
pub mod image_file;
mod info;
mod light_points;
mod render;
mod scene_cache;
mod visibility;

pub use choose::{BoundNotMet, Candidate, Choice, ErrorKind, Goal, Limit, visibility_within};
pub use compare::{ComparedLight, Comparison, ComparisonRow, compare};
pub use context::{Context, DeviceChoice, adapters};
pub use error::Error;
pub use foreign::{ForeignCall, ForeignDevice};
pub use info::{Info, Preparation};
pub use light_points::{LightPoints, light_points};
pub use render::{Picture, PictureOptions, render};
pub use softshadow_measure as measure;
pub use softshadow_plan as plan;
pub use softshadow_plan::{AdapterInfo, DeviceKind, PassTime, Timing};
pub use softshadow_scene::{
    Camera, Dropped, Light, LightSampling, LightShape, LightTexture, Material, Mesh, Points, Receivers, STRETCH_LIMIT,
    SamplePattern, SampleSpread, Scene, SceneError, UpAxis, look_at, procedural, scene_file,
};
pub use softshadow_techniques::depth_complexity::{
    Counters, Coverage, Evaluation, InitialCounts, OccluderUnit, Silhouettes,
};
pub use softshadow_techniques::occlusion_layers::{Combine, Filter, Near, Projection};
pub use softshadow_techniques::penumbra_map::Ramp;
pub use softshadow_techniques::{
    Attenuation, CameraRamp, DepthComplexity, HardShadowMap, OcclusionCamera, OcclusionLayers, PenumbraMap, RayTraced,
    Shading, Technique, TechniqueError,
};
pub use visibility::{Options, Placed, SampleMasks, Visibility, visibility};

/// Asked between pieces of work with what is done and what there is in all; returning `false` stops the call.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64) -> bool;
