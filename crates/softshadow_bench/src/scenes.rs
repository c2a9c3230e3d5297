//! The measured scenes: those that the library ships, and models on a ground.
//!
//! Models stand on a ground of 6 by 6 under a light of 1 by 1. All bounds are symmetric about the origin and 6 wide, the tallest model
//! is 1 high: the library's local frame then only scales by a power of two, positions in world units are float32 numbers, and another
//! renderer can be given exactly the same. `softshadow.bench.scenes` in Python places its models in the same
//! way.

use std::path::{Path, PathBuf};

use softshadow::{Camera, Light, LightShape, Mesh, Scene, look_at, procedural, scene_file};

use crate::error::BenchError;

/// A scene with the light and the camera that it is measured with.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) light: Light,
    pub(crate) camera: Camera,
}

impl Measured {
    /// The same scene, of which every triangle lets half of the light pass.
    pub(crate) fn semi_opaque(&self) -> Result<Self, BenchError> {
        let mut meshes = self.scene.meshes().to_vec();
        for mesh in &mut meshes {
            (mesh.material.opacity, mesh.opacities) = (0.5, Vec::new());
        }
        Ok(Self { scene: Scene::new(meshes)?, ..self.clone() })
    }
}

/// A mesh file on the ground.
struct Model {
    file: &'static str,
    /// x and z of the middle of its foot.
    foot: [f64; 2],
    /// About the upright axis.
    turned_deg: f64,
    height: f64,
}

/// Scenes of models by name. Another one is another row.
const PLACED: [(&str, &[Model]); 2] = [
    ("bunny", &[Model { file: "stanford-bunny.obj", foot: [0.0, 0.0], turned_deg: 0.0, height: 1.0 }]),
    (
        "teapots",
        &[
            Model { file: "teapot.obj", foot: [-0.7, 0.4], turned_deg: 20.0, height: 0.6 },
            Model { file: "teapot.obj", foot: [0.8, 0.9], turned_deg: 130.0, height: 0.45 },
            Model { file: "cow.obj", foot: [0.2, -0.5], turned_deg: 70.0, height: 1.0 },
        ],
    ),
];

/// Every scene that has a name.
pub(crate) fn names() -> Vec<&'static str> {
    procedural::names().into_iter().chain(PLACED.iter().map(|(name, _)| *name)).collect()
}

/// The scenes that were asked for: a folder stands for every mesh in it, in the order of their names.
pub(crate) fn listed(asked: &[String], meshes: &Path) -> Result<Vec<String>, BenchError> {
    let mut listed = Vec::new();
    for name in asked {
        let folder = [PathBuf::from(name), meshes.join(name)].into_iter().find(|path| path.is_dir());
        let Some(folder) = folder.filter(|_| !names().contains(&name.as_str())) else {
            listed.push(name.clone());
            continue;
        };
        let failed = |error: std::io::Error| BenchError::file(folder.display().to_string(), error);
        let paths = std::fs::read_dir(&folder).map_err(failed)?.map(|entry| entry.map(|entry| entry.path()));
        let paths = paths.collect::<Result<Vec<PathBuf>, _>>().map_err(failed)?;
        let is_mesh = |path: &&PathBuf| path.extension().is_some_and(|end| MESHES.iter().any(|known| end == *known));
        let mut found: Vec<String> =
            paths.iter().filter(is_mesh).map(|path| path.to_string_lossy().into_owned()).collect();
        if found.is_empty() {
            return Err(BenchError::file(
                folder.display().to_string(),
                format!("no mesh in it: {}", MESHES.join(", ")),
            ));
        }
        found.sort();
        listed.extend(found);
    }
    Ok(listed)
}

const MESHES: [&str; 5] = ["glb", "gltf", "obj", "ply", "stl"];

/// A scene file with a light and a camera of its own; the first of each counts.
fn described(name: &str, path: &Path, size: [u32; 2]) -> Result<Measured, BenchError> {
    let file = scene_file::load_all(path)?;
    let lacks = |what: &str| BenchError::file(path.display().to_string(), format!("it has no {what}"));
    let light = file.lights.into_iter().next().ok_or_else(|| lacks("light"))?.light;
    let c = file.camera.ok_or_else(|| lacks("camera"))?;
    let camera = Camera::look_at(c.eye, c.target, c.up, c.fov_y_deg, size)?;
    Ok(Measured { name: name.into(), scene: file.scene, light, camera })
}

