//! STL, ascii and binary: triangles that share no vertex. Text is read in float64, because scenes may live at map coordinates.
//!
//! The reader is our own: files are told apart by their length, because many binary ones begin with `solid`, too, and text may
//! hold several solids.

use std::path::Path;

use super::{MAX_MESHES, check_limit, invalid};
use crate::error::SceneError;
use crate::mesh::{MAX_TRIANGLES, Material, Mesh};
use crate::scene::Scene;

/// 80 bytes of anything, then the number of triangles.
const HEADER_BYTES: usize = 84;
/// Normal and three corners as little-endian float32, then two bytes of anything.
const TRIANGLE_BYTES: usize = 50;

/// One mesh for a binary file, one a solid for text.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    let solids = match binary_triangles(bytes) {
        Ok(triangles) => vec![Solid { name: String::new(), corners: binary_corners(triangles) }],
        Err(_) if bytes.trim_ascii_start().starts_with(b"solid") => read_text(path, bytes)?,
        Err(reason) => return Err(invalid(path, reason)),
    };
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let meshes = solids.into_iter().filter(|solid| !solid.corners.is_empty()).map(|solid| {
        check_limit("triangles of the scene", solid.corners.len() as u64 / 3, MAX_TRIANGLES)?;
        let name = if solid.name.is_empty() { stem.clone() } else { solid.name };
        // The limit on triangles keeps the count in 32 bits.
        let triangles = (0..solid.corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(name, solid.corners, triangles, Material::default())
    });
    let meshes = meshes.collect::<Result<Vec<_>, _>>()?;
    if meshes.is_empty() {
        return Err(invalid(path, "it has no triangles"));
    }
    Scene::new(meshes)
}

struct Solid {
    name: String,
    /// Three a triangle.
    corners: Vec<[f64; 3]>,
}

/// The triangles' bytes, where the file is exactly as long as its header says.
fn binary_triangles(bytes: &[u8]) -> Result<&[[u8; TRIANGLE_BYTES]], String> {
    let (header, body) = bytes.split_at_checked(HEADER_BYTES).ok_or("it is neither text nor as long as a header")?;
    let count = header.last_chunk().map_or(0, |four| u32::from_le_bytes(*four));
    let needed = u64::from(count) * TRIANGLE_BYTES as u64;
    if needed != body.len() as u64 {
        let held = body.len();
        return Err(format!("its header says {count} triangles, which take {needed} bytes; {held} bytes follow it"));
    }
    Ok(body.as_chunks().0)
}

fn binary_corners(triangles: &[[u8; TRIANGLE_BYTES]]) -> Vec<[f64; 3]> {
    let float = |four: &[u8; 4]| f64::from(f32::from_le_bytes(*four));
    let corners = |triangle: &[u8; TRIANGLE_BYTES]| {
        let [_, a, b, c] = triangle.as_chunks::<12>().0 else { return [[0.0; 3]; 3] };
        [a, b, c].map(|corner| match corner.as_chunks::<4>().0 {
            [x, y, z] => [float(x), float(y), float(z)],
            _ => [0.0; 3],
        })
    };
    triangles.iter().flat_map(corners).collect()
}

/// What may come next; a file that ends elsewhere than outside of all solids is truncated.
#[derive(Clone, Copy, PartialEq)]
enum Expected {
    Solid,
    Facet,
    Loop,
    Vertex(u8),
    EndLoop,
    EndFacet,
}

fn read_text(path: &Path, bytes: &[u8]) -> Result<Vec<Solid>, SceneError> {
    // Only names can be anything but ASCII, so a lossy conversion loses no geometry.
    let text = String::from_utf8_lossy(bytes);
    let mut solids: Vec<Solid> = Vec::new();
    let (mut expected, mut count) = (Expected::Solid, 0);
    for (index, line) in text.lines().enumerate() {
        let broken = |reason: String| invalid(path, format!("line {}: {reason}", index + 1));
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else { continue };
        expected = match (expected, word.to_ascii_lowercase().as_str(), solids.last_mut()) {
            (Expected::Solid, "solid", _) => {
                let name = words.collect::<Vec<_>>().join(" ");
                // One without a facet is no mesh.
                solids.pop_if(|solid| solid.corners.is_empty());
                check_limit("meshes of the scene", solids.len() as u64 + 1, MAX_MESHES)?;
                solids.push(Solid { name, corners: Vec::new() });
                Expected::Facet
            }
            (Expected::Facet, "endsolid", _) => Expected::Solid,
            // The normal follows from the corners.
            (Expected::Facet, "facet", _) => Expected::Loop,
            (Expected::Loop, "outer", _) => Expected::Vertex(0),
            (Expected::Vertex(corner), "vertex", Some(solid)) => {
                solid.corners.push(read_vertex(words).map_err(broken)?);
                if corner < 2 { Expected::Vertex(corner + 1) } else { Expected::EndLoop }
            }
            (Expected::EndLoop, "endloop", _) => Expected::EndFacet,
            (Expected::EndFacet, "endfacet", _) => {
                count += 1;
                check_limit("triangles of the scene", count, MAX_TRIANGLES)?;
                Expected::Facet
            }
            (expected, ..) => return Err(broken(format!("'{word:.40}' where {} is expected", expected.words()))),
        };
    }
    if expected != Expected::Solid {
        return Err(invalid(path, format!("it ends where {} is expected; it is truncated", expected.words())));
    }
    Ok(solids)
}

