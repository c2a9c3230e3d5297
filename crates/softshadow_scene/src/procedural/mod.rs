//! Scenes that are a page of JSON: named parts made of primitives, one light and one camera.
//!
//! Tests, the benchmark and the demonstration share the scenes of [`names`]; `scenes/` holds their text. Y is
//! up in all of them, lengths are metres. A text is untrusted like any file: unknown fields are refused, and counts
//! are checked before anything is allocated.

mod leaves;
mod shapes;
mod waving;

use serde::Deserialize;

pub use self::shapes::{Placed, Shape};
pub use self::waving::waving;
use crate::error::SceneError;
use crate::mesh::{Material, Mesh};
use crate::scene::Scene;

/// The most triangles that a procedural scene may have.
pub const MAX_PROCEDURAL_TRIANGLES: u64 = 1 << 22;

const SHIPPED: [(&str, &str); 5] = [
    ("canopy", include_str!("../../scenes/canopy.json")),
    ("cards", include_str!("../../scenes/cards.json")),
    ("fork", include_str!("../../scenes/fork.json")),
    ("hall", include_str!("../../scenes/hall.json")),
    ("toruses", include_str!("../../scenes/toruses.json")),
];

/// A parsed and checked description; [`ProceduralScene::build`] makes its meshes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProceduralScene {
    name: String,
    description: String,
    parts: Vec<Part>,
    light: LightDescription,
    camera: CameraDescription,
}

/// One mesh of a scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    name: String,
    /// Linear reflectance.
    base_color: [f32; 3],
    #[serde(default = "matte")]
    roughness: f32,
    #[serde(default)]
    specular: f32,
    #[serde(default = "opaque")]
    opacity: f32,
    of: Vec<Placed>,
}

fn matte() -> f32 {
    Material::default().roughness
}

fn opaque() -> f32 {
    Material::default().opacity
}

/// The light that a scene is meant for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightDescription {
    /// Its shape and size.
    pub shape: LightShape,
    /// Its centre; for a sun any point, only the direction to `target` counts.
    pub position: [f64; 3],
    /// What it faces.
    pub target: [f64; 3],
    /// Where the light's Y axis points, as far as facing `target` lets it.
    #[serde(default = "y_axis")]
    pub up: [f64; 3],
    /// Linear red, green and blue, in watts per square metre and steradian where units matter.
    pub radiance: [f64; 3],
}

/// The emitting surface, in the light's own XY plane where it is flat.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum LightShape {
    /// Full width along X and full height along Y.
    Rectangle {
        /// Along X.
        width: f64,
        /// Along Y.
        height: f64,
    },
    /// A flat disc.
    Disc {
        /// Of the disc.
        radius: f64,
    },
    /// A sphere that emits everywhere.
    Sphere {
        /// Of the sphere.
        radius: f64,
    },
    /// Infinitely far away.
    Sun {
        /// The sun's is about 0.53.
        angular_diameter_deg: f64,
    },
}

/// The view that a scene is meant for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
    /// Where the camera is.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// Where the top of the picture points.
    #[serde(default = "y_axis")]
    pub up: [f64; 3],
    /// Vertical field of view in degrees.
    pub fov_y_deg: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

fn y_axis() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// The names of the scenes that come with the library, sorted.
#[must_use]
pub fn names() -> [&'static str; SHIPPED.len()] {
    SHIPPED.map(|(name, _)| name)
}

/// A scene that comes with the library.
///
/// # Errors
/// [`SceneError::Invalid`] for any name that is none of [`names`].
pub fn shipped(name: &str) -> Result<ProceduralScene, SceneError> {
    match SHIPPED.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => parse(text),
        None => Err(SceneError::invalid(format!("scene '{name}'"), format!("choose one of {}", names().join(", ")))),
    }
}