/// A scene by name, a scene file with its own light and camera, or a mesh file on its own, in an image of `[width, height]`.
pub(crate) fn find(name: &str, size: [u32; 2], meshes: &Path) -> Result<Measured, BenchError> {
    if procedural::names().contains(&name) {
        return shipped(name, size);
    }
    if let Some((_, models)) = PLACED.iter().find(|(known, _)| *known == name) {
        let placed = models.iter().map(|m| place(&meshes.join(m.file), m.foot, m.turned_deg, m.height));
        return on_ground(name, placed.collect::<Result<_, _>>()?, size);
    }
    if let Some(extension) = Path::new(name).extension() {
        let own = PathBuf::from(name);
        let path = if own.is_file() { own } else { meshes.join(name) };
        if extension == "json" {
            return described(name, &path, size);
        }
        return on_ground(name, vec![place(&path, [0.0; 2], 0.0, 1.0)?], size);
    }
    Err(BenchError::UnknownScene { name: name.into(), known: names().join(", ") })
}

/// Where public models are: never among our own files.
pub(crate) fn meshes_folder() -> PathBuf {
    std::env::var_os("SOFTSHADOW_MESHES").map_or_else(|| "../shared/meshes".into(), PathBuf::from)
}

fn shipped(name: &str, size: [u32; 2]) -> Result<Measured, BenchError> {
    let described = procedural::shipped(name)?;
    let (l, c) = (described.light(), described.camera());
    let shape = match l.shape {
        procedural::LightShape::Rectangle { width, height } => LightShape::Rectangle { width, height },
        procedural::LightShape::Disc { radius } => LightShape::Disc { radius },
        procedural::LightShape::Sphere { radius } => LightShape::Sphere { radius },
        procedural::LightShape::Sun { angular_diameter_deg } => {
            LightShape::Sun { angular_diameter: angular_diameter_deg.to_radians() }
        }
    };
    let pose = look_at(l.position, l.target, Some(l.up))?;
    let light = Light::new(shape, pose)?.with_radiance(l.radiance.map(|x| x as f32))?;
    let camera = Camera::look_at(c.eye, c.target, Some(c.up), c.fov_y_deg, size)?;
    Ok(Measured { name: name.into(), scene: described.build()?, light, camera })
}

fn on_ground(name: &str, mut meshes: Vec<Mesh>, size: [u32; 2]) -> Result<Measured, BenchError> {
    let corners = [[-3.0, -0.5, -3.0], [3.0, -0.5, -3.0], [3.0, -0.5, 3.0], [-3.0, -0.5, 3.0]];
    meshes.push(Mesh::new("ground", corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]], softshadow::Material::default())?);
    let light = LightShape::Rectangle { width: 1.0, height: 1.0 };
    Ok(Measured {
        name: name.into(),
        scene: Scene::new(meshes)?,
        light: Light::new(light, look_at([1.5, 3.0, 1.0], [0.0, -0.2, 0.0], None)?)?,
        camera: Camera::look_at([2.2, 1.4, 3.0], [0.0, -0.1, 0.0], None, 40.0, size)?,
    })
}

