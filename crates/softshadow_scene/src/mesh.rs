//! Triangle meshes as the caller gives them: float64 positions, his own vertex and triangle order, never changed.

use crate::error::SceneError;

/// The most triangles a scene may have; indices stay below 2^32 in every buffer.
pub const MAX_TRIANGLES: u64 = 1 << 27;

/// How a surface reflects the light in a picture. Visibility does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Linear reflectance of the Lambert lobe, red, green, blue in 0..=1.
    pub base_color: [f32; 3],
    /// glTF roughness in 0..=1; the exponent of the Blinn lobe follows from it.
    pub roughness: f32,
    /// Linear strength of the Blinn lobe at normal incidence; 0 leaves a pure Lambert surface.
    pub specular: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self { base_color: [0.8; 3], roughness: 1.0, specular: 0.0 }
    }
}

/// One mesh in world space. Triangles are two-sided; the mesh may be open, non-manifold or inconsistently wound.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// What error messages call it.
    pub name: String,
    /// Positions in world units.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, three a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// One material for the whole mesh.
    pub material: Material,
}

impl Mesh {
    /// A mesh from arrays, checked: every coordinate finite, every index in range.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] and [`SceneError::IndexOutOfRange`] name the first bad row.
    pub fn new(
        name: impl Into<String>,
        vertices: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        material: Material,
    ) -> Result<Self, SceneError> {
        let name = name.into();
        check_finite(&name, &vertices)?;
        let count = vertices.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
                return Err(SceneError::IndexOutOfRange {
                    mesh: name,
                    triangle,
                    vertex: u64::from(vertex),
                    vertices: count,
                });
            }
        }
        Ok(Self { name, vertices, triangles, material })
    }

    /// The same triangles between other vertices.
    ///
    /// # Errors
    /// [`SceneError::VertexCount`] for another number of them, [`SceneError::NotFinite`] names the first without a position.
    pub fn with_vertices(&self, vertices: Vec<[f64; 3]>) -> Result<Self, SceneError> {
        let (given, expected) = (vertices.len(), self.vertices.len());
        if given != expected {
            return Err(SceneError::VertexCount { mesh: self.name.clone(), given, expected });
        }
        check_finite(&self.name, &vertices)?;
        Ok(Self { name: self.name.clone(), vertices, triangles: self.triangles.clone(), material: self.material })
    }

    /// The same mesh with every vertex moved by an affine row-major matrix of column-vector mathematics.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] when the matrix or a moved vertex is not finite.
    pub fn transformed(mut self, world_from_mesh: &[[f64; 4]; 4]) -> Result<Self, SceneError> {
        let m = world_from_mesh;
        for (index, v) in self.vertices.iter_mut().enumerate() {
            let moved = [0, 1, 2].map(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2] + m[r][3]);
            if !moved.iter().all(|x| x.is_finite()) {
                return Err(SceneError::NotFinite {
                    what: format!("mesh '{}' transformed vertices", self.name),
                    index,
                });
            }
            *v = moved;
        }
        Ok(self)
    }
}

fn check_finite(name: &str, vertices: &[[f64; 3]]) -> Result<(), SceneError> {
    match vertices.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
        Some(index) => Err(SceneError::NotFinite { what: format!("mesh '{name}' vertices"), index }),
        None => Ok(()),
    }
}
