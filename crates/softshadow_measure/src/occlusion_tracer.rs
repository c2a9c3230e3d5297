//! The float64 tracer for many rays: the verdicts of [`RayReference`](crate::RayReference), through a hierarchy of boxes.
//!
//! Whether a target is hidden follows from the same inequalities on the same float64 numbers as there; the hierarchy
//! only leaves out triangles whose box the ray misses. It knows no rounding bounds: what a float32 kernel may decide
//! otherwise is for [`RayReference`](crate::RayReference) to say, for the few samples that differ.
//!
//! Wrong when receiver and target both lie within 1e-8 of the plane of a triangle that is elsewhere in that plane:
//! there the determinants can be noise of one sign, a hit that has no place. Both are exactly 0, no hit, where the
//! plane is aligned to an axis; and such samples are grazing.

mod beam;
mod blocker;
mod hierarchy;

use crate::receiver::check_triangles;
use crate::vector::{Vec3, dot};
use crate::{MeasureError, Receiver, Target, Triangle};
use beam::{Apex, Pyramid, Slabs};
use blocker::Blocker;
use hierarchy::{Bounds, Hierarchy};

/// So many triangles in the pyramid of a receiver are tested one by one for each ray; with more, each ray walks on its own.
/// On a bunny of 70,000 triangles 4 to 16 take the same time, 0 and 32 longer.
const FEW: usize = 8;

/// A mesh to trace against.
#[derive(Debug, Clone)]
pub struct OcclusionTracer {
    hierarchy: Hierarchy,
    /// In the order of the leaves.
    blockers: Vec<Blocker>,
    /// Largest coordinate of any of them.
    reach: f64,
}

impl OcclusionTracer {
    /// Takes any soup of triangles; degenerate ones block nothing.
    ///
    /// # Errors
    /// `NotFinite` with the index of the first bad triangle.
    pub fn new(triangles: &[Triangle]) -> Result<Self, MeasureError> {
        check_triangles(triangles)?;
        let found: Vec<Blocker> =
            triangles.iter().enumerate().filter_map(|(index, corners)| Blocker::new(index, corners)).collect();
        let boxes: Vec<Bounds> = found.iter().map(|blocker| Bounds::around(blocker.corners())).collect();
        let (hierarchy, order) = Hierarchy::over(&boxes);
        let blockers = order.into_iter().map(|at| found[at].clone()).collect();
        let reach = hierarchy.bounds().map_or(0.0, |bounds| bounds.largest_coordinate());
        Ok(Self { hierarchy, blockers, reach })
    }

    /// For each target whether it is hidden: at or below the horizon, or behind a triangle other than the excluded one.
    /// Coordinates are for the caller to keep finite.
    #[must_use]
    pub fn hidden(&self, receiver: &Receiver, targets: &[Target]) -> Vec<bool> {
        let mut hidden = vec![false; targets.len()];
        self.hidden_into(receiver, targets, &mut hidden);
        hidden
    }

    /// [`Self::hidden`] without an allocation.
    ///
    /// # Panics
    /// When `hidden` and `targets` differ in length.
    pub fn hidden_into(&self, receiver: &Receiver, targets: &[Target], hidden: &mut [bool]) {
        assert_eq!(hidden.len(), targets.len(), "one verdict for each target");
        let mut pyramid = Pyramid::EMPTY;
        for (target, hidden) in targets.iter().zip(&mut *hidden) {
            let (direction, at_infinity) = target.seen_from(receiver.origin);
            *hidden = beyond_horizon(receiver, direction);
            if !*hidden {
                pyramid.add(direction, at_infinity);
            }
        }
        let apex = Apex::new(receiver.origin, self.reach);
        let candidates = self.candidates(receiver, apex, &pyramid);
        if candidates.count == 0 {
            return;
        }
        let mut latest = None;
        for (target, hidden) in targets.iter().zip(hidden).filter(|(_, hidden)| !**hidden) {
            let (direction, at_infinity) = target.seen_from(receiver.origin);
            let blocks = |at: &usize| self.blockers[*at].blocks(receiver.origin, direction, at_infinity);
            if latest.as_ref().is_some_and(blocks) {
                *hidden = true;
                continue;
            }
            let found = match candidates.all() {
                Some(few) => few.iter().copied().find(blocks),
                None => self.first_found(receiver, apex, direction, at_infinity),
            };
            *hidden = found.is_some();
            latest = found.or(latest);
        }
    }

    /// The indices, in ascending order, of all triangles other than the excluded one that block the target; the horizon
    /// plays no part.
    #[must_use]
    pub fn crossings(&self, receiver: &Receiver, target: &Target) -> Vec<usize> {
        let (direction, at_infinity) = target.seen_from(receiver.origin);
        let ray = Slabs::new(Apex::new(receiver.origin, self.reach), direction, at_infinity);
        let mut found = Vec::new();
        self.hierarchy.any(&ray, |leaf| {
            let hit = self.blockers[leaf].iter().filter(|blocker| {
                receiver.excluded_triangle != Some(blocker.index)
                    && blocker.blocks(receiver.origin, direction, at_infinity)
            });
            found.extend(hit.map(|blocker| blocker.index));
            false
        });
        found.sort_unstable();
        found
    }

    fn candidates(&self, receiver: &Receiver, apex: Apex, pyramid: &Pyramid) -> Candidates {
        let mut candidates = Candidates { count: 0, first: [0; FEW] };
        if pyramid.is_empty() {
            return candidates;
        }
        self.hierarchy.any(&pyramid.from(apex), |leaf| {
            leaf.into_iter().any(|at| {
                let blocker = &self.blockers[at];
                let kept =
                    receiver.excluded_triangle != Some(blocker.index) && blocker.may_block(receiver.origin, pyramid);
                kept && candidates.push(at)
            })
        });
        candidates
    }

    /// Where in `blockers` the first triangle found to block the ray is.
    fn first_found(&self, receiver: &Receiver, apex: Apex, direction: Vec3, at_infinity: bool) -> Option<usize> {
        let mut found = None;
        self.hierarchy.any(&Slabs::new(apex, direction, at_infinity), |leaf| {
            found = leaf.into_iter().find(|at| {
                let blocker = &self.blockers[*at];
                blocker.blocks(receiver.origin, direction, at_infinity)
                    && receiver.excluded_triangle != Some(blocker.index)
            });
            found.is_some()
        });
        found
    }
}

/// What may block any ray of a receiver.
struct Candidates {
    /// More than `FEW` when there were too many to keep.
    count: usize,
    first: [usize; FEW],
}

impl Candidates {
    /// True when there was no room.
    fn push(&mut self, at: usize) -> bool {
        if let Some(free) = self.first.get_mut(self.count) {
            *free = at;
        }
        self.count += 1;
        self.count > FEW
    }

    /// `None` when there were too many.
    fn all(&self) -> Option<&[usize]> {
        self.first.get(..self.count)
    }
}

fn beyond_horizon(receiver: &Receiver, direction: Vec3) -> bool {
    receiver.normal.is_some_and(|normal| dot(normal, direction) <= 0.0)
}

#[cfg(test)]
mod tests;
