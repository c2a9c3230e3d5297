//! The oracles judge each other, and every check is shown to fail on a spoilt input.
//!
//! One binary of many files: they share the meshes and the generator of random numbers.

#![expect(clippy::print_stdout, reason = "the measured figures, shown by --nocapture")]

mod bounds;
mod closed_forms;
mod exact_union;
mod kernel32;
mod metrics;
mod planted;
mod random;
mod rays_exact;
mod rays_far;
mod rays_float32;
mod sampling;
mod shapes;
