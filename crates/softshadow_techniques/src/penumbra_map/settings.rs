//! Settings of `penumbra_map`, and what it cannot serve.

use serde::{Deserialize, Serialize};
use softshadow_scene::{Light, LightShape};

use super::record;
use crate::TechniqueError;

/// Settings of `penumbra_map`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PenumbraMap {
    /// Texels a side, of both maps.
    pub resolution: u32,
    /// How intensity becomes light.
    pub ramp: Ramp,
}

impl Default for PenumbraMap {
    fn default() -> Self {
        Self { resolution: 1024, ramp: Ramp::Light }
    }
}

/// From where a fragment lies between occluder and surface to how much light passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ramp {
    /// As much as lies of the light's outline on one side of a line that moves across it.
    Light,
    /// In proportion.
    Linear,
    /// The paper's intensity, and its Bernstein interpolant.
    Paper,
}

impl PenumbraMap {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        if (16..=16_384).contains(&self.resolution) {
            return Ok(());
        }
        let reason = format!("must lie between 16 and 16384, got {}", self.resolution);
        Err(TechniqueError::Setting { technique: "penumbra_map", setting: "resolution", reason })
    }

    /// Whether cones have a section: distances from a polygon's centre need it within, and room for its corners.
    #[expect(clippy::unused_self, reason = "all techniques ask their settings")]
    pub(crate) fn check_call(&self, lights: &[Light]) -> Result<(), TechniqueError> {
        for (index, light) in lights.iter().enumerate() {
            let LightShape::Polygon { outline } = light.shape() else { continue };
            let fail =
                |reason: String| Err(TechniqueError::Setting { technique: "penumbra_map", setting: "light", reason });
            let hull = record::convex_hull(outline);
            if hull.len() > record::MOST_CORNERS {
                return fail(format!(
                    "the hull of polygon {index} has {} corners, and at most {} are drawn; use a disc, or trace rays",
                    hull.len(),
                    record::MOST_CORNERS
                ));
            }
            if !record::holds_its_center(&hull) {
                return fail(format!(
                    "the origin of polygon {index} must lie within its outline, where the maps are seen from; move the outline"
                ));
            }
        }
        Ok(())
    }
}
