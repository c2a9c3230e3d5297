//! What can be wrong with a shader, always with the file and line in which it was written.

/// A shader that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShaderError {
    /// No such file in `shaders_wgsl/`.
    #[error("no shader file '{file}'")]
    UnknownFile {
        /// The path asked for.
        file: String,
    },
    /// An import of a file that does not exist.
    #[error("{file}:{line}: imports '{import}', which does not exist")]
    UnknownImport {
        /// The importing file.
        file: String,
        /// Line of the import.
        line: usize,
        /// What it asks for.
        import: String,
    },
    /// Files that import each other.
    #[error("{file}:{line}: importing '{import}' closes a circle")]
    CircularImport {
        /// The importing file.
        file: String,
        /// Line of the import.
        line: usize,
        /// What it asks for.
        import: String,
    },
    /// An import below the first line of code, where nobody looks for it.
    #[error("{file}:{line}: imports stand at the top of a file")]
    LateImport {
        /// The importing file.
        file: String,
        /// Line of the import.
        line: usize,
    },
    /// naga's parser or validator refuses the text.
    #[error("{file}:{line}: {message}")]
    Rejected {
        /// The file in which the line was written.
        file: String,
        /// The line in that file.
        line: usize,
        /// naga's words.
        message: String,
    },
}
