//! Twins against their WGSL: the same programs on Mesa's software driver and natively, compared buffer by buffer.

mod covered;
mod harness;
mod lists;
mod ray_traced;
mod receivers;
