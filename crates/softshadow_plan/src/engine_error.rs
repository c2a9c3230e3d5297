//! What can go wrong between a plan and its results, as values: nothing here panics, and nothing prints.

use crate::check::PlanError;

/// A plan that did not run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// No adapter of the kind that was asked for.
    #[error(
        "no {wanted} adapter found. On Debian or Ubuntu a software Vulkan driver is installed by \
         `apt-get install -y mesa-vulkan-drivers libvulkan1`"
    )]
    NoAdapter {
        /// What was asked for.
        wanted: String,
    },
    /// The adapter gave no device.
    #[error("adapter '{adapter}' gives no device: {reason}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// The driver's words.
        reason: String,
    },
    /// The plan contradicts itself or the host.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A parameter or upload of the plan was not given, or has the wrong size.
    #[error("stage '{stage}', '{resource}': {problem}")]
    Contents {
        /// The plan.
        stage: String,
        /// The resource.
        resource: String,
        /// What is wrong.
        problem: String,
    },
    /// The device has no memory left.
    #[error("the device is out of memory while running '{stage}': {reason}")]
    OutOfMemory {
        /// The plan.
        stage: String,
        /// The driver's words.
        reason: String,
    },
    /// The driver refuses something that the checks let pass.
    #[error("the device refuses '{stage}': {reason}")]
    Refused {
        /// The plan.
        stage: String,
        /// The driver's words.
        reason: String,
    },
    /// The device is gone; a new one works.
    #[error("the device was lost while running '{stage}': {reason}")]
    DeviceLost {
        /// The plan.
        stage: String,
        /// The driver's words.
        reason: String,
    },
    /// The device did not finish in time.
    #[error("the device did not finish '{stage}' within {seconds} s")]
    Timeout {
        /// The plan.
        stage: String,
        /// How long was waited.
        seconds: u64,
    },
    /// A kernel that this engine does not have.
    #[error("{engine} cannot run '{pass}': it has no {kernel}; {way_out}")]
    NoKernel {
        /// The engine.
        engine: &'static str,
        /// The pass.
        pass: String,
        /// The kernel.
        kernel: String,
        /// What to do instead.
        way_out: &'static str,
    },
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl EngineError {
    /// A parameter or upload that is missing or has the wrong size.
    pub fn contents(stage: &str, resource: &str, problem: impl Into<String>) -> Self {
        Self::Contents { stage: stage.to_owned(), resource: resource.to_owned(), problem: problem.into() }
    }
}