impl Expected {
    fn words(self) -> &'static str {
        match self {
            Self::Solid => "'solid'",
            Self::Facet => "'facet' or 'endsolid'",
            Self::Loop => "'outer loop'",
            Self::Vertex(_) => "'vertex'",
            Self::EndLoop => "'endloop' (a facet has 3 corners)",
            Self::EndFacet => "'endfacet'",
        }
    }
}

fn read_vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    let mut vertex = [0.0; 3];
    for coordinate in &mut vertex {
        let word = words.next().ok_or("a vertex needs 3 coordinates")?;
        *coordinate = word.parse().map_err(|_| format!("'{word:.40}' is not a number"))?;
    }
    match words.next() {
        None => Ok(vertex),
        Some(word) => Err(format!("'{word:.40}' after 3 coordinates")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid a part\n facet normal 0 0 1\n  outer loop\n   vertex 500000.123456789 0 0\n   vertex 1 0 0\n   \
        VERTEX 0 1e0 0\n  endloop\n endfacet\nendsolid a part\nsolid\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\n\
        vertex 1 0 0\nvertex 0 .5 1.\nendloop\nendfacet\nendsolid\n";

    fn read(bytes: &[u8]) -> Result<Scene, SceneError> {
        parse(Path::new("part.stl"), bytes)
    }

    fn refusal(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    fn binary(header: &str, corners: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(80, b' ');
        bytes.extend((corners.len() as u32 / 3).to_le_bytes());
        for triangle in corners.chunks(3) {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([7, 7]);
        }
        bytes
    }

    #[test]
    fn solids_of_text_are_meshes_in_float64() {
        let scene = read(TEXT.as_bytes()).unwrap();
        let [first, second] = scene.meshes() else { panic!("two meshes expected") };
        assert_eq!((first.name.as_str(), second.name.as_str()), ("a part", "part"));
        assert_eq!(first.vertices, [[500_000.123_456_789, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(second.vertices[2], [0.0, 0.5, 1.0]);
        assert_eq!(second.triangles, [[0, 1, 2]]);
        assert_eq!(read(TEXT.replace('\n', "\r\n").as_bytes()).unwrap().meshes(), scene.meshes());
    }

    #[test]
    fn binary_files_are_known_by_their_length_whatever_they_begin_with() {
        let corners: Vec<[f32; 3]> = (0..6).map(|i| [i as f32, 0.5, -1.0]).collect();
        for header in ["", "solid made by somebody"] {
            let scene = read(&binary(header, &corners)).unwrap();
            assert_eq!(scene.meshes()[0].vertices, corners.iter().map(|c| c.map(f64::from)).collect::<Vec<_>>());
            assert_eq!(scene.meshes()[0].triangles, [[0, 1, 2], [3, 4, 5]]);
        }
    }

    #[test]
    fn broken_binaries_are_refused_before_anything_is_allocated() {
        let good = binary("", &[[0.0; 3], [1.0; 3], [2.0, 0.0, 0.0]]);
        for length in 0..good.len() {
            assert!(read(&good[..length]).is_err(), "{length}");
        }
        let mut huge = good.clone();
        huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(refusal(&huge).contains("4294967295 triangles, which take 214748364750 bytes; 50 bytes follow"));
        let mut swapped = good.clone();
        swapped[80..84].reverse();
        assert!(refusal(&swapped).contains("16777216 triangles"));
        let mut longer = good.clone();
        longer.push(0);
        assert!(refusal(&longer).contains("51 bytes follow"));
        assert!(refusal(&binary("", &[])).contains("no triangles"));
        let mut nan = good;
        nan[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(matches!(read(&nan).unwrap_err(), SceneError::NotFinite { index: 0, .. }));
    }

    #[test]
    fn broken_text_is_refused_with_its_line() {
        for (old, new, words) in [
            ("vertex 1 0 0\n", "vertex 1 0\n", "line 5: a vertex needs 3 coordinates"),
            ("vertex 1 0 0\n", "vertex 1 0 0 0\n", "line 5: '0' after 3 coordinates"),
            ("vertex 1 0 0\n", "vertex 1 0 x\n", "line 5: 'x' is not a number"),
            ("vertex 1 0 0\n", "", "line 6: 'endloop' where 'vertex'"),
            ("endloop\n", "vertex 1 2 3\n", "'endloop' (a facet has 3 corners)"),
            ("endfacet\nendsolid a part\n", "endfacet\n", "'solid' where 'facet' or 'endsolid'"),
            ("outer loop\n", "", "where 'outer loop' is expected"),
        ] {
            let reason = refusal(TEXT.replacen(old, new, 1).as_bytes());
            assert!(reason.contains(words), "{reason}");
        }
        let first = &TEXT[..TEXT.find("endsolid").unwrap() + 8];
        assert!(read(first.as_bytes()).is_ok());
        for length in 0..first.len() {
            assert!(read(&first.as_bytes()[..length]).is_err(), "{length}");
        }
        let nan = TEXT.replacen("vertex 1 0 0", "vertex 1 nan 0", 1);
        assert!(matches!(read(nan.as_bytes()).unwrap_err(), SceneError::NotFinite { index: 1, .. }));
        assert!(refusal(b"solid empty\nendsolid").contains("no triangles"));
        assert!(refusal(b"").contains("neither text nor"));
        assert!(refusal("solid\n".repeat(100_000).as_bytes()).contains("line 2: 'solid'"));
    }
}
