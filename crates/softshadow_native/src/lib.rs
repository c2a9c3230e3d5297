//! Runs plans on CPU threads with SIMD, without any driver.
//!
//! [`NativeEngine`] is the interpreter; a pass runs on the *twin* of its kernel: a Rust function of the same name, that reads and
//! writes the same buffers in the same layout. What a plan computes is said once, in the plan; how a kernel computes it is said twice, and
//! tests compare both buffer by buffer.
//!
//! [`depth_complexity`] is the scalar form of the silhouette predicates that both are judged by.

pub mod depth_complexity;
mod engine;
mod kernels;

pub use engine::{NativeEngine, NativeSettings, Vectors};
pub use kernels::has_twin;
