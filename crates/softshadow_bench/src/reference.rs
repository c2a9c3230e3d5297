//! What errors are measured against: many rays, made once a scene and size, and kept in a folder where one is given.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use serde::{Deserialize, Serialize};
use softshadow::{Context, Options, Receivers, Technique, visibility};

use crate::error::BenchError;
use crate::scenes::Measured;

/// Visibility that is taken for true, and how well it is known.
#[derive(Debug, Clone)]
pub(crate) struct Reference {
    pub(crate) values: Vec<f32>,
    pub(crate) standard_error: Vec<f32>,
    /// Root mean square of its own standard error over its penumbra.
    pub(crate) rms_standard_error: Option<f64>,
}

/// What a kept reference was made of. Any difference makes it anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Key {
    version: String,
    scene: String,
    size: [u32; 2],
    technique: Technique,
    adapter: String,
    driver: String,
    /// Of every vertex, every triangle and its opacity, the light and the camera.
    fingerprint: u64,
    rms_standard_error: Option<f64>,
}

impl Key {
    fn of(context: &Context, measured: &Measured, technique: &Technique) -> Self {
        let mut hasher = DefaultHasher::new();
        for mesh in measured.scene.meshes() {
            mesh.vertices.iter().flatten().for_each(|x| x.to_bits().hash(&mut hasher));
            mesh.triangles.hash(&mut hasher);
            (0..mesh.triangles.len()).for_each(|triangle| mesh.opacity(triangle).to_bits().hash(&mut hasher));
        }
        format!("{:?} {:?}", measured.light, measured.camera).hash(&mut hasher);
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: measured.name.clone(),
            size: measured.camera.size(),
            technique: technique.clone(),
            adapter: context.adapter().name.clone(),
            driver: context.adapter().driver.clone(),
            fingerprint: hasher.finish(),
            rms_standard_error: None,
        }
    }

    fn file_name(&self) -> String {
        let [width, height] = self.size;
        format!("{}-{width}x{height}-{:016x}.reference", self.scene.replace(['/', '\\'], "-"), self.fingerprint)
    }
}

/// Computes the reference, or reads it from `folder` where it was kept.
pub(crate) fn make(
    context: &Context,
    measured: &Measured,
    technique: &Technique,
    folder: Option<&Path>,
) -> Result<Reference, BenchError> {
    let mut key = Key::of(context, measured, technique);
    if let Some(kept) = folder.and_then(|folder| read(&folder.join(key.file_name()), &key)) {
        return Ok(kept);
    }
    let options = Options { standard_error: true, ..Options::default() };
    let receivers = Receivers::Camera(measured.camera);
    let lights = std::slice::from_ref(&measured.light);
    let seen = visibility(context, &measured.scene, lights, &receivers, technique, &options, &mut |_, _| true)?;
    let Some(standard_error) = seen.standard_error else {
        let reason = format!("{} has no standard error, and can be no reference", technique.name());
        return Err(softshadow::Error::Settings(reason).into());
    };
    let made = Reference { values: seen.values, standard_error, rms_standard_error: seen.info.standard_error };
    if let Some(folder) = folder {
        key.rms_standard_error = made.rms_standard_error;
        write(folder, &key, &made)?;
    }
    Ok(made)
}

/// `None` where there is no such file, or another one.
fn read(path: &Path, key: &Key) -> Option<Reference> {
    let bytes = fs::read(path).ok()?;
    let end = bytes.iter().position(|b| *b == b'\n')?;
    let known: Key = serde_json::from_slice(&bytes[..end]).ok()?;
    let is_it = Key { rms_standard_error: None, ..known.clone() } == *key;
    let numbers: Vec<f32> =
        bytes[end + 1..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let count = key.size[0] as usize * key.size[1] as usize;
    (is_it && numbers.len() == 2 * count).then(|| Reference {
        values: numbers[..count].to_vec(),
        standard_error: numbers[count..].to_vec(),
        rms_standard_error: known.rms_standard_error,
    })
}

/// One line that says what it is, then values and their errors as float32, little end first.
fn write(folder: &Path, key: &Key, reference: &Reference) -> Result<(), BenchError> {
    let path = folder.join(key.file_name());
    let failed = |error: std::io::Error| BenchError::file(path.display().to_string(), error);
    let mut bytes = serde_json::to_vec(key).map_err(|error| BenchError::file("a reference's key", error))?;
    bytes.push(b'\n');
    bytes.extend(reference.values.iter().chain(&reference.standard_error).flat_map(|x| x.to_le_bytes()));
    fs::create_dir_all(folder).map_err(failed)?;
    fs::write(&path, bytes).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> Key {
        Key {
            version: "1".into(),
            scene: "fork".into(),
            size: [2, 1],
            technique: Technique::RayTraced(softshadow::RayTraced::default()),
            adapter: "a".into(),
            driver: "d".into(),
            fingerprint: 7,
            rms_standard_error: None,
        }
    }

    #[test]
    fn a_kept_reference_comes_back_bit_by_bit_and_no_other_does() {
        let folder = std::env::temp_dir().join(format!("softshadow-bench-references-{}", std::process::id()));
        let made = Reference {
            values: vec![0.25, f32::NAN],
            standard_error: vec![0.1, f32::NAN],
            rms_standard_error: Some(0.1),
        };
        let kept = Key { rms_standard_error: made.rms_standard_error, ..key() };
        write(&folder, &kept, &made).unwrap();
        let path = folder.join(key().file_name());
        let again = read(&path, &key()).unwrap();
        let bits = |x: &[f32]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&again.values), bits(&made.values));
        assert_eq!((bits(&again.standard_error), again.rms_standard_error), (bits(&made.standard_error), Some(0.1)));
        assert!(read(&path, &Key { driver: "newer".into(), ..key() }).is_none());
        assert!(read(&path, &Key { size: [4, 1], ..key() }).is_none());
        let mut bytes = fs::read(&path).unwrap();
        bytes.truncate(bytes.len() - 4);
        fs::write(&path, bytes).unwrap();
        assert!(read(&path, &key()).is_none(), "a file that was cut is none");
    }
}
