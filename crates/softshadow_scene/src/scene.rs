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
    topology: u64,
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
    /// [`SceneError::TooLarge`] above [`MAX_TRIANGLES`], and for more vertices than 32-bit indices count.
    pub fn new(meshes: Vec<Mesh>) -> Result<Self, SceneError> {
        let needed = meshes.iter().map(|m| m.triangles.len() as u64).sum();
        if needed > MAX_TRIANGLES {
            return Err(SceneError::TooLarge { what: "triangles of the scene".into(), needed, limit: MAX_TRIANGLES });
        }
        let vertices = meshes.iter().map(|m| m.vertices.len() as u64).sum();
        let limit = u64::from(u32::MAX);
        if vertices > limit {
            return Err(SceneError::TooLarge { what: "vertices of the scene".into(), needed: vertices, limit });
        }
        let identity = next_identity();
        Ok(Self { meshes, notes: Vec::new(), identity, topology: identity })
    }

    /// The same meshes with other vertices: the next frame of a scene that moves. `None` leaves a mesh where it is.
    ///
    /// The new scene remembers what it came from. A call with it keeps the order of the triangles, the edges and the hierarchies of the
    /// last frame, as far as they serve, and only puts their positions and boxes in place.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] unless there is one entry a mesh, [`SceneError::VertexCount`] for the first mesh with another number of
    /// vertices, [`SceneError::NotFinite`] for the first vertex without a position.
    pub fn with_vertices(&self, vertices: Vec<Option<Vec<[f64; 3]>>>) -> Result<Self, SceneError> {
        let (given, meshes) = (vertices.len(), self.meshes.len());
        if given != meshes {
            let reason = format!("{given} entries given, but there are {meshes} meshes; give one a mesh");
            return Err(SceneError::invalid("vertices of the scene", reason));
        }
        let moved = self.meshes.iter().zip(vertices).map(|(mesh, vertices)| match vertices {
            Some(vertices) => mesh.with_vertices(vertices),
            None => Ok(mesh.clone()),
        });
        Ok(Self {
            meshes: moved.collect::<Result<_, _>>()?,
            notes: self.notes.clone(),
            identity: next_identity(),
            topology: self.topology,
        })
    }

    /// A number that this scene and its clones share with no other: what was made from its meshes can be kept under it.
    #[must_use]
    pub fn identity(&self) -> u64 {
        self.identity
    }

    /// A number that a scene shares with all that were made from it by [`Scene::with_vertices`]: their triangles join the same vertices.
    #[must_use]
    pub fn topology(&self) -> u64 {
        self.topology
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

fn next_identity() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
