//! What a run reports, and what it hands out.

use std::borrow::Cow;

use softshadow_engine::WgpuEngine;
use softshadow_plan::{DeviceKind, Engine as _, Host, Plan, Program, Step, Timing, Values};

use crate::programs::{Stages, engine, place, run};

#[test]
fn the_engine_says_what_it_runs_on() {
    let engine = engine();
    assert_eq!((engine.adapter().device_type, engine.adapter().backend.as_str()), (DeviceKind::Noop, "noop"));
    assert!(!engine.is_lost());
    // The smallest device that WebGPU allows: what it accepts runs everywhere.
    assert_eq!(engine.host().limits, Host::default().limits);
    assert_eq!(engine.host().limits.storage_buffers, 8);
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
    let timed = |engine: &WgpuEngine, timing| {
        let (report, _) = run(engine, &Stages(vec![place(100, 1), place(50, 1)]), timing).unwrap();
        report.pass_ms.into_iter().map(|t| t.label).collect::<Vec<_>>()
    };
    let engine = engine();
    assert_eq!(timed(&engine, Timing::EachPass), ["place points"], "both stages' passes of one label are added up");
    assert!(timed(&engine, Timing::Device).is_empty(), "no clock that can be trusted");
}

/// Clears a buffer and lets the next stage know its words; stops when they are what was expected.
struct Deciding {
    hands_out: bool,
}

impl Program for Deciding {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        let expected: &[u32] = if index == 0 { &[] } else { &[0, 0, 0] };
        if index == 2 || decision != expected {
            return Step::Done;
        }
        let mut plan = Plan::new("decide");
        let words = plan.buffer("words", 12);
        let others = plan.buffer("others", 8);
        plan.clear("reset", "the decision begins at zero", words);
        plan.clear("reset others", "the caller is told nothing", others);
        plan.decision = Some(words);
        plan.outputs.push(others);
        plan.outputs.extend(self.hands_out.then_some(words));
        Step::run(plan, Values::new())
    }
}

/// Labels and bytes of every stage's outputs.
fn handed_out(hands_out: bool) -> Vec<Vec<(String, Vec<u8>)>> {
    let (report, stages) = run(&engine(), &Deciding { hands_out }, Timing::Device).unwrap();
    assert_eq!(report.stages, 2, "the second stage saw three zero words");
    let words = |(label, bytes): (String, Cow<'_, [u8]>)| (label, bytes.into_owned());
    stages.into_iter().map(|s| s.outputs.into_iter().map(words).collect()).collect()
}

#[test]
fn the_decision_reaches_the_next_stage_and_nobody_else() {
    assert_eq!(handed_out(false), vec![vec![("others".to_owned(), vec![0; 8])]; 2]);
}

#[test]
fn a_decision_that_is_an_output_reaches_the_caller_too() {
    let both = vec![("others".to_owned(), vec![0; 8]), ("words".to_owned(), vec![0; 12])];
    assert_eq!(handed_out(true), vec![both; 2]);
}

/// A plan that keeps a cleared buffer with this label, and hands it out.
fn keeps(label: &str, bytes: u64) -> (Plan, Values) {
    let mut plan = Plan::new("keep");
    let kept = plan.persistent(label, bytes);
    plan.clear("reset", "zeros are what is kept", kept);
    plan.outputs.push(kept);
    (plan, Values::new())
}

/// A plan that hands out what an earlier one kept.
fn hands_out(label: &str, bytes: u64) -> (Plan, Values) {
    let mut plan = Plan::new("hand out");
    let kept = plan.persistent(label, bytes);
    plan.outputs.push(kept);
    (plan, Values::new())
}

#[test]
fn a_parameter_and_a_persistent_of_one_label_and_size_are_two_buffers() {
    // A uniform and an array of the kernel, each before and after the persistent buffer: in one run, then in runs of their own.
    for (label, bytes) in [("point range", 4), ("points", 320)] {
        let given = || {
            let (plan, mut values) = place(10, 1);
            values.insert(label.into(), vec![0xff; bytes]);
            (plan, values)
        };
        let kept = || keeps(label, bytes as u64);
        let last = || hands_out(label, bytes as u64);
        for stages in [vec![kept(), given(), last()], vec![given(), kept(), given(), last()]] {
            let (_, reports) = run(&engine(), &Stages(stages.clone()), Timing::Device).unwrap();
            assert_eq!(reports.len(), stages.len());
            let one_engine = engine();
            let alone = stages.into_iter().map(|stage| {
                let (_, mut reports) = run(&one_engine, &Stages(vec![stage]), Timing::Device).unwrap();
                reports.remove(0).outputs
            });
            let together: Vec<_> = reports.into_iter().map(|report| report.outputs).collect();
            assert_eq!(alone.collect::<Vec<_>>(), together);
            assert_eq!(together.last().unwrap()[label], vec![0; bytes], "the parameter's value went elsewhere");
        }
    }
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
