//! Passes as dispatches, and dispatches as submissions of bounded work.

use softshadow_plan::{Host, Over, Pass, Plan, Work};

use softshadow_plan::Timing;

/// Steps of one submission over items: below a second on a slow software driver, so that watchdogs stay quiet and a caller can
/// stop in between. Work of an indirect dispatch is known to the device alone: who plans one bounds it by the size of its blocks.
const WORK_PER_SUBMISSION: u64 = 1 << 25;

/// A dispatch or another step, with the part of the items that it covers.
pub(crate) struct Dispatch<'a> {
    pub(crate) pass: &'a Pass,
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) slice: usize,
}

/// Passes as dispatches, grouped into submissions of bounded work.
pub(crate) fn schedule<'a>(plan: &'a Plan, host: &Host, timing: Timing) -> Vec<Vec<Dispatch<'a>>> {
    let mut submissions: Vec<Vec<Dispatch<'a>>> = vec![Vec::new()];
    let mut work = 0u64;
    let mut slice = 0;
    for pass in &plan.passes {
        let Work::Compute { kernel, over: Over::Items { count, work_per_item } } = &pass.work else {
            submissions.last_mut().expect("never empty").push(Dispatch { pass, first: 0, count: 0, slice });
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
            let dispatch = Dispatch { pass, first: first as u32, count: part as u32, slice };
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
