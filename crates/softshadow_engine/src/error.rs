//! What can go wrong between a plan and its results, as values: nothing here panics, and nothing prints.

use softshadow_plan::PlanError;

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
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl EngineError {
    pub(crate) fn contents(stage: &str, resource: &str, problem: impl Into<String>) -> Self {
        Self::Contents { stage: stage.to_owned(), resource: resource.to_owned(), problem: problem.into() }
    }

    pub(crate) fn from_wgpu(stage: &str, error: &wgpu::Error) -> Self {
        let stage = stage.to_owned();
        match error {
            wgpu::Error::OutOfMemory { source } => Self::OutOfMemory { stage, reason: source.to_string() },
            wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
                Self::Refused { stage, reason: description.clone() }
            }
        }
    }
}
