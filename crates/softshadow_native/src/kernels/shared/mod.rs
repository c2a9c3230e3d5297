//! Twins of what two folders of kernels use, one file a file of `shaders_wgsl/shared/`.

pub(crate) mod hierarchy;
pub(crate) mod receiver;
pub(crate) mod samples;
pub(crate) mod triangle;
