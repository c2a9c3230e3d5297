//! Reading scenes from files: glTF 2.0 (`.glb`, `.gltf`), Wavefront OBJ (`.obj`), PLY (`.ply`) and STL (`.stl`), geometry
//! only; and `scene.json` (`.json`), which places their meshes and adds lights, a camera and a unit of length.
//!
//! Files are untrusted. Every offset and count is checked in 64 bits before anything is read or allocated, what is
//! wrong comes back as a [`SceneError`], and what a file holds beyond geometry is listed in [`Scene::notes`].

mod gltf;
mod json;
mod obj;
mod ply;
mod polygon;
mod stl;
mod uri;

use std::fs;
use std::io::Read;
use std::path::Path;

use crate::error::SceneError;
use crate::light::Light;
use crate::scene::Scene;

/// The largest file that is read, and the most that all buffers of one glTF file may hold together.
pub const MAX_FILE_BYTES: u64 = 8 << 30;

/// The most meshes: without the limit a small file could ask for endless work that makes no triangle.
const MAX_MESHES: u64 = 1 << 20;

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// The meshes.
    pub scene: Scene,
    /// The lights of a `scene.json`, in order; no other format has any.
    pub lights: Vec<FileLight>,
    /// The camera of a `scene.json` that has one.
    pub camera: Option<FileCamera>,
    /// Metres a world unit, where the format says: always 1 for glTF, not known for OBJ, PLY and STL.
    pub meters_per_unit: Option<f64>,
}

/// A light and what the file calls it.
#[derive(Debug, Clone, PartialEq)]
pub struct FileLight {
    /// Empty where the file gives none, else no other light's.
    pub name: String,
    /// The light.
    pub light: Light,
}

/// The view of a file, as [`Camera::look_at`](crate::Camera::look_at) takes it; that it can is checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileCamera {
    /// Where the camera is, in world units.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// Where the top of the picture points.
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    pub fov_y_deg: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Reads a scene; the extension, in any case, decides the format.
///
/// # Errors
/// As [`load_all`].
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    load_all(path).map(|file| file.scene)
}

/// Reads a scene and what its file holds beside it; the extension, in any case, decides the format.
///
/// # Errors
/// [`SceneError::UnknownFormat`] by the extension, [`SceneError::FileUnreadable`] where there is no such file,
/// [`SceneError::TooLarge`] above [`MAX_FILE_BYTES`], and everything that [`parse`] reports.
pub fn load_all(path: &Path) -> Result<SceneFile, SceneError> {
    let format = Format::of(path)?;
    let file = RegularFile::open(path)?;
    let limit = if format == Format::Json { json::MAX_BYTES } else { MAX_FILE_BYTES };
    if file.length > limit {
        let what = format!("bytes of {}", path.display());
        return Err(SceneError::TooLarge { what, needed: file.length, limit });
    }
    format.parse(path, &file.read(limit)?)
}

/// Reads a scene from a file's bytes. The path gives the format, names the file in messages, and is where the
/// buffers of a `.gltf` and the meshes of a `scene.json` are looked for.
///
/// # Errors
/// [`SceneError::UnknownFormat`], [`SceneError::FileInvalid`] for a broken file, [`SceneError::IndexOutOfRange`] and
/// [`SceneError::NotFinite`] for a broken mesh, [`SceneError::TooLarge`] for more triangles than a scene may have.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    parse_all(path, bytes).map(|file| file.scene)
}

/// Reads a scene and what its file holds beside it from the file's bytes.
///
/// # Errors
/// As [`parse`].
pub fn parse_all(path: &Path, bytes: &[u8]) -> Result<SceneFile, SceneError> {
    Format::of(path)?.parse(path, bytes)
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Gltf,
    Json,
    Obj,
    Ply,
    Stl,
}

impl Format {
    fn of(path: &Path) -> Result<Self, SceneError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "json" => Ok(Self::Json),
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "stl" => Ok(Self::Stl),
            _ => Err(SceneError::UnknownFormat { path: path.into(), extension }),
        }
    }

    fn parse(self, path: &Path, bytes: &[u8]) -> Result<SceneFile, SceneError> {
        let meshes = |scene, meters_per_unit| SceneFile { scene, lights: Vec::new(), camera: None, meters_per_unit };
        match self {
            Self::Gltf => gltf::parse(path, bytes).map(|scene| meshes(scene, Some(1.0))),
            Self::Json => json::parse(path, bytes),
            Self::Obj => obj::parse(path, bytes).map(|scene| meshes(scene, None)),
            Self::Ply => ply::parse(path, bytes).map(|scene| meshes(scene, None)),
            Self::Stl => stl::parse(path, bytes).map(|scene| meshes(scene, None)),
        }
    }
}

/// An open file that has a length. Devices and pipes are refused: theirs cannot be checked.
struct RegularFile<'a> {
    path: &'a Path,
    file: fs::File,
    length: u64,
}

impl<'a> RegularFile<'a> {
    fn open(path: &'a Path) -> Result<Self, SceneError> {
        // Asked before opening, because opening a pipe waits for its writer.
        let metadata = fs::metadata(path).map_err(|e| unreadable(path, e.to_string()))?;
        if !metadata.is_file() {
            return Err(unreadable(path, "it is not a regular file"));
        }
        let file = fs::File::open(path).map_err(|e| unreadable(path, e.to_string()))?;
        Ok(Self { path, file, length: metadata.len() })
    }

    /// The file's first bytes, `limit` at most.
    fn read(self, limit: u64) -> Result<Vec<u8>, SceneError> {
        let mut bytes = Vec::new();
        self.file.take(limit).read_to_end(&mut bytes).map_err(|e| unreadable(self.path, e.to_string()))?;
        Ok(bytes)
    }
}

fn check_limit(what: &str, needed: u64, limit: u64) -> Result<(), SceneError> {
    if needed > limit {
        return Err(SceneError::TooLarge { what: what.into(), needed, limit });
    }
    Ok(())
}

fn unreadable(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::FileUnreadable { path: path.into(), reason: reason.into() }
}

fn invalid(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::FileInvalid { path: path.into(), reason: reason.into() }
}
