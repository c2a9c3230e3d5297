//! Twins against their WGSL: the same programs on Mesa's software driver and natively, compared buffer by buffer.

mod fold;
mod harness;
mod lists;
mod receivers;
