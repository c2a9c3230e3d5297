//! Steps that techniques share.

pub mod interleaving;
pub mod light_buffers;
pub mod light_silhouettes;
pub mod occluder_buffers;
pub mod opacity;
pub(crate) mod pattern_name;
pub mod receivers;
pub mod resolve;
pub mod scene_buffers;
pub(crate) mod seen_values;
pub mod shading;
pub mod shadow_views;
pub(crate) mod spread;

/// Label of the buffer in which every technique leaves its values.
pub const VISIBILITY: &str = "visibility";
