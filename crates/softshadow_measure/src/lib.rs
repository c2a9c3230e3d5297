//! What is true about soft shadows, and how far an image is from it.
//!
//! Visibility V is the fraction of a light that a receiver sees: 1 is fully lit. The fraction is of the light's area, for
//! spherical lights of its solid angle; there is no cosine in it. Triangles are two-sided and block what lies strictly
//! behind them; light below the receiver's horizon counts as hidden, and so does everything for a receiver behind a
//! one-sided light.
//!
//! This crate imports nothing of ours: it shares no line with what it judges. Its parts judge each other in their tests.
//!
//! | truth | applies to | error | wrong when |
//! |---|---|---|---|
//! | [`half_plane_over_rectangle`], [`rectangle_over_rectangle`], [`disc_over_disc`] | one flat occluder parallel to the light | rounding | the occluder is not parallel, or there are two |
//! | [`sphere_over_rectangle`], [`sphere_over_sphere_light`] | one true sphere | about 1e-11 | the scene holds a tessellated sphere: its silhouette lies inside by about 1/n² |
//! | [`rectangle_visibility`] | any small mesh, rectangular light | about 1e-12 | the receiver lies exactly on a triangle it does not exclude (V jumps there) |
//! | [`RayReference`] | any mesh, given samples | exact up to the samples marked grazing | it is read as an area: n samples only know V to about n^-3/4 |
//! | [`OcclusionTracer`] | the same, many samples | none: the same float64 verdicts | receiver and sample lie in the plane of a triangle elsewhere; it marks nothing as grazing |
//! | [`grazing`] | a sample of a float32 kernel that looks at projected edges | says which differences rounding excuses | the receiver lies in the light's plane |
//! | [`converged_visibility`] | any mesh, any light | its own standard error | an umbra or a lit region is thinner than the strata: mean and spread can both miss it |
//!
//! [`compare`] turns two images into an [`ErrorReport`], [`bound_error`] receivers drawn at random into a bound of the error of all, and
//! [`compare_frames`] a sweep into its flicker.

pub mod bound;
mod closed_form;
mod error;
mod exact_union;
pub mod metrics;
mod occlusion_tracer;
mod polygon;
pub mod ray_reference;
mod receiver;
mod sampling;
mod structure;
pub mod temporal;
#[cfg(test)]
mod test_scenes;
mod vector;

pub use bound::{Drawn, ErrorBound, ErrorNorm, Stratum, bound_error};
pub use closed_form::{
    AxisRectangle, Sphere, disc_over_disc, half_plane_over_rectangle, rectangle_over_rectangle, sphere_over_rectangle,
    sphere_over_sphere_light,
};
pub use error::MeasureError;
pub use exact_union::{RectangleLight, rectangle_visibility};
pub use metrics::{ErrorReport, ReferenceImage, RegionError, compare, true_error_interval};
pub use occlusion_tracer::OcclusionTracer;
pub use ray_reference::projected_grazing::{ProjectedSample, ProjectedView, grazing, needed_roundings};
pub use ray_reference::{RayReference, SampleVerdict};
pub use receiver::{Receiver, Target, Triangle};
pub use sampling::{Estimate, SamplingPlan, converged_visibility, t_quantile_975};
pub use structure::Structure;
pub use temporal::{Frame, TemporalReport, compare_frames};
