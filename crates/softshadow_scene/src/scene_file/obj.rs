//! Wavefront OBJ: `v`, `f`, `o` and `g`. Positions are read in float64, because scenes may live at map coordinates
//! where float32 has steps of centimetres.

use std::collections::BTreeSet;
use std::path::Path;

use super::{MAX_MESHES, check_limit, invalid};
use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Material, Mesh};
use crate::scene::Scene;

/// Statements of the format that do not change where a polygon lies.
const HARMLESS: [&str; 9] = ["vt", "vn", "s", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj"];
/// Statements with something that is left out; each is named once in the notes.
const LEFT_OUT: [&str; 26] = [
    "vp",
    "p",
    "l",
    "mtllib",
    "usemtl",
    "maplib",
    "usemap",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "trace_obj",
    "ctech",
    "stech",
    "call",
    "csh",
];

/// Triangles under one `o` or `g` statement, with indices into the vertices of the whole file.
struct Group {
    name: String,
    triangles: Vec<[u32; 3]>,
}

#[derive(Default)]
struct Contents {
    vertices: Vec<[f64; 3]>,
    groups: Vec<Group>,
    triangle_count: u64,
    notes: BTreeSet<&'static str>,
}

/// Each `o` or `g` that has faces becomes a mesh. A file with one such group keeps its vertices as they are; of
/// several, each keeps those that it uses, in the file's order.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    // Only names can be anything but ASCII, so a lossy conversion loses no geometry.
    let text = String::from_utf8_lossy(bytes);
    let mut contents = Contents::default();
    let mut continued = String::new();
    for (line_index, line) in text.lines().enumerate() {
        if let Some(head) = line.strip_suffix('\\') {
            continued.push_str(head);
            continued.push(' ');
            continue;
        }
        let joined = (!continued.is_empty()).then(|| std::mem::take(&mut continued) + line);
        let statement = joined.as_deref().unwrap_or(line);
        let statement = statement.split_once('#').map_or(statement, |(before, _)| before);
        contents.read_statement(statement, path, line_index + 1)?;
    }
    if !continued.is_empty() {
        return Err(invalid(path, "the last line ends in '\\'; the file is truncated"));
    }
    contents.into_scene(path)
}

impl Contents {
    fn read_statement(&mut self, statement: &str, path: &Path, line: usize) -> Result<(), SceneError> {
        let mut words = statement.split_whitespace();
        match words.next() {
            None => {}
            Some("v") => self.read_vertex(words, path, line)?,
            Some("f") => self.read_face(words, path, line)?,
            Some("o" | "g") => {
                let name = words.collect::<Vec<_>>().join(" ");
                // One without a face is no mesh.
                self.groups.pop_if(|group| group.triangles.is_empty());
                check_limit("meshes of the scene", self.groups.len() as u64 + 1, MAX_MESHES)?;
                self.groups.push(Group { name, triangles: Vec::new() });
            }
            Some(keyword) if HARMLESS.contains(&keyword) => {}
            Some(keyword) => match LEFT_OUT.iter().find(|known| **known == keyword) {
                Some(known) => {
                    self.notes.insert(known);
                }
                None => return Err(invalid(path, format!("line {line}: unknown statement '{keyword}'"))),
            },
        }
        Ok(())
    }

