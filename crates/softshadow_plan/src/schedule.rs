//! Passes as dispatches, and dispatches as submissions of bounded work.

use serde::Serialize;

use crate::engine::Timing;
use crate::host::Host;
use crate::pass::{Over, Work};
use crate::plan::Plan;

/// Steps of one submission over items: below a second on a slow software driver, so that watchdogs stay quiet and a caller can
/// stop in between. Work of an indirect dispatch is known to the device alone: who plans one bounds it by the size of its blocks.
const WORK_PER_SUBMISSION: u64 = 1 << 25;

/// A dispatch or another step, with the part of the items that it covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Dispatch {
    /// Position of the pass in [`Plan::passes`].
    pub pass: usize,
    /// The first item; 0 where the pass is not over items.
    pub first: u32,
    /// How many items; 0 where the pass is not over items.
    pub count: u32,
    /// Groups that cover the items; 0 where the pass is not over items.
    pub groups: u32,
    /// Its number among all dispatches of the plan.
    pub slice: usize,
}

/// Passes as dispatches, grouped into submissions of bounded work; at least one, which may be empty.
#[must_use]
pub fn schedule(plan: &Plan, host: &Host, timing: Timing) -> Vec<Vec<Dispatch>> {
    let mut submissions: Vec<Vec<Dispatch>> = vec![Vec::new()];
    let mut work = 0u64;
    let mut slice = 0;
    for (index, pass) in plan.passes.iter().enumerate() {
        let Work::Compute { kernel, over: Over::Items { count, work_per_item } } = &pass.work else {
            let dispatch = Dispatch { pass: index, first: 0, count: 0, groups: 0, slice };
            submissions.last_mut().expect("never empty").push(dispatch);
            slice += 1;
            continue;
        };
        let group = softshadow_shaders::module(kernel.file)
            .ok()
            .and_then(|m| m.entry_points.get(kernel.entry))
            .map_or(1, |e| e.workgroup_size[0]);
        let most = u64::from(host.limits.groups) * u64::from(group);
        let cost = u64::from((*work_per_item).max(1));
        let mut first = 0u64;
        while first < u64::from(*count) {
            let room = (WORK_PER_SUBMISSION.saturating_sub(work) / cost).max(u64::from(group));
            let part = (u64::from(*count) - first).min(most).min(room);
            let groups = part.div_ceil(u64::from(group)) as u32;
            let dispatch = Dispatch { pass: index, first: first as u32, count: part as u32, groups, slice };
            submissions.last_mut().expect("never empty").push(dispatch);
            slice += 1;
            first += part;
            work += part * cost;
            if work >= WORK_PER_SUBMISSION && first < u64::from(*count) {
                submissions.push(Vec::new());
                work = 0;
            }
        }
    }
    if timing == Timing::EachPass {
        submissions = submissions.into_iter().flatten().map(|dispatch| vec![dispatch]).collect();
        if submissions.is_empty() {
            submissions.push(Vec::new());
        }
    }
    submissions
}
