//! The driver's errors as ours.

use softshadow_plan::EngineError;

/// What a driver says of a stage.
pub(crate) fn from_wgpu(stage: &str, error: &wgpu::Error) -> EngineError {
    let stage = stage.to_owned();
    match error {
        wgpu::Error::OutOfMemory { source } => EngineError::OutOfMemory { stage, reason: source.to_string() },
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            EngineError::Refused { stage, reason: description.clone() }
        }
    }
}
