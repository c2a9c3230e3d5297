//! Programs: a few plans in a row. The next stage is a pure function of a few integers read back from the last.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::plan::Plan;
use crate::resource::ResourceId;

/// Values of parameters, by the label of their resource.
pub type Values = BTreeMap<String, Vec<u8>>;

/// A plan with the values of its parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stage {
    /// What runs.
    pub plan: Plan,
    /// Values of its parameters.
    pub values: Values,
}

/// What comes next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Run this.
    Run(Box<Stage>),
    /// Everything is done.
    Done,
}

impl Step {
    /// A step that runs `plan` with `values`.
    #[must_use]
    pub fn run(plan: Plan, values: Values) -> Self {
        Self::Run(Box::new(Stage { plan, values }))
    }
}

/// Plans in a row. Persistent resources live as long as one run of a program.
pub trait Program {
    /// The stage number `index`, from 0. `decision` is the last stage's decision buffer; empty where it had none.
    fn step(&self, index: usize, decision: &[u32]) -> Step;
}

/// A part of an output that stays on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Delivery {
    /// The buffer of the stage.
    pub output: ResourceId,
    /// The result, among all that the caller wants, of which it is a part.
    pub result: &'static str,
    /// Where the part begins in the output, in bytes; a multiple of four.
    pub source: u64,
    /// Where it begins in the result.
    pub target: u64,
    /// How long it is.
    pub bytes: u64,
}

/// A program whose results stay on the device. Outputs of its plans are a few counts.
pub trait DeviceProgram {
    /// As [`Program::step`], with what the stage leaves in the results; `None` after the last.
    fn step_on_device(&self, index: usize, decision: &[u32]) -> Option<(Stage, Vec<Delivery>)>;
}
