//! What can end the benchmark, or a part of it.

use std::path::PathBuf;

use crate::case::CaseError;

/// Why something was not measured.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BenchError {
    /// The scene is known, but its mesh is not on this machine: skipped by name, and counted.
    #[error("{path} is missing; set SOFTSHADOW_MESHES to a folder that has it", path = path.display())]
    MissingMesh { path: PathBuf },
    #[error("scene '{name}': choose one of {known}, or a mesh such as cow.obj")]
    UnknownScene { name: String, known: String },
    #[error("mesh '{name}' has no height")]
    Flat { name: String },
    #[error(transparent)]
    Case(#[from] CaseError),
    #[error(transparent)]
    Library(#[from] softshadow::Error),
    #[error("{what}: {reason}")]
    File { what: String, reason: String },
}

impl From<softshadow::SceneError> for BenchError {
    fn from(error: softshadow::SceneError) -> Self {
        Self::Library(error.into())
    }
}

impl BenchError {
    pub(crate) fn file(what: impl Into<String>, reason: impl ToString) -> Self {
        Self::File { what: what.into(), reason: reason.to_string() }
    }
}
