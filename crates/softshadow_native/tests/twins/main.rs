//! Twins against their WGSL: the same programs on Mesa's software driver and natively, compared buffer by buffer.

mod complete;
mod covered;
mod fold;
mod harness;
mod lists;
mod occlusion_layers;
mod one_kernel;
mod ray_traced;
mod receivers;
mod resolve;
mod shading;
mod whole;
