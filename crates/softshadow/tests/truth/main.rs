//! The front door against what is true: closed forms, exact unions, a float64 tracer on the same samples, invariances,
//! contact, backends, lights, blocks and bad input. One binary, so that wgpu is linked once.
//!
//! Every comparator here is also shown something spoilt, which it has to refuse. Measured figures are printed: run with
//! `--nocapture` to read them.
#![allow(clippy::print_stdout, reason = "the figures that are measured are part of what these tests say")]

mod agreement;
mod backends;
mod bad_input;
mod blended;
mod blocks;
mod choose;
mod closed_forms;
mod common;
mod contact;
mod coverage;
mod depth_complexity;
mod direct_illumination;
mod equation_6;
mod filtered;
mod hard_cases;
mod hard_shadows;
mod interleaved;
mod invariance;
mod lights;
mod moving;
mod occlusion_camera;
mod occlusion_layers;
mod occlusion_layers_hard;
mod penumbra_maps;
mod pixels;
mod same_samples;
mod samples;
mod semi_opaque;
mod semi_opaque_samples;
mod shapes;
mod soups;
mod sphere_lights;
mod spreads;
mod sub_scenes;
mod watertight;
