//! Runs plans on wgpu, and is the only crate that knows it: adapters, pipelines, resources, upload, readback, timing, errors.
//!
//! The engine knows no technique: it looks kernels up by name and does what the passes say, in order.

mod adapter;
mod encode;
mod error;
mod pipelines;
mod pool;
mod run;
mod timing;

pub use adapter::{AdapterChoice, adapters};
pub use run::WgpuEngine;
