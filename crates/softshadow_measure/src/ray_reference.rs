//! The float64 brute-force tracer: every ray against every triangle, no acceleration structure.
//!
//! For every (receiver, sample) it says whether the sample is visible, and whether that verdict is *grazing*: whether a
//! correct float32 kernel could say otherwise because a determinant that decides lies within the float32 rounding bound
//! (see [`bounds`]). A float32 kernel that differs on a sample which is not grazing is wrong.
//!
//! Input is meant to be float32 data converted exactly. Lights are two-sided here: whether a receiver is behind a one-sided
//! light is for the caller to know.

pub mod bounds;
mod contact;
pub mod projected_grazing;
mod shadow_volume;

use rayon::prelude::*;

use crate::receiver::check_triangles;
use crate::vector::{Vec3, abs, dot};
use crate::{MeasureError, Receiver, Target, Triangle};
use bounds::{HORIZON_ROUNDINGS, relative_bound};
use contact::Contact;
use shadow_volume::{ShadowVolume, TargetHull};

/// What the reference says about one sample from one receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleVerdict {
    /// The float64 verdict: above the horizon, and no triangle strictly between.
    pub visible: bool,
    /// Float32 rounding could turn it over.
    pub grazing: bool,
}

/// One target relative to a receiver, as every triangle sees it.
#[derive(Clone, Copy)]
struct Ray {
    direction: Vec3,
    /// Componentwise |direction|, for the rounding bounds.
    magnitude: Vec3,
    at_infinity: bool,
}

impl Ray {
    fn new(origin: Vec3, target: &Target) -> Self {
        let (direction, at_infinity) = target.seen_from(origin);
        Self { direction, magnitude: abs(direction), at_infinity }
    }
}

/// A mesh to trace against.
#[derive(Debug, Clone)]
pub struct RayReference {
    triangles: Vec<Triangle>,
}

impl RayReference {
    /// Takes any soup of triangles; degenerate ones block nothing.
    ///
    /// # Errors
    /// `NotFinite` with the index of the first bad triangle.
    pub fn new(triangles: &[Triangle]) -> Result<Self, MeasureError> {
        check_triangles(triangles)?;
        Ok(Self { triangles: triangles.to_vec() })
    }

    /// Verdicts of every receiver on every target, row-major: `receivers.len() × targets.len()`.
    ///
    /// # Errors
    /// `NotFinite` with the index of the first bad receiver or target.
    pub fn trace(&self, receivers: &[Receiver], targets: &[Target]) -> Result<Vec<SampleVerdict>, MeasureError> {
        check_targets(targets)?;
        let rows = receivers.par_iter().enumerate().map(|(index, receiver)| {
            receiver.check(index)?;
            Ok(self.verdicts(receiver, targets))
        });
        let rows: Vec<_> = rows.collect::<Result<_, MeasureError>>()?;
        Ok(rows.concat())
    }

    /// Verdicts of one receiver, one for each target; for callers whose targets differ from receiver to receiver.
    ///
    /// # Errors
    /// `NotFinite` as for [`Self::trace`].
    pub fn trace_receiver(&self, receiver: &Receiver, targets: &[Target]) -> Result<Vec<SampleVerdict>, MeasureError> {
        receiver.check(0)?;
        check_targets(targets)?;
        Ok(self.verdicts(receiver, targets))
    }

    fn verdicts(&self, receiver: &Receiver, targets: &[Target]) -> Vec<SampleVerdict> {
        let rays: Vec<Ray> = targets.iter().map(|target| Ray::new(receiver.origin, target)).collect();
        let horizon: Vec<Contact> = rays.iter().map(|ray| beyond_horizon(receiver, ray)).collect();
        let above = rays.iter().zip(&horizon).filter(|(_, beyond)| !beyond.certain);
        let Some(hull) = TargetHull::around(above.map(|(ray, _)| ray)) else {
            return horizon.iter().map(|beyond| verdict(*beyond)).collect();
        };
        let candidates: Vec<ShadowVolume> = self.blockers(receiver).filter(|volume| volume.may_touch(&hull)).collect();
        rays.iter().zip(horizon).map(|(ray, beyond)| verdict(block(ray, beyond, &candidates))).collect()
    }

    fn blockers(&self, receiver: &Receiver) -> impl Iterator<Item = ShadowVolume> {
        self.triangles
            .iter()
            .enumerate()
            .filter(|(index, _)| receiver.excluded_triangle != Some(*index))
            .map(|(_, triangle)| ShadowVolume::new(receiver.origin, triangle))
    }
}

fn check_targets(targets: &[Target]) -> Result<(), MeasureError> {
    targets.iter().enumerate().try_for_each(|(index, target)| target.check(index))
}

/// The horizon as one more blocker.
fn beyond_horizon(receiver: &Receiver, ray: &Ray) -> Contact {
    let Some(normal) = receiver.normal else {
        return Contact::NONE;
    };
    let height = dot(normal, ray.direction);
    let bound = relative_bound(HORIZON_ROUNDINGS) * dot(abs(normal), ray.magnitude);
    Contact {
        hit: height <= 0.0,
        possible: height - bound <= 0.0,
        // At height 0 with bound 0 nothing was rounded: the kernel finds the same 0.
        certain: height + bound <= 0.0,
    }
}

/// Everything between the receiver and one sample, together.
fn block(ray: &Ray, beyond_horizon: Contact, candidates: &[ShadowVolume]) -> Contact {
    let mut all = beyond_horizon;
    for volume in candidates {
        if all.certain {
            break;
        }
        all = all.or(volume.contact(ray));
    }
    all
}

fn verdict(blocked: Contact) -> SampleVerdict {
    SampleVerdict { visible: !blocked.hit, grazing: blocked.is_grazing() }
}

#[cfg(test)]
mod tests;
