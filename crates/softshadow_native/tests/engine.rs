//! The interpreter itself: what it refuses, and that it stays usable.

use std::collections::BTreeMap;

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_plan::{
    Content, Engine, EngineError, Kernel, Over, Plan, Program, Stage, StageReport, Step, Timing, Values,
};

const PLACE: Kernel = Kernel { file: "receivers/place_points.wgsl", entry: "place" };

/// One plan, once.
struct Once(Stage);

impl Program for Once {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        if index == 0 { Step::Run(Box::new(self.0.clone())) } else { Step::Done }
    }
}

/// Points lifted off their surface: `count` of them, of which the pass takes `items`.
fn lifted(count: usize, items: u32, work_per_item: u32) -> Once {
    let mut plan = Plan::new("points");
    let points = plan.parameter("points", 32 * count as u64);
    let range = plan.parameter("point range", 4);
    let receivers = plan.persistent("receivers", 32 * count as u64);
    plan.compute("place points", "for a test", PLACE, Over::Items { count: items, work_per_item })
        .bind("point_range", range)
        .bind("points", points)
        .bind("receivers", receivers);
    plan.outputs.push(receivers);
    let words = (0..count).flat_map(|k| [k as f32, 2.0, 3.0, f32::from_bits(1), 0.0, 1.0, 0.0, 0.0]);
    let mut values = Values::new();
    values.insert("points".into(), words.flat_map(f32::to_le_bytes).collect());
    values.insert("point range".into(), 1.0_f32.to_le_bytes().to_vec());
    Once(Stage { plan, values })
}

fn run(engine: &NativeEngine, program: &Once) -> Result<Vec<u32>, EngineError> {
    let mut found = Vec::new();
    let mut keep = |stage: Option<StageReport>| {
        if let Some(stage) = stage {
            found = bytemuck::pod_collect_to_vec(&stage.outputs["receivers"]);
        }
        true
    };
    engine.run(program, &BTreeMap::new(), Timing::Device, &mut keep)?;
    Ok(found)
}

#[test]
fn threads_and_vectors_change_no_bit() {
    let program = lifted(5001, 5001, 1);
    let settings = [
        NativeSettings::default(),
        NativeSettings { threads: Some(1), vectors: Vectors::Baseline },
        NativeSettings { threads: Some(3), vectors: Vectors::Widest },
    ];
    let [a, b, c] = settings.map(|settings| run(&NativeEngine::new(settings), &program).unwrap());
    assert_eq!((a.len(), f32::from_bits(a[8 * 5000])), (8 * 5001, 5000.0));
    assert!(f32::from_bits(a[1]) > 2.0 && a == b && b == c);
}

#[test]
fn a_kernel_without_a_twin_is_named_with_the_way_out() {
    let kernel = Kernel { file: "depth_complexity/blended/take_layers.wgsl", entry: "take_layers" };
    assert!(!softshadow_native::has_twin(kernel) && softshadow_native::has_twin(PLACE));
    let mut plan = Plan::new("layers");
    let frame = plan.parameter("light frame", 128);
    let buffers = ["layers", "slots", "blocked"].map(|name| (name, plan.persistent(name, 16)));
    let over = Over::Items { count: 1, work_per_item: 1 };
    let pass = plan.compute("take layers", "for a test", kernel, over).bind("light_frame", frame);
    for (name, buffer) in buffers {
        pass.bind(name, buffer);
    }
    let program = Once(Stage { plan, values: Values::new() });
    let words = run(&NativeEngine::new(NativeSettings::default()), &program).unwrap_err().to_string();
    assert_eq!(
        words,
        "the native engine cannot run 'take layers': it has no depth_complexity/blended/take_layers.wgsl:take_layers; use \
         device 'gpu' or 'software'"
    );
}

#[test]
fn a_kernel_that_panics_ends_in_an_error_and_the_next_run_works() {
    let engine = NativeEngine::new(NativeSettings::default());
    // More items than there are points: no plan of a technique has them.
    let error = run(&engine, &lifted(4, 1000, 1)).unwrap_err();
    let EngineError::Refused { stage, reason } = &error else { panic!("{error}") };
    assert_eq!(stage, "points");
    assert!(reason.contains("receivers/place_points.wgsl:place panicked"), "{reason}");
    assert_eq!(run(&engine, &lifted(4, 4, 1)).unwrap().len(), 32);
}

#[test]
fn what_was_not_given_is_named() {
    let mut program = lifted(4, 4, 1);
    program.0.values.remove("points");
    let engine = NativeEngine::new(NativeSettings::default());
    let words = run(&engine, &program).unwrap_err().to_string();
    assert_eq!(words, "stage 'points', 'points': its value was not given");
    let mut program = lifted(4, 4, 1);
    let content = Content::new(&[1, 2, 3, 4]);
    program.0.plan.uploaded("table", &content);
    let words = run(&engine, &program).unwrap_err().to_string();
    assert_eq!(words, "stage 'points', 'table': its contents were not given");
}

#[test]
fn a_long_pass_asks_whether_to_go_on() {
    let engine = NativeEngine::new(NativeSettings::default());
    let program = lifted(5000, 5000, 1 << 22);
    let mut asked = 0;
    let mut stop = |stage: Option<StageReport>| {
        assert!(stage.is_none(), "the stage must not end");
        asked += 1;
        asked < 3
    };
    let error = engine.run(&program, &BTreeMap::new(), Timing::Device, &mut stop).unwrap_err();
    assert_eq!((error, asked), (EngineError::Interrupted, 3));
    assert_eq!(run(&engine, &program).unwrap().len(), 40_000);
}

#[test]
fn a_lost_device_says_so() {
    let engine = NativeEngine::new(NativeSettings::default());
    engine.destroy();
    assert!(engine.is_lost());
    assert!(matches!(run(&engine, &lifted(1, 1, 1)), Err(EngineError::DeviceLost { .. })));
}
