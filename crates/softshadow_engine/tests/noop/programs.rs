//! Small programs that need no scene.

use std::collections::BTreeMap;

use softshadow_engine::{AdapterChoice, WgpuEngine};
use softshadow_plan::{
    Engine as _, EngineError, Kernel, Over, Plan, Program, RunReport, StageReport, Step, Timing, Values,
};

/// Stages that are known beforehand.
pub(crate) struct Stages(pub(crate) Vec<(Plan, Values)>);

impl Program for Stages {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        self.0.get(index).map_or(Step::Done, |(plan, values)| Step::run(plan.clone(), values.clone()))
    }
}

pub(crate) fn engine() -> WgpuEngine {
    WgpuEngine::new(AdapterChoice::Noop).unwrap()
}

/// Places `count` points, each of which is said to cost `work` steps.
pub(crate) fn place(count: u32, work: u32) -> (Plan, Values) {
    let mut plan = Plan::new("place");
    let points = plan.parameter("points", u64::from(count) * 32);
    let range = plan.parameter("point range", 4);
    let receivers = plan.persistent("receivers", u64::from(count) * 32);
    let kernel = Kernel { file: "receivers/place_points.wgsl", entry: "place" };
    plan.compute("place points", "puts receivers at points", kernel, Over::Items { count, work_per_item: work })
        .bind("point_range", range)
        .bind("points", points)
        .bind("receivers", receivers);
    plan.outputs.push(receivers);
    (plan, [("points".into(), vec![0; count as usize * 32]), ("point range".into(), vec![0; 4])].into())
}

/// Runs stages without contents and collects what they report.
pub(crate) fn run(
    engine: &WgpuEngine,
    program: &dyn Program,
    timing: Timing,
) -> Result<(RunReport, Vec<StageReport<'static>>), EngineError> {
    let mut reports = Vec::new();
    let report = engine.run(program, &BTreeMap::new(), timing, &mut |stage| {
        reports.extend(stage.map(StageReport::into_owned));
        true
    })?;
    Ok((report, reports))
}
