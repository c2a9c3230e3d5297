//! Reading scenes from files: glTF 2.0 (`.glb`, `.gltf`) and Wavefront OBJ (`.obj`), geometry only.
//!
//! Files are untrusted. Every offset and count is checked in 64 bits before anything is read or allocated, what is
//! wrong comes back as a [`SceneError`], and what a file holds beyond geometry is listed in [`Scene::notes`].

mod gltf;
mod obj;
mod uri;

use std::fs;
use std::io::Read;
use std::path::Path;

use crate::error::SceneError;
use crate::scene::Scene;

/// The largest file that is read, and the most that all buffers of one glTF file may hold together.
pub const MAX_FILE_BYTES: u64 = 8 << 30;

/// Reads a scene; the extension, in any case, decides the format.
///
/// # Errors
/// [`SceneError::UnknownFormat`] by the extension, [`SceneError::FileUnreadable`] where there is no such file,
/// [`SceneError::TooLarge`] above [`MAX_FILE_BYTES`], and everything that [`parse`] reports.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let format = Format::of(path)?;
    let file = RegularFile::open(path)?;
    if file.length > MAX_FILE_BYTES {
        let what = format!("bytes of {}", path.display());
        return Err(SceneError::TooLarge { what, needed: file.length, limit: MAX_FILE_BYTES });
    }
    format.parse(path, &file.read(MAX_FILE_BYTES)?)
}

/// Reads a scene from a file's bytes. The path gives the format, names the file in messages, and is where the
/// buffers of a `.gltf` are looked for.
///
/// # Errors
/// [`SceneError::UnknownFormat`], [`SceneError::FileInvalid`] for a broken file, [`SceneError::IndexOutOfRange`] and
/// [`SceneError::NotFinite`] for a broken mesh, [`SceneError::TooLarge`] for more triangles than a scene may have.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    Format::of(path)?.parse(path, bytes)
}

#[derive(Clone, Copy)]
enum Format {
    Gltf,
    Obj,
}

impl Format {
    fn of(path: &Path) -> Result<Self, SceneError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "obj" => Ok(Self::Obj),
            _ => Err(SceneError::UnknownFormat { path: path.into(), extension }),
        }
    }

    fn parse(self, path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
        match self {
            Self::Gltf => gltf::parse(path, bytes),
            Self::Obj => obj::parse(path, bytes),
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

fn unreadable(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::FileUnreadable { path: path.into(), reason: reason.into() }
}

fn invalid(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::FileInvalid { path: path.into(), reason: reason.into() }
}
