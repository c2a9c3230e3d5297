//! What is lit: meshes, lights, cameras and receivers. Pure geometry in float64, no GPU and no shader.

pub mod edges;
pub mod occluders;
pub mod procedural;
pub mod scene_file;

mod bvh;
mod camera;
mod error;
mod frame;
mod light;
mod light_frame;
mod light_samples;
mod local;
mod mesh;
mod receivers;
mod sample_sets;
mod scene;

pub use bvh::{Bvh, BvhNode};
pub use camera::{Camera, LocalCamera};
pub use error::SceneError;
pub use frame::{LocalFrame, look_at};
pub use light::{Light, LightShape, LightTexture, LocalLight, UpAxis};
pub use light_frame::{LightFrame, LightKind, Outline};
pub use light_samples::{LightSamples, MAX_SAMPLES, SamplePattern, pass_seed, sample_positions, unit_square};
pub use local::{Corner, Dropped, LocalScene, SubScene, occluder_bounds};
pub use mesh::{MAX_TRIANGLES, Material, Mesh};
pub use receivers::{LocalPoint, Points, Receivers};
pub use sample_sets::{LightSampling, MAX_INTERLEAVED, SampleSpread};
pub use scene::Scene;
