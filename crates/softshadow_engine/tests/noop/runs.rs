//! What a run reports, and what it hands out.

use softshadow_engine::{DeviceKind, Engine, Timing};
use softshadow_plan::{Host, Limits, Plan, Program, Step, Values};

use crate::programs::{Stages, engine, place, run};

#[test]
fn the_engine_says_what_it_runs_on() {
    let engine = engine();
    assert_eq!((engine.adapter().device_type, engine.adapter().backend.as_str()), (DeviceKind::Noop, "noop"));
    assert!(!engine.is_lost());
    // The smallest device that WebGPU allows, but for the storage buffers of a pass: what it accepts runs nearly everywhere.
    let (limits, core) = (engine.host().limits, Host::default().limits);
    assert_eq!(limits, Limits { storage_buffers: limits.storage_buffers, ..core });
    assert!((8..=9).contains(&limits.storage_buffers));
    assert_eq!(engine.adapter().storage_binding_bytes, 128 << 20);
}

#[test]
fn one_short_stage_is_one_submission() {
    let (report, stages) = run(&engine(), &Stages(vec![place(100, 1)]), Timing::Device).unwrap();
    assert_eq!((report.stages, report.submissions), (1, 1));
    assert_eq!(stages.len(), 1);
    let sizes: Vec<(&str, usize)> = stages[0].outputs.iter().map(|(l, b)| (l.as_str(), b.len())).collect();
    assert_eq!(sizes, [("receivers", 3200)]);
    assert!(report.wall_ms > 0.0);
    let (report, stages) = run(&engine(), &Stages(vec![place(100, 1), place(7, 1)]), Timing::Device).unwrap();
    assert_eq!((report.stages, report.submissions), (2, 2));
    assert_eq!(
        stages.iter().map(|s| (s.index, s.outputs["receivers"].len())).collect::<Vec<_>>(),
        [(0, 3200), (1, 224)]
    );
}

#[test]
fn the_largest_stage_is_what_memory_was_needed() {
    let stages = || vec![place(3, 1), place(100, 1), place(50, 1)];
    let (report, _) = run(&engine(), &Stages(stages()), Timing::Device).unwrap();
    let expected: Vec<(String, u64)> =
        stages()[1].0.memory().into_iter().map(|(label, bytes)| (label.to_owned(), bytes)).collect();
    assert_eq!(report.bytes, expected);
    assert_eq!(report.bytes.iter().map(|(_, b)| b).sum::<u64>(), 3200 + 4 + 3200);
}

#[test]
fn an_empty_program_does_nothing() {
    let (report, stages) = run(&engine(), &Stages(Vec::new()), Timing::Device).unwrap();
    assert_eq!((report.stages, report.submissions, stages.len()), (0, 0, 0));
}

#[test]
fn a_stage_without_passes_hands_out_what_an_earlier_one_left() {
    let mut finish = Plan::new("results");
    let receivers = finish.persistent("receivers", 3200);
    finish.outputs.push(receivers);
    let stages = Stages(vec![place(100, 1), (finish, Values::new())]);
    let (report, stages) = run(&engine(), &stages, Timing::EachPass).unwrap();
    assert_eq!((report.stages, stages[1].outputs["receivers"].len()), (2, 3200));
}

#[test]
fn every_pass_is_timed_alone_when_that_is_asked_for() {
    let timed = |engine: &Engine, timing| {
        let (report, _) = run(engine, &Stages(vec![place(100, 1), place(50, 1)]), timing).unwrap();
        report.pass_ms.into_iter().map(|t| t.label).collect::<Vec<_>>()
    };
    let engine = engine();
    assert_eq!(timed(&engine, Timing::EachPass), ["place points"], "both stages' passes of one label are added up");
    assert!(timed(&engine, Timing::Device).is_empty(), "no clock that can be trusted");
}

/// Clears a buffer and lets the next stage know its words; stops when they are what was expected.
struct Deciding;

impl Program for Deciding {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        let expected: &[u32] = if index == 0 { &[] } else { &[0, 0, 0] };
        if index == 2 || decision != expected {
            return Step::Done;
        }
        let mut plan = Plan::new("decide");
        let words = plan.buffer("words", 12);
        plan.clear("reset", "the decision begins at zero", words);
        plan.decision = Some(words);
        Step::run(plan, Values::new())
    }
}

#[test]
fn the_decision_reaches_the_next_stage_and_nobody_else() {
    let (report, stages) = run(&engine(), &Deciding, Timing::Device).unwrap();
    assert_eq!(report.stages, 2, "the second stage saw three zero words");
    assert!(stages.iter().all(|s| s.outputs.is_empty()));
}

#[test]
fn runs_of_several_threads_take_turns() {
    let engine = engine();
    std::thread::scope(|scope| {
        let runs: Vec<_> = (1..5)
            .map(|n| {
                let engine = &engine;
                scope.spawn(move || {
                    let stages = Stages(vec![place(n * 10, 1), place(n, 1)]);
                    let (report, stages) = run(engine, &stages, Timing::Device).unwrap();
                    assert_eq!(report.submissions, 2);
                    stages.iter().map(|s| s.outputs["receivers"].len()).collect::<Vec<_>>()
                })
            })
            .collect();
        for (n, run) in (1..5).zip(runs) {
            assert_eq!(run.join().unwrap(), [n * 320, n * 32]);
        }
    });
}
