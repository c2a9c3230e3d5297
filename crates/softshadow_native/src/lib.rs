//! Kernels on CPU threads: what the shaders of a technique compute, in Rust, without any driver.

pub mod depth_complexity;
