//! 10^8 points in blocks: no buffer is larger than a binding of core WebGPU, every point is computed once, and blocks but for
//! the last share one plan.

use softshadow_plan::{Host, Kernel, Over, Plan, Program, Stage, Step, Values};

use crate::walk::{text, walk, words};

struct ManyPoints {
    points: u64,
    samples: u32,
    host: Host,
}

const POINT_BYTES: u64 = 32;
const RECEIVER_BYTES: u64 = 32;

impl ManyPoints {
    /// The widest record of a point decides how many fit a binding.
    fn block(&self) -> u64 {
        self.host.limits.storage_binding_bytes / POINT_BYTES.max(RECEIVER_BYTES)
    }

    fn plan(&self, count: u64) -> Plan {
        let mut plan = Plan::new("block of points");
        let over = |work_per_item| Over::Items { count: count as u32, work_per_item };
        let points = plan.parameter("points", count * POINT_BYTES);
        let receivers = plan.buffer("receivers", count * RECEIVER_BYTES);
        let samples = plan.parameter("light samples", u64::from(self.samples) * 16);
        let visibility = plan.buffer("visibility", count * 4);
        let place = Kernel { file: "receivers/place_points.wgsl", entry: "place" };
        plan.compute("place points", "lifts the points off their surface", place, over(1))
            .bind("points", points)
            .bind("receivers", receivers);
        // Work is told by item, so that a block of many rays is split into submissions of a bounded time.
        let trace = Kernel { file: "rays/trace.wgsl", entry: "trace" };
        plan.compute("trace", "traces every sample", trace, over(self.samples))
            .bind("receivers", receivers)
            .bind("light_samples", samples)
            .bind("visibility", visibility);
        plan.outputs.push(visibility);
        plan
    }
}

impl Program for ManyPoints {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        let first = index as u64 * self.block();
        if first >= self.points {
            return Step::Done;
        }
        let count = self.block().min(self.points - first);
        // A block's points are made when its turn comes: never all of them at once.
        let points = ("points".to_owned(), vec![0; (count * POINT_BYTES) as usize]);
        let values = Values::from([points, words("light samples", &vec![0; 4 * self.samples as usize])]);
        Step::run(self.plan(count), values)
    }
}

/// Walks the program and keeps no points: a block holds 128 MiB of them.
fn blocks(points: u64, binding: u64) -> Vec<Stage> {
    let mut host = Host::default();
    host.limits.storage_binding_bytes = binding;
    let program = ManyPoints { points, samples: 64, host };
    let mut plans = Vec::new();
    let mut index = 0;
    while let Step::Run(stage) = program.step(index, &[]) {
        assert_eq!(stage.values["points"].len() as u64, stage.plan.resources[0].bytes());
        plans.push(Stage { plan: stage.plan, values: Values::new() });
        index += 1;
    }
    plans
}

fn items(stage: &Stage) -> u64 {
    stage.plan.resources[stage.plan.find("visibility").unwrap().index()].bytes() / 4
}

#[test]
fn every_point_is_computed_once_within_the_limits() {
    let host = Host::default();
    let stages = blocks(100_000_000, host.limits.storage_binding_bytes);
    assert_eq!(stages.len(), 24);
    assert_eq!(stages.iter().map(items).sum::<u64>(), 100_000_000);
    let largest = stages.iter().flat_map(|s| s.plan.memory()).map(|(_, bytes)| bytes).max();
    assert_eq!(largest, Some(host.limits.storage_binding_bytes), "a block fills the binding and no more");
    assert!(stages[..23].iter().all(|s| s.plan == stages[0].plan));
    assert_ne!(stages[23].plan, stages[0].plan);
    insta::assert_snapshot!(text(&stages, [0, 23]));
}

#[test]
fn a_smaller_binding_makes_more_blocks() {
    assert_eq!(blocks(1000, 32 * 100).iter().map(items).collect::<Vec<_>>(), [100; 10]);
    assert_eq!(blocks(1001, 32 * 100).iter().map(items).next_back(), Some(1));
    assert!(blocks(0, 32).is_empty());
}

#[test]
fn one_block_is_walked_like_any_program() {
    let program = ManyPoints { points: 1000, samples: 4, host: Host::default() };
    assert_eq!(walk(&program, |_, _| Vec::new()).len(), 1);
}