/// Reads a scene's text.
///
/// # Errors
/// [`SceneError::Invalid`] for malformed JSON, an unknown field or shape, or a number outside its range;
/// [`SceneError::TooLarge`] above [`MAX_PROCEDURAL_TRIANGLES`].
pub fn parse(text: &str) -> Result<ProceduralScene, SceneError> {
    let scene: ProceduralScene =
        serde_json::from_str(text).map_err(|e| SceneError::invalid("procedural scene", e.to_string()))?;
    scene.check()?;
    Ok(scene)
}

impl ProceduralScene {
    /// What the scene is called.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it shows, in a sentence.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The light that it is meant for.
    #[must_use]
    pub fn light(&self) -> &LightDescription {
        &self.light
    }

    /// The view that it is meant for.
    #[must_use]
    pub fn camera(&self) -> &CameraDescription {
        &self.camera
    }

    /// The meshes, one a part. The same text gives the same meshes.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`] where transforms multiply beyond float64.
    pub fn build(&self) -> Result<Scene, SceneError> {
        let meshes = self.parts.iter().map(Part::build).collect::<Result<_, _>>()?;
        Scene::new(meshes)
    }

    fn check(&self) -> Result<(), SceneError> {
        let mut needed = 0_u64;
        for part in &self.parts {
            let what = format!("part '{}'", part.name);
            let colors = part.base_color.iter().chain([&part.roughness, &part.specular, &part.opacity]);
            if !colors.into_iter().all(|x| (0.0..=1.0).contains(x)) {
                return Err(SceneError::invalid(what, "base_color, roughness, specular and opacity lie in 0..=1"));
            }
            let triangles = shapes::checked_triangle_count(&part.of);
            needed = needed.saturating_add(triangles.map_err(|reason| SceneError::invalid(what, reason))?);
        }
        if needed > MAX_PROCEDURAL_TRIANGLES {
            let what = format!("triangles of scene '{}'", self.name);
            return Err(SceneError::TooLarge { what, needed, limit: MAX_PROCEDURAL_TRIANGLES });
        }
        self.light.check()?;
        self.camera.check()
    }
}

impl Part {
    fn build(&self) -> Result<Mesh, SceneError> {
        let (vertices, triangles) = shapes::build(&self.of);
        let Self { base_color, roughness, specular, opacity, .. } = *self;
        let material = Material { base_color, roughness, specular, opacity };
        Mesh::new(self.name.clone(), vertices, triangles, material)
    }
}

impl LightDescription {
    fn check(&self) -> Result<(), SceneError> {
        let sizes = match self.shape {
            LightShape::Rectangle { width, height } => [width, height],
            LightShape::Disc { radius } | LightShape::Sphere { radius } => [radius; 2],
            LightShape::Sun { angular_diameter_deg } => [angular_diameter_deg; 2],
        };
        if !sizes.iter().all(|&x| x > 0.0) {
            return Err(SceneError::invalid("light", "its sizes must be positive"));
        }
        if !self.radiance.iter().all(|&x| x >= 0.0) {
            return Err(SceneError::invalid("light", "its radiance must not be negative"));
        }
        check_axis("light", self.position, self.target, self.up)
    }
}

impl CameraDescription {
    fn check(&self) -> Result<(), SceneError> {
        if !(self.fov_y_deg > 0.0 && self.fov_y_deg < 180.0) {
            return Err(SceneError::invalid("camera", "fov_y_deg must lie between 0 and 180"));
        }
        if self.size.contains(&0) {
            return Err(SceneError::invalid("camera", "size must be at least 1 by 1 pixel"));
        }
        check_axis("camera", self.eye, self.target, self.up)
    }
}

/// A direction from one point to another and an up vector that is not parallel to it.
fn check_axis(what: &str, from: [f64; 3], to: [f64; 3], up: [f64; 3]) -> Result<(), SceneError> {
    let d = [0, 1, 2].map(|k| to[k] - from[k]);
    let cross = [d[1] * up[2] - d[2] * up[1], d[2] * up[0] - d[0] * up[2], d[0] * up[1] - d[1] * up[0]];
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length(cross) > 1e-9 * length(d) * length(up) {
        return Ok(());
    }
    Err(SceneError::invalid(what, "it must be apart from its target, and up must not point along the line to it"))
}
