//! The fields of a `scene.json`. `scene.schema.json` beside this folder says the same to editors; a test compares both.

use serde::Deserialize;

/// An affine map, row-major, of column vectors.
pub(super) type Matrix = [[f64; 4]; 4];

/// The version of the format that is read.
pub(super) const VERSION: u64 = 1;

/// The version alone: a file of another one may have other fields.
#[derive(Deserialize)]
pub(super) struct Version {
    pub(super) softshadow: Option<serde_json::Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    /// For editors.
    #[serde(rename = "$schema")]
    _schema: Option<String>,
    #[serde(rename = "softshadow")]
    _version: u64,
    #[serde(default = "one")]
    pub(super) meters_per_unit: f64,
    pub(super) meshes: Vec<MeshFields>,
    #[serde(default)]
    pub(super) lights: Vec<LightFields>,
    pub(super) camera: Option<CameraFields>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshFields {
    pub(super) path: String,
    pub(super) name: Option<String>,
    /// The unit of the mesh's file: 1 for glTF, which is in metres, else that of the scene.
    pub(super) meters_per_unit: Option<f64>,
    pub(super) world_from_mesh: Option<Matrix>,
    pub(super) translate: Option<[f64; 3]>,
    pub(super) rotate_xyz_deg: Option<[f64; 3]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) material: Option<MaterialFields>,
    pub(super) opacity: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialFields {
    pub(super) base_color: Option<[f32; 3]>,
    pub(super) roughness: Option<f32>,
    pub(super) specular: Option<f32>,
}

/// UsdLux's words. One struct for all kinds, so that messages name the field's place; `light.rs` checks who may have what.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightFields {
    #[serde(rename = "type")]
    pub(super) kind: LightType,
    pub(super) name: Option<String>,
    pub(super) width: Option<f64>,
    pub(super) height: Option<f64>,
    pub(super) radius: Option<f64>,
    /// Of a distant light, in degrees.
    pub(super) angle: Option<f64>,
    pub(super) color: Option<[f64; 3]>,
    pub(super) intensity: Option<f64>,
    /// In stops.
    pub(super) exposure: Option<f64>,
    pub(super) world_from_light: Option<Matrix>,
    pub(super) translate: Option<[f64; 3]>,
    pub(super) rotate_xyz_deg: Option<[f64; 3]>,
    pub(super) target: Option<[f64; 3]>,
    pub(super) up: Option<[f64; 3]>,
}

#[derive(Deserialize, Debug, Clone, Copy, PartialEq)]
pub(super) enum LightType {
    #[serde(rename = "RectLight")]
    Rect,
    #[serde(rename = "DiskLight")]
    Disk,
    #[serde(rename = "SphereLight")]
    Sphere,
    #[serde(rename = "DistantLight")]
    Distant,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraFields {
    pub(super) eye: [f64; 3],
    pub(super) target: [f64; 3],
    pub(super) up: Option<[f64; 3]>,
    pub(super) fov_y_deg: f64,
    pub(super) size: [u32; 2],
}

fn one() -> f64 {
    1.0
}
