//! A scene in motion: everything above its floor sways, as grass and flags do.

use std::f64::consts::TAU;

use crate::error::SceneError;
use crate::scene::Scene;

/// How far the highest point sways, as a part of the scene's height: enough that silhouettes and hierarchies change visibly, little
/// enough that nothing turns inside out.
const REACH: f64 = 0.1;

/// Waves across the scene.
const WAVES: f64 = 2.0;

/// A frame of a still scene that sways: `turns` counts its periods, and whole numbers give the same frame. Sway grows with the height
/// over the lowest point, so that a floor stays where it is. Y is up.
///
/// Every frame is a [`Scene::with_vertices`] of the still scene.
///
/// # Errors
/// [`SceneError::NotFinite`] for scenes near the end of float64.
pub fn waving(still: &Scene, turns: f64) -> Result<Scene, SceneError> {
    let (low, high) = still.bounds().unwrap_or_default();
    let width = (high[0] - low[0]).max(high[2] - low[2]);
    // A scene without width has no waves across it.
    let waves_per_length = if width > 0.0 { WAVES / width } else { 0.0 };
    let sway = |v: &[f64; 3]| {
        let (sine, cosine) = (TAU * (turns.fract() + (v[0] + v[2]) * waves_per_length)).sin_cos();
        let reach = REACH * (v[1] - low[1]);
        [v[0] + reach * sine, v[1], v[2] + reach * cosine]
    };
    let frames = still.meshes().iter().map(|mesh| Some(mesh.vertices.iter().map(sway).collect()));
    still.with_vertices(frames.collect())
}
