//! Whatever is wrong is a value that names the stage and the resource; the engine works on.

use std::collections::BTreeMap;

use softshadow_engine::WgpuEngine;
use softshadow_plan::{
    Content, Engine as _, EngineError, Kernel, Over, Plan, PlanError, Program, Shape, Step, Timing, Values,
};

use crate::programs::{Stages, engine, place, run};

/// The error of a run on an engine that is good before and after.
fn error_of(stage: (Plan, Values)) -> EngineError {
    let engine = engine();
    let good = |engine: &WgpuEngine| assert!(run(engine, &Stages(vec![place(10, 1)]), Timing::Device).is_ok());
    good(&engine);
    let error = run(&engine, &Stages(vec![stage]), Timing::Device).expect_err("the spoilt stage ran");
    good(&engine);
    error
}

fn contents(resource: &str, problem: &str) -> EngineError {
    EngineError::Contents { stage: "place".into(), resource: resource.into(), problem: problem.into() }
}

#[test]
fn parameters_without_a_value_of_their_size() {
    let (plan, mut values) = place(10, 1);
    values.remove("point range");
    assert_eq!(error_of((plan, values)), contents("point range", "its value was not given"));
    for bytes in [319, 321, 0] {
        let (plan, mut values) = place(10, 1);
        values.insert("points".into(), vec![0; bytes]);
        assert_eq!(error_of((plan, values)), contents("points", "its value was not given"), "{bytes} bytes");
    }
}

/// The plan of [`place`] with its points uploaded once instead of given each run.
fn uploaded(points: &Content) -> (Plan, Values) {
    let (mut plan, mut values) = place(10, 1);
    let at = plan.find("points").unwrap().index();
    plan.resources[at].origin = softshadow_plan::Origin::Uploaded(points.key);
    values.remove("points");
    (plan, values)
}

#[test]
fn contents_that_are_missing_or_of_another_size() {
    let points = Content::new(&[1; 320]);
    assert_eq!(error_of(uploaded(&points)), contents("points", "its contents were not given"));
    let engine = engine();
    let run_with = |content: Content| {
        let given = BTreeMap::from([(points.key, content)]);
        engine.run(&Stages(vec![uploaded(&points)]), &given, Timing::Device, &mut |_| true).map(|report| report.stages)
    };
    let short = Content { key: points.key, bytes: vec![1; 316].into() };
    assert_eq!(run_with(short), Err(contents("points", "its contents were not given")));
    assert_eq!(run_with(points.clone()), Ok(1));
}

#[test]
fn uploads_are_kept_while_they_are_used_and_then_given_back() {
    let engine = engine();
    let points = Content::new(&[1; 320]);
    let given = BTreeMap::from([(points.key, points.clone())]);
    let run_with = |given: &BTreeMap<_, _>| {
        engine.run(&Stages(vec![uploaded(&points)]), given, Timing::Device, &mut |_| true).map(|report| report.stages)
    };
    assert_eq!(run_with(&given), Ok(1));
    for _ in 0..20 {
        assert_eq!(run_with(&BTreeMap::new()), Ok(1), "the device has them");
    }
    for _ in 0..20 {
        run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).unwrap();
    }
    assert_eq!(run_with(&BTreeMap::new()), Err(contents("points", "its contents were not given")));
}

#[test]
fn forgotten_uploads_are_given_back_at_once() {
    let engine = engine();
    let (points, others) = (Content::new(&[1; 320]), Content::new(&[2; 320]));
    let run_with = |points: &Content, given: &[&Content]| {
        let given = given.iter().map(|content| (content.key, (*content).clone())).collect();
        engine.run(&Stages(vec![uploaded(points)]), &given, Timing::Device, &mut |_| true).map(|report| report.stages)
    };
    assert_eq!((run_with(&points, &[&points]), run_with(&others, &[&others])), (Ok(1), Ok(1)));
    engine.forget(&[points.key]);
    assert_eq!(run_with(&points, &[]), Err(contents("points", "its contents were not given")));
    assert_eq!(run_with(&points, &[&points]), Ok(1));
    assert_eq!(run_with(&others, &[&others]), Ok(1));
}

#[test]
fn a_failed_run_leaves_nothing_on_the_device_that_is_trusted() {
    let engine = engine();
    let points = Content::new(&[1; 320]);
    let given = BTreeMap::from([(points.key, points.clone())]);
    let run_with = |given: &BTreeMap<_, _>| {
        engine.run(&Stages(vec![uploaded(&points)]), given, Timing::Device, &mut |_| true).map(|report| report.stages)
    };
    assert_eq!((run_with(&given), run_with(&BTreeMap::new())), (Ok(1), Ok(1)));
    let (plan, _) = place(10, 1);
    assert!(run(&engine, &Stages(vec![(plan, Values::new())]), Timing::Device).is_err());
    assert_eq!(run_with(&BTreeMap::new()), Err(contents("points", "its contents were not given")), "uploaded again");
    assert_eq!(run_with(&given), Ok(1));
}

#[test]
fn plans_are_checked_before_the_driver_is_asked() {
    let (mut plan, values) = place(10, 1);
    plan.passes[0].bindings.pop();
    let binding = PlanError::Binding {
        pass: "place points".into(),
        binding: "receivers".into(),
        problem: "must be bound exactly once".into(),
    };
    assert_eq!(error_of((plan, values)), EngineError::Plan(binding));
    let (mut plan, values) = place(10, 1);
    let label = plan.resources[2].label.clone();
    plan.resources[2].shape = Shape::Buffer { bytes: u64::MAX / 2 };
    let error = error_of((plan, values));
    assert!(matches!(&error, EngineError::Plan(PlanError::TooLarge { what, .. }) if *what == label), "{error}");
}

#[test]
fn what_only_the_driver_sees_is_refused_with_its_words() {
    // A buffer may not be read and written in one dispatch.
    let (mut plan, values) = place(10, 1);
    let receivers = plan.find("receivers").unwrap();
    plan.passes[0].bindings[1].1 = receivers;
    let error = error_of((plan, values));
    assert!(
        matches!(&error, EngineError::Refused { stage, reason } if stage == "place" && !reason.is_empty()),
        "{error}"
    );
}

#[test]
fn the_first_failing_stage_ends_the_program() {
    let (plan, mut values) = place(10, 1);
    values.clear();
    let engine = engine();
    let mut seen = 0;
    let stages = Stages(vec![place(5, 1), (plan, values), place(5, 1)]);
    let result = engine.run(&stages, &BTreeMap::new(), Timing::Device, &mut |_| {
        seen += 1;
        true
    });
    assert!(matches!(result, Err(EngineError::Contents { .. })));
    assert_eq!(seen, 1);
}

/// Panics in the middle of a run, as a caller's program may.
struct Panics;

impl Program for Panics {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        let (plan, values) = place(10, 1);
        assert!(index == 0, "the caller's own panic");
        Step::run(plan, values)
    }
}

#[test]
fn a_panic_of_the_caller_leaves_the_engine_usable() {
    let engine = engine();
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(&engine, &Panics, Timing::Device)));
    assert!(caught.is_err());
    assert!(run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).is_ok());
}

#[test]
fn an_unknown_kernel_is_named() {
    let (mut plan, values) = place(10, 1);
    let kernel = Kernel { file: "receivers/place_points.wgsl", entry: "plaze" };
    plan.passes[0].work = softshadow_plan::Work::Compute { kernel, over: Over::Items { count: 10, work_per_item: 1 } };
    let words = error_of((plan, values)).to_string();
    assert_eq!(words, "pass 'place points': no shader file 'receivers/place_points.wgsl:plaze'");
}
