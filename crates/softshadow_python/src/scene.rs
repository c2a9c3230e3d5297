//! Meshes in world space.

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use softshadow::{Error, Material, Mesh};

use crate::arrays::rows;
use crate::detached::detached;

/// Name, flat vertices, flat faces, base colour, roughness, specular, opacity, and that of each triangle where they differ.
type FlatMesh<'py> = (
    String,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u32>>,
    [f32; 3],
    f32,
    f32,
    f32,
    Option<Bound<'py, PyArray1<f32>>>,
);

/// A checked scene.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct Scene(pub(crate) softshadow::Scene);

/// One mesh as Python gives it.
#[derive(FromPyObject)]
struct MeshArrays<'py>(
    String,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, u32>,
    [f32; 3],
    f32,
    f32,
    f32,
    Option<PyReadonlyArray1<'py, f32>>,
);

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, meshes: Vec<MeshArrays<'_>>, notes: Vec<String>) -> PyResult<Self> {
        let copies = meshes
            .into_iter()
            .map(|MeshArrays(name, vertices, faces, base_color, roughness, specular, opacity, opacities)| {
                let material = Material { base_color, roughness, specular, opacity };
                let opacities = opacities.map(|each| each.as_slice().map(<[f32]>::to_vec)).transpose()?;
                Ok((name, rows(&vertices)?, rows(&faces)?, material, opacities))
            })
            .collect::<PyResult<Vec<_>>>()?;
        detached(py, || {
            let meshes = copies.into_iter().map(|(name, vertices, faces, material, opacities)| {
                let mesh = Mesh::new(name, vertices, faces, material)?;
                match opacities {
                    Some(each) => mesh.with_opacities(each),
                    None => Ok(mesh),
                }
            });
            let scene = meshes.collect::<Result<_, _>>().and_then(softshadow::Scene::new).map_err(Error::Scene)?;
            Ok(Self(notes.into_iter().fold(scene, softshadow::Scene::with_note)))
        })
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        detached(py, || softshadow::scene_file::load(&path).map(Self).map_err(Error::Scene))
    }

    /// Copies of all meshes.
    fn meshes<'py>(&self, py: Python<'py>) -> Vec<FlatMesh<'py>> {
        let flat = |mesh: &Mesh| {
            let Material { base_color, roughness, specular, opacity } = mesh.material;
            let vertices = mesh.vertices.as_flattened().to_vec().into_pyarray(py);
            let faces = mesh.triangles.as_flattened().to_vec().into_pyarray(py);
            let opacities = (!mesh.opacities.is_empty()).then(|| mesh.opacities.clone().into_pyarray(py));
            (mesh.name.clone(), vertices, faces, base_color, roughness, specular, opacity, opacities)
        };
        self.0.meshes().iter().map(flat).collect()
    }

    /// Another frame: one array or `None` a mesh.
    fn with_vertices(&self, py: Python<'_>, vertices: Vec<Option<PyReadonlyArray2<'_, f64>>>) -> PyResult<Self> {
        let copies = vertices.iter().map(|given| given.as_ref().map(rows).transpose()).collect::<PyResult<_>>()?;
        detached(py, || self.0.with_vertices(copies).map(Self).map_err(Error::Scene))
    }

    /// What a file held that is left out.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes().to_vec()
    }

    /// Corners of the smallest box around all vertices.
    #[getter]
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.0.bounds()
    }

    /// Degenerate triangles included.
    #[getter]
    fn triangle_count(&self) -> usize {
        self.0.triangle_count()
    }
}

/// Base colour, roughness, specular and opacity of a mesh that has no material.
#[pyfunction]
pub(crate) fn default_material() -> ([f32; 3], f32, f32, f32) {
    let Material { base_color, roughness, specular, opacity } = Material::default();
    (base_color, roughness, specular, opacity)
}
