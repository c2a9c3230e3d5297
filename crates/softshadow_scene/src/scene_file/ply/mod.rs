//! PLY (Turk 1994): vertices and faces, as text or binary in either byte order.
//!
//! The reader is our own: text keeps the digits that float32 has no room for, whatever type its header names, and every count is
//! held against the bytes that are there before a row is read.

mod header;
mod values;

use std::collections::BTreeSet;
use std::path::Path;

use self::header::{Element, Header, Kind};
use self::values::Values;
use super::{invalid, polygon};
use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Material, Mesh};
use crate::scene::Scene;

/// Names under which faces keep their corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// First words of colours, of vertices and of faces.
const COLORS: [&str; 4] = ["red", "diffuse_red", "r", "rgb"];

/// All faces as one mesh.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    let (header, body) = Header::read(bytes).map_err(|reason| invalid(path, reason))?;
    let mut values = Values::new(header.encoding, body);
    let mut contents = Contents::default();
    for element in &header.elements {
        let broken = |reason: String| invalid(path, format!("element '{}': {reason}", element.name));
        values.check_room(element).map_err(broken)?;
        match element.name.as_str() {
            "vertex" => contents.read_vertices(&mut values, element).map_err(broken)?,
            "face" => contents.read_faces(&mut values, element)?.map_err(broken)?,
            name => {
                contents.notes.insert(format!("element '{name:.40}' left out"));
                values.skip(element).map_err(broken)?;
            }
        }
    }
    contents.into_scene(path)
}

#[derive(Default)]
struct Contents {
    vertices: Vec<[f64; 3]>,
    /// The corners of all faces in a row, and how many each face has.
    corners: Vec<u32>,
    lengths: Vec<u32>,
    notes: BTreeSet<String>,
}

impl Contents {
    fn read_vertices(&mut self, values: &mut Values, element: &Element) -> Result<(), String> {
        self.note_colors(element, "vertex colours left out");
        let mut axes = [0; 3];
        for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
            let place = element.properties.iter().position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)));
            *axis = place.ok_or_else(|| format!("it has no number '{name}'"))?;
        }
        let mut scalars = Vec::new();
        for row in 0..element.rows {
            values.read_row(element, &mut scalars, None).map_err(|reason| format!("row {row}: {reason}"))?;
            self.vertices.push(axes.map(|axis| scalars.get(axis).copied().unwrap_or(f64::NAN)));
        }
        Ok(())
    }

    /// The outer error is a limit of the library, the inner one what is wrong with the element.
    fn read_faces(&mut self, values: &mut Values, element: &Element) -> Result<Result<(), String>, SceneError> {
        self.note_colors(element, "face colours left out");
        let is_list = |kind| matches!(kind, Kind::List { .. });
        let place = element.properties.iter().position(|p| CORNERS.contains(&p.name.as_str()) && is_list(p.kind));
        let Some(place) = place else {
            return Ok(Err(format!("it has no list '{}' or '{}'", CORNERS[0], CORNERS[1])));
        };
        let (mut scalars, mut list, mut triangles) = (Vec::new(), Vec::new(), 0);
        for row in 0..element.rows {
            list.clear();
            let read = values.read_row(element, &mut scalars, Some((place, &mut list)));
            if let Err(reason) = read.and_then(|()| self.push_face(&list)) {
                return Ok(Err(format!("row {row}: {reason}")));
            }
            triangles += list.len() as u64 - 2;
            if triangles > MAX_TRIANGLES {
                let what = "triangles of the scene".into();
                return Err(SceneError::TooLarge { what, needed: triangles, limit: MAX_TRIANGLES });
            }
        }
        Ok(Ok(()))
    }

    fn push_face(&mut self, list: &[f64]) -> Result<(), String> {
        if list.len() < 3 {
            return Err(format!("a face needs 3 corners, here are {}", list.len()));
        }
        for &corner in list {
            if !(corner >= 0.0 && corner <= f64::from(u32::MAX) && corner.fract() == 0.0) {
                return Err(format!("{corner} is not the number of a vertex"));
            }
            self.corners.push(corner as u32);
        }
        self.lengths.push(u32::try_from(list.len()).map_err(|_| "it has too many corners")?);
        Ok(())
    }

    fn note_colors(&mut self, element: &Element, note: &str) {
        if element.properties.iter().any(|p| COLORS.contains(&p.name.as_str())) {
            self.notes.insert(note.into());
        }
    }

    fn into_scene(mut self, path: &Path) -> Result<Scene, SceneError> {
        let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        if self.lengths.is_empty() {
            let others: Vec<_> = self.notes.iter().map(|note| format!("; {note}")).collect();
            return Err(invalid(path, format!("it has no faces{}; export triangles or polygons", others.concat())));
        }
        let (mut triangles, mut rest, mut doubtful) = (Vec::with_capacity(self.lengths.len()), &self.corners[..], 0);
        for &length in &self.lengths {
            let (face, behind) = rest.split_at_checked(length as usize).unwrap_or((rest, &[]));
            rest = behind;
            if let Some(&vertex) = face.iter().find(|&&corner| corner as usize >= self.vertices.len()) {
                let (triangle, vertex, vertices) = (triangles.len(), u64::from(vertex), self.vertices.len());
                return Err(SceneError::IndexOutOfRange { mesh: name, triangle, vertex, vertices });
            }
            doubtful += u64::from(!polygon::cut(&self.vertices, face, &mut triangles));
        }
        if doubtful > 0 {
            self.notes.insert(format!(
                "{doubtful} polygons were cut into fans around their first corner, which may be wrong"
            ));
        }
        let scene = Scene::new(vec![Mesh::new(name, self.vertices, triangles, Material::default())?])?;
        Ok(self.notes.into_iter().fold(scene, Scene::with_note))
    }
}

#[cfg(test)]
mod tests;
