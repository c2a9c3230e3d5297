//! Everything that can be wrong with a scene, a light, a camera or receivers, each with what to do about it.

use std::path::PathBuf;

/// A scene, light, camera or receiver that cannot be used. Messages name the thing, the first bad index and the fix.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file does not exist or cannot be read.
    #[error("cannot read {path}: {reason}", path = path.display())]
    FileUnreadable {
        /// The path as given.
        path: PathBuf,
        /// The operating system's words.
        reason: String,
    },
    /// The extension is none that can be read.
    #[error("{path}: unknown format '{extension}'; readable are .glb, .gltf, .obj, .ply, .stl and .json", path = path.display())]
    UnknownFormat {
        /// The path as given.
        path: PathBuf,
        /// Its extension, lower case, without the dot.
        extension: String,
    },
    /// The file is of a known format but broken: truncated, inconsistent or not what it says it is.
    #[error("{path}: {reason}", path = path.display())]
    FileInvalid {
        /// The path as given.
        path: PathBuf,
        /// What is wrong, with the element's name or index.
        reason: String,
    },
    /// A triangle refers to a vertex that is not there.
    #[error("mesh '{mesh}': triangle {triangle} refers to vertex {vertex}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The mesh's name.
        mesh: String,
        /// Index of the first bad triangle.
        triangle: usize,
        /// The vertex it asks for.
        vertex: u64,
        /// How many there are.
        vertices: usize,
    },
    /// Moved vertices that are not as many as the mesh has.
    #[error(
        "mesh '{mesh}': {given} moved vertices given, but its triangles join {expected}; give one position a vertex"
    )]
    VertexCount {
        /// The mesh's name.
        mesh: String,
        /// How many were given.
        given: usize,
        /// How many there are.
        expected: usize,
    },
    /// A number is NaN, infinite or too large for float32 after recentring.
    #[error("{what}: entry {index} is not finite")]
    NotFinite {
        /// What holds the number, for example `mesh 'bunny' vertices`.
        what: String,
        /// Index of the first bad row.
        index: usize,
    },
    /// More than the library takes; nothing was allocated.
    #[error("{what}: {needed} needed, at most {limit} possible")]
    TooLarge {
        /// What is too large.
        what: String,
        /// How many were asked for.
        needed: u64,
        /// How many are possible.
        limit: u64,
    },
    /// A value that has no meaning, with the fix in its words.
    #[error("{what}: {reason}")]
    Invalid {
        /// The parameter.
        what: String,
        /// Why it cannot be, and what can.
        reason: String,
    },
}

impl SceneError {
    pub(crate) fn invalid(what: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Invalid { what: what.into(), reason: reason.into() }
    }
}
