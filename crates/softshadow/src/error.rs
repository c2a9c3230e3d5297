//! Everything that a call can end in, by what the caller can do about it.

use softshadow_plan::EngineError;
use softshadow_plan::PlanError;
use softshadow_scene::SceneError;
use softshadow_techniques::TechniqueError;

use crate::choose::BoundNotMet;

/// Why a call gave no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene, a light, the camera or the receivers cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A setting is out of range.
    #[error("{0}")]
    Settings(String),
    /// No device of the kind that was asked for; the message says what installs one.
    #[error("{0}")]
    Device(String),
    /// More than the device or the memory limit takes; nothing was allocated.
    #[error("{what}: {needed} needed, at most {limit} possible")]
    TooLarge {
        /// What is too large.
        what: String,
        /// How much was needed.
        needed: u64,
        /// How much is possible.
        limit: u64,
    },
    /// The device ran out of memory.
    #[error("{0}")]
    OutOfMemory(String),
    /// The device was lost, refused a command or did not finish. The next call opens it again.
    #[error("{0}")]
    Gpu(String),
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A file could not be written.
    #[error("{0}")]
    File(String),
    /// Results that cannot be compared.
    #[error("{0}")]
    Measure(String),
    /// No setting of any technique keeps what was asked for; the best result comes with it.
    #[error("{}", .0.reason)]
    BoundNotMet(Box<BoundNotMet>),
}

impl From<TechniqueError> for Error {
    fn from(error: TechniqueError) -> Self {
        match error {
            TechniqueError::Scene(error) => Self::Scene(error),
            other => Self::Settings(other.to_string()),
        }
    }
}

impl From<EngineError> for Error {
    fn from(error: EngineError) -> Self {
        let words = error.to_string();
        match error {
            EngineError::NoAdapter { .. } | EngineError::NoDevice { .. } => Self::Device(words),
            EngineError::OutOfMemory { .. } => Self::OutOfMemory(words),
            EngineError::Interrupted => Self::Interrupted,
            EngineError::Plan(PlanError::TooLarge { what, needed, limit }) => Self::TooLarge { what, needed, limit },
            _ => Self::Gpu(words),
        }
    }
}
