//! A scene: meshes in world space, plus what reading them left out.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Mesh};

/// Meshes in world space. Triangle ids count through the meshes in order, as the caller gave them.
#[derive(Debug, Clone)]
pub struct Scene {
    meshes: Vec<Mesh>,
    notes: Vec<String>,
    identity: u64,
}

impl PartialEq for Scene {
    fn eq(&self, other: &Self) -> bool {
        self.meshes == other.meshes && self.notes == other.notes
    }
}

impl Scene {
    /// A scene of checked meshes.
    ///
    /// # Errors
    /// [`SceneError::TooLarge`] above [`MAX_TRIANGLES`].
    pub fn new(meshes: Vec<Mesh>) -> Result<Self, SceneError> {
        let needed = meshes.iter().map(|m| m.triangles.len() as u64).sum();
        if needed > MAX_TRIANGLES {
            return Err(SceneError::TooLarge { what: "triangles of the scene".into(), needed, limit: MAX_TRIANGLES });
        }
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Ok(Self { meshes, notes: Vec::new(), identity: NEXT.fetch_add(1, Ordering::Relaxed) })
    }

    /// A number that this scene and its clones share with no other: what was made from its meshes can be kept under it.
    #[must_use]
    pub fn identity(&self) -> u64 {
        self.identity
    }

    /// The meshes in the order in which they were given.
    #[must_use]
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// What a file held that the library does not model, in words.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Adds a sentence about something that was left out.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// How many triangles there are, degenerate ones included.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.meshes.iter().map(|m| m.triangles.len()).sum()
    }

    /// The smallest box around all vertices, or `None` where there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.meshes.iter().flat_map(|m| &m.vertices).fold(None, |bounds, v| {
            let (low, high) = bounds.unwrap_or((*v, *v));
            Some(([0, 1, 2].map(|k| low[k].min(v[k])), [0, 1, 2].map(|k| high[k].max(v[k]))))
        })
    }
}
