//! Long passes are split by their work, so that watchdogs stay quiet and a caller can stop in between.

use std::collections::BTreeMap;

use softshadow_plan::{Engine as _, EngineError, StageReport, Timing};

use crate::programs::{Stages, engine, place, run};

/// Steps of one submission: about a second on a slow software driver.
const MOST_WORK: u64 = 1 << 25;

#[test]
fn submissions_follow_from_the_work() {
    let engine = engine();
    for (count, work) in [(1000, 1), (1 << 10, 1 << 15), ((1 << 10) + 1, 1 << 15), (1 << 10, 1 << 18), (3000, 1 << 20)]
    {
        let (report, stages) = run(&engine, &Stages(vec![place(count, work)]), Timing::Device).unwrap();
        // A dispatch is never smaller than a group of 64.
        let items = (MOST_WORK / u64::from(work)).max(64);
        assert_eq!(report.submissions as u64, u64::from(count).div_ceil(items), "{count} items of {work}");
        assert_eq!(stages[0].outputs["receivers"].len(), count as usize * 32, "the parts make one result");
    }
}

#[test]
fn parts_of_a_pass_are_timed_as_one() {
    let (report, _) = run(&engine(), &Stages(vec![place(1 << 10, 1 << 18)]), Timing::EachPass).unwrap();
    assert_eq!(report.submissions, 8);
    assert_eq!(report.pass_ms.iter().map(|t| t.label.as_str()).collect::<Vec<_>>(), ["place points"]);
}

#[test]
fn more_groups_than_a_dispatch_takes_are_several_dispatches_of_one_submission() {
    let engine = engine();
    // The only pass with room for more than 65,535 groups of 64 has 32 bytes an item: a binding of 128 MiB is then full.
    let count = 1 << 22;
    assert!(u64::from(count) < MOST_WORK && u64::from(count) * 32 <= engine.host().limits.storage_binding_bytes);
    let (report, _) = run(&engine, &Stages(vec![place(count, 1)]), Timing::Device).unwrap();
    assert_eq!(report.submissions, 1);
}

/// Runs eight submissions and stops when `stop` says so; returns how often the caller was asked, with and without a result.
fn interrupted(stop: impl Fn(usize, bool) -> bool) -> (Result<usize, EngineError>, [usize; 2]) {
    let engine = engine();
    let mut asked = [0; 2];
    let stages = Stages(vec![place(1 << 10, 1 << 18)]);
    let result = engine.run(&stages, &BTreeMap::new(), Timing::Device, &mut |stage: Option<StageReport>| {
        asked[usize::from(stage.is_some())] += 1;
        !stop(asked[0] + asked[1], stage.is_some())
    });
    let next = run(&engine, &stages, Timing::Device);
    assert_eq!(next.map(|(report, _)| report.submissions), Ok(8), "the next run works");
    (result.map(|report| report.submissions), asked)
}

#[test]
fn a_caller_is_asked_between_submissions_and_can_stop() {
    assert_eq!(interrupted(|_, _| false), (Ok(8), [7, 1]));
    assert_eq!(interrupted(|_, _| true), (Err(EngineError::Interrupted), [1, 0]));
    assert_eq!(interrupted(|asked, _| asked == 3), (Err(EngineError::Interrupted), [3, 0]));
    assert_eq!(interrupted(|_, has_result| has_result), (Err(EngineError::Interrupted), [7, 1]));
}
