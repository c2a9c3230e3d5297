//! Triangle meshes as the caller gives them: float64 positions, his own vertex and triangle order, never changed.

use crate::error::SceneError;

/// The most triangles a scene may have; indices stay below 2^32 in every buffer.
pub const MAX_TRIANGLES: u64 = 1 << 27;

/// How a surface reflects the light in a picture, and how much of it passes. Visibility depends on the opacity alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Linear reflectance of the Lambert lobe, red, green, blue in 0..=1.
    pub base_color: [f32; 3],
    /// glTF roughness in 0..=1; the exponent of the Blinn lobe follows from it.
    pub roughness: f32,
    /// Linear strength of the Blinn lobe at normal incidence; 0 leaves a pure Lambert surface.
    pub specular: f32,
    /// Share of the light that is lost where it crosses a triangle, from either side: 1 lets nothing through, and with 0 the triangle is
    /// not there at all. A closed box of opacity 0.5 is crossed twice and passes a quarter.
    pub opacity: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self { base_color: [0.8; 3], roughness: 1.0, specular: 0.0, opacity: 1.0 }
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
    /// Opacity of each triangle where that differs; else empty, and the material's is that of all.
    pub opacities: Vec<f32>,
}

impl Mesh {
    /// A mesh from arrays, checked: every coordinate finite, every index in range, the material's opacity in 0..=1.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] and [`SceneError::IndexOutOfRange`] name the first bad row, [`SceneError::Invalid`] the opacity.
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
        if !is_opacity(material.opacity) {
            return Err(SceneError::invalid(format!("mesh '{name}' opacity"), no_opacity(material.opacity)));
        }
        Ok(Self { name, vertices, triangles, material, opacities: Vec::new() })
    }

    /// The same mesh with an opacity for each triangle instead of the material's.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for another number of them than of triangles, and for the first that does not lie in 0..=1.
    pub fn with_opacities(mut self, opacities: Vec<f32>) -> Result<Self, SceneError> {
        let what = || format!("mesh '{}' opacities", self.name);
        if opacities.len() != self.triangles.len() {
            let reason = format!("{} given for {} triangles", opacities.len(), self.triangles.len());
            return Err(SceneError::invalid(what(), reason));
        }
        if let Some(triangle) = opacities.iter().position(|o| !is_opacity(*o)) {
            let reason = format!("triangle {triangle}: {}", no_opacity(opacities[triangle]));
            return Err(SceneError::invalid(what(), reason));
        }
        self.opacities = opacities;
        Ok(self)
    }

    /// Opacity of one of its triangles.
    #[must_use]
    pub fn opacity(&self, triangle: usize) -> f32 {
        self.opacities.get(triangle).copied().unwrap_or(self.material.opacity)
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
        Ok(Self { vertices, ..self.clone() })
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

fn is_opacity(opacity: f32) -> bool {
    (0.0..=1.0).contains(&opacity)
}

fn no_opacity(value: f32) -> String {
    format!("{value} is no opacity; it is a number from 0, invisible, to 1, opaque")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roof(opacity: f32) -> Result<Mesh, SceneError> {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new("roof", vertices, vec![[0, 1, 2], [0, 2, 3]], Material { opacity, ..Material::default() })
    }

    #[test]
    fn opacities_are_checked_and_named() {
        for opacity in [0.0, 0.3, 1.0] {
            assert_eq!(roof(opacity).unwrap().opacity(1), opacity);
        }
        for opacity in [-0.1, 1.5, f32::NAN, f32::INFINITY] {
            let message = roof(opacity).unwrap_err().to_string();
            let expected = format!("mesh 'roof' opacity: {opacity} is no opacity; ");
            assert!(message.starts_with(&expected), "{message}");
        }
        let each = roof(1.0).unwrap().with_opacities(vec![0.25, 1.0]).unwrap();
        assert_eq!([each.opacity(0), each.opacity(1)], [0.25, 1.0]);
        let message = |opacities| roof(1.0).unwrap().with_opacities(opacities).unwrap_err().to_string();
        assert_eq!(message(vec![0.5]), "mesh 'roof' opacities: 1 given for 2 triangles");
        assert!(message(vec![0.5, -1.0]).starts_with("mesh 'roof' opacities: triangle 1: -1 is no opacity; "));
        assert!(message(vec![f32::NAN, -1.0]).starts_with("mesh 'roof' opacities: triangle 0: NaN is no opacity; "));
    }
}
