//! Programs: a few plans in a row. The next stage is a pure function of a few integers read back from the last.

use std::collections::BTreeMap;

use crate::plan::Plan;

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