/// All meshes of a file as one, scaled to a height, turned, with its foot on the ground; positions are float32 numbers.
fn place(path: &Path, foot: [f64; 2], turned_deg: f64, height: f64) -> Result<Mesh, BenchError> {
    if !path.is_file() {
        return Err(BenchError::MissingMesh { path: path.into() });
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let file = scene_file::load(path)?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for mesh in file.meshes() {
        let first = vertices.len() as u32;
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        vertices.extend_from_slice(&mesh.vertices);
    }
    let bound = |of: fn(f64, f64) -> f64, k: usize| vertices.iter().map(|v| v[k]).reduce(of).unwrap_or(0.0);
    let (low, high) = ([0, 1, 2].map(|k| bound(f64::min, k)), [0, 1, 2].map(|k| bound(f64::max, k)));
    let own_height = high[1] - low[1];
    if own_height <= 0.0 {
        return Err(BenchError::Flat { name });
    }
    let (sin, cos) = turned_deg.to_radians().sin_cos();
    for v in &mut vertices {
        let from_foot = [v[0] - (low[0] + high[0]) / 2.0, v[1] - low[1], v[2] - (low[2] + high[2]) / 2.0];
        let [x, y, z] = from_foot.map(|d| d * height / own_height);
        let placed = [foot[0] + cos * x + sin * z, y - 0.5, foot[1] - sin * x + cos * z];
        *v = placed.map(|x| f64::from(x as f32));
    }
    Ok(Mesh::new(name, vertices, triangles, softshadow::Material::default())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2 × 4 × 1 somewhere, as a file in a folder of the caller's own: tests of a process run at once.
    fn folder_with_a_box(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("softshadow-bench-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let text = "v 5 7 9\nv 7 7 9\nv 7 11 9\nv 5 11 10\nf 1 2 3\nf 1 3 4\n";
        std::fs::write(folder.join("box.obj"), text).unwrap();
        folder
    }

    #[test]
    fn models_stand_on_the_ground_at_the_height_of_one() {
        let measured = find("box.obj", [8, 8], &folder_with_a_box("stands")).unwrap();
        let model = &measured.scene.meshes()[0];
        let expected = [[-0.25, -0.5, -0.125], [0.25, -0.5, -0.125], [0.25, 0.5, -0.125], [-0.25, 0.5, 0.125]];
        assert_eq!((model.name.as_str(), &model.vertices[..]), ("box", &expected[..]));
        assert_eq!(measured.scene.meshes().len(), 2);
    }

    #[test]
    fn a_folder_stands_for_its_meshes_and_a_scene_file_brings_light_and_camera() {
        let folder = folder_with_a_box("listed");
        std::fs::write(folder.join("notes.txt"), "no mesh").unwrap();
        let text = r#"{"softshadow": 1, "meshes": [{"path": "box.obj"}],
            "lights": [{"type": "RectLight", "width": 1, "height": 2, "translate": [0, 20, 0], "target": [0, 0, 0]}],
            "camera": {"eye": [9, 9, 9], "target": [6, 9, 9], "fov_y_deg": 40, "size": [640, 480]}}"#;
        std::fs::write(folder.join("room.json"), text).unwrap();
        let name = folder.to_string_lossy().into_owned();
        let meshes = Path::new("/nowhere");
        let found = listed(&["fork".into(), name], meshes).unwrap();
        assert_eq!(found, ["fork".to_owned(), folder.join("box.obj").to_string_lossy().into_owned()]);
        assert_eq!(find(&found[1], [8, 8], meshes).unwrap().scene.meshes().len(), 2);
        let room = find(&folder.join("room.json").to_string_lossy(), [8, 6], meshes).unwrap();
        assert_eq!((room.scene.meshes().len(), room.camera.size()), (1, [8, 6]));
        let empty = folder.join("empty");
        std::fs::create_dir_all(&empty).unwrap();
        assert!(listed(&[empty.to_string_lossy().into_owned()], meshes).unwrap_err().to_string().contains("no mesh"));
    }

    #[test]
    fn models_are_turned_about_the_upright_axis() {
        let model = place(&folder_with_a_box("turned").join("box.obj"), [1.0, 2.0], 90.0, 2.0).unwrap();
        // What lay along +x lies along −z.
        let [x, y, z] = model.vertices[1];
        assert!((x - 0.75).abs() < 1e-6 && y == -0.5 && (z - 1.5).abs() < 1e-6, "{x} {y} {z}");
    }

    #[test]
    fn every_shipped_scene_is_found_and_other_names_are_refused() {
        let nowhere = Path::new("/nowhere");
        for name in procedural::names() {
            assert_eq!(find(name, [8, 4], nowhere).unwrap().camera.size(), [8, 4]);
        }
        assert!(matches!(find("bunny", [8, 8], nowhere), Err(BenchError::MissingMesh { .. })));
        assert!(matches!(find("cow.obj", [8, 8], nowhere), Err(BenchError::MissingMesh { .. })));
        let error = find("cow", [8, 8], nowhere).unwrap_err();
        assert!(error.to_string().contains("canopy") && error.to_string().contains("teapots"), "{error}");
    }
}
