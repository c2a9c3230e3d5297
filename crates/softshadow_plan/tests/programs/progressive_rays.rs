//! Progressive rays: passes are averaged until every receiver is known well enough, or until their number is spent.

use softshadow_plan::{Kernel, Over, Plan, Program, Step, Values};

use crate::walk::{given, text, walk, words};

struct ProgressiveRays {
    receivers: u32,
    samples: u32,
    most_passes: u32,
    tolerance: f32,
}

impl ProgressiveRays {
    /// The same plan for every pass: only its parameters differ.
    fn pass(&self) -> Plan {
        let mut plan = Plan::new("progressive pass");
        let each = u64::from(self.receivers);
        let over = Over::Items { count: self.receivers, work_per_item: self.samples };
        let receivers = given(&mut plan, "receivers", each * 32);
        let progress = plan.parameter("progress", 16);
        let samples = plan.parameter("light samples", u64::from(self.samples) * 16);
        let seen = plan.buffer("seen", each * 4);
        let mean = plan.persistent("visibility", each * 4);
        let deviations = plan.persistent("deviations", each * 4);
        let unsettled = plan.buffer("unsettled", 4);
        plan.clear("reset unsettled", "every pass counts anew", unsettled);
        plan.compute("trace", "traces this pass's samples", Kernel { file: "rays/trace.wgsl", entry: "trace" }, over)
            .bind("receivers", receivers)
            .bind("light_samples", samples)
            .bind("seen", seen);
        let accumulate = Kernel { file: "rays/accumulate.wgsl", entry: "accumulate" };
        plan.compute("accumulate", "averages, and counts who is not known well enough", accumulate, over)
            .bind("progress", progress)
            .bind("seen", seen)
            .bind("visibility", mean)
            .bind("deviations", deviations)
            .bind("unsettled", unsettled);
        plan.decision = Some(unsettled);
        plan
    }

    fn values(&self, pass: u32) -> Values {
        let samples: Vec<u32> = (0..4 * self.samples).map(|n| n ^ pass).collect();
        let progress = [pass, self.most_passes, self.tolerance.to_bits(), 0];
        [words("progress", &progress), words("light samples", &samples)].into()
    }

    /// Results leave once, when they are known to be the last: a stage of its own, without a pass.
    fn finish(&self) -> Plan {
        let mut plan = Plan::new("results");
        let visibility = plan.persistent("visibility", u64::from(self.receivers) * 4);
        plan.outputs.push(visibility);
        plan
    }
}

impl Program for ProgressiveRays {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        match decision {
            // Only the last stage decides nothing.
            [] if index > 0 => Step::Done,
            [0] => Step::run(self.finish(), Values::new()),
            _ if index as u32 == self.most_passes => Step::run(self.finish(), Values::new()),
            _ => Step::run(self.pass(), self.values(index as u32)),
        }
    }
}

fn program() -> ProgressiveRays {
    ProgressiveRays { receivers: 3072, samples: 16, most_passes: 8, tolerance: 0.01 }
}

/// A device on which the number of unsettled receivers is divided by `rate` in every pass.
fn device(rate: u32) -> impl FnMut(usize, &softshadow_plan::Stage) -> Vec<u32> {
    let mut unsettled = 3072;
    move |_, stage| {
        unsettled /= rate;
        stage.plan.decision.iter().map(|_| unsettled).collect()
    }
}

#[test]
fn it_stops_when_every_receiver_is_settled() {
    // 3072 / 16³ < 1.
    let stages = walk(&program(), device(16));
    assert_eq!(stages.len(), 4);
    assert_eq!(stages[0].plan, stages[2].plan, "passes differ in their parameters alone");
    assert_ne!(stages[0].values, stages[2].values);
    insta::assert_snapshot!(text(&stages, [0, 3]));
}

#[test]
fn it_stops_when_its_passes_are_spent() {
    let stages = walk(&program(), device(1));
    assert_eq!(stages.len(), 9);
    assert_eq!(stages[8].plan.name, "results");
}