    /// Three coordinates; a weight or a colour may follow and is ignored.
    fn read_vertex<'a>(
        &mut self,
        words: impl Iterator<Item = &'a str>,
        path: &Path,
        line: usize,
    ) -> Result<(), SceneError> {
        let mut vertex = [0.0; 3];
        let mut count = 0;
        for word in words {
            let number: f64 =
                word.parse().map_err(|_| invalid(path, format!("line {line}: '{word}' is not a number")))?;
            if let Some(coordinate) = vertex.get_mut(count) {
                *coordinate = number;
            }
            count += 1;
        }
        if count < 3 {
            return Err(invalid(path, format!("line {line}: a vertex needs 3 coordinates, here are {count}")));
        }
        if !vertex.iter().all(|x| x.is_finite()) {
            let what = format!("{} line {line}, vertices", path.display());
            return Err(SceneError::NotFinite { what, index: self.vertices.len() });
        }
        self.vertices.push(vertex);
        Ok(())
    }

    /// A polygon, cut into a fan around its first corner.
    fn read_face<'a>(
        &mut self,
        words: impl Iterator<Item = &'a str>,
        path: &Path,
        line: usize,
    ) -> Result<(), SceneError> {
        let (mut first, mut last, mut corners) = (0, 0, 0_usize);
        for word in words {
            let corner = self.read_corner(word, path, line)?;
            match corners {
                0 => first = corner,
                1 => {}
                _ => self.push_triangle([first, last, corner])?,
            }
            last = corner;
            corners += 1;
        }
        if corners < 3 {
            return Err(invalid(path, format!("line {line}: a face needs 3 corners, here are {corners}")));
        }
        if corners > 3 {
            self.notes.insert("f");
        }
        Ok(())
    }

    /// The vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`, from 0. Positive numbers count from the file's first vertex,
    /// negative ones back from the newest.
    fn read_corner(&self, word: &str, path: &Path, line: usize) -> Result<u32, SceneError> {
        let malformed = || invalid(path, format!("line {line}: '{word}' is not a corner of a face"));
        let mut parts = word.split('/');
        let number: i64 = parts.next().unwrap_or_default().parse().map_err(|_| malformed())?;
        let others_are_integers = parts.clone().all(|p| p.is_empty() || p.parse::<i64>().is_ok());
        if !others_are_integers || parts.count() > 2 || word.ends_with('/') {
            return Err(malformed());
        }
        let newest = i64::try_from(self.vertices.len()).unwrap_or(i64::MAX);
        let index = if number < 0 { newest.checked_add(number) } else { number.checked_sub(1) };
        match index {
            Some(index) if index >= 0 => u32::try_from(index).map_err(|_| SceneError::IndexOutOfRange {
                mesh: self.mesh_name(self.groups.last(), path),
                triangle: self.groups.last().map_or(0, |g| g.triangles.len()),
                vertex: index.unsigned_abs(),
                vertices: self.vertices.len(),
            }),
            _ => Err(invalid(path, format!("line {line}: '{word}' is before the first vertex, which is 1"))),
        }
    }

    fn push_triangle(&mut self, triangle: [u32; 3]) -> Result<(), SceneError> {
        self.triangle_count += 1;
        check_limit("triangles of the scene", self.triangle_count, MAX_TRIANGLES)?;
        match self.groups.last_mut() {
            Some(group) => group.triangles.push(triangle),
            None => self.groups.push(Group { name: String::new(), triangles: vec![triangle] }),
        }
        Ok(())
    }

    fn mesh_name(&self, group: Option<&Group>, path: &Path) -> String {
        match group {
            Some(group) if !group.name.is_empty() => group.name.clone(),
            _ => path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default(),
        }
    }

    fn into_scene(mut self, path: &Path) -> Result<Scene, SceneError> {
        let mut groups = std::mem::take(&mut self.groups);
        groups.retain(|group| !group.triangles.is_empty());
        let mut meshes = Vec::with_capacity(groups.len());
        if let [group] = &mut groups[..] {
            let name = self.mesh_name(Some(group), path);
            let vertices = std::mem::take(&mut self.vertices);
            meshes.push(Mesh::new(name, vertices, std::mem::take(&mut group.triangles), Material::default())?);
        } else {
            for group in groups {
                let name = self.mesh_name(Some(&group), path);
                let (vertices, triangles) = self.only_used(&name, group.triangles)?;
                meshes.push(Mesh::new(name, vertices, triangles, Material::default())?);
            }
        }
        if meshes.is_empty() {
            return Err(invalid(path, "it has no faces; export triangles or polygons"));
        }
        Ok(self.notes.iter().fold(Scene::new(meshes)?, |scene, keyword| {
            scene.with_note(match *keyword {
                "f" => "polygons were cut into fans around their first corner; concave ones may come out wrong".into(),
                _ => format!("'{keyword}' statements were left out"),
            })
        }))
    }

    /// The vertices that these triangles use, in the file's order, and the triangles with indices into them.
    #[expect(clippy::type_complexity, reason = "the arrays of a mesh, as Mesh::new takes them")]
    fn only_used(
        &self,
        mesh: &str,
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<(Vec<[f64; 3]>, Vec<[u32; 3]>), SceneError> {
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let vertices: Vec<_> = used.iter().map_while(|&v| self.vertices.get(v as usize).copied()).collect();
        for (triangle, corners) in triangles.iter_mut().enumerate() {
            for corner in corners {
                let vertex = u64::from(*corner);
                // `used` is sorted, so what map_while stopped at and all behind it are out of range.
                match used.binary_search(corner) {
                    Ok(position) if position < vertices.len() => *corner = position as u32,
                    _ => {
                        let vertices = self.vertices.len();
                        return Err(SceneError::IndexOutOfRange { mesh: mesh.into(), triangle, vertex, vertices });
                    }
                }
            }
        }
        Ok((vertices, triangles))
    }
}
