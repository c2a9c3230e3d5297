//! Steps that techniques share.

pub mod light_buffers;
pub mod receivers;
pub mod scene_buffers;
pub mod shading;
