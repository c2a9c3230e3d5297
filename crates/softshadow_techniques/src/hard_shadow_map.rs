//! # `hard_shadow_map`: one depth map from the light's centre
//!
//! The baseline: what does softness cost, and what does it change? Depth of the nearest occluder is drawn as seen from the
//! light's centre; a receiver is dark when something nearer lies in its texel. V is 0 or 1.
//!
//! **Parameters.** `resolution` of the map, 16 to 16,384 texels a side. There is no bias to find: the receiver's plane is
//! evaluated at the texel's centre, and what remains is half a texel and the slope within it.
//!
//! **When it is wrong.** Everywhere in a penumbra, by up to 1: the light is a point. Shadows end within a texel of where they
//! should; what lies inside a sphere light, but farther than half its radius from the centre, still shadows; gaps below about a
//! texel are not resolved, on strongly curved surfaces a texel's width of light or dark may show. Semi-opaque triangles are taken for
//! opaque, and every result says so.
//!
//! **Maps.** A frustum fitted to casters and receivers; beyond 120 degrees, or with the light inside the scene, six faces of a
//! cube; for a sun one parallel view.

use serde::{Deserialize, Serialize};
use softshadow_plan::{Kernel, Over, Plan, Values};
use softshadow_scene::Light;

use crate::TechniqueError;
use crate::parts::VISIBILITY;
use crate::parts::light_buffers::LightRecord;
use crate::parts::{receivers, seen_values, shadow_views};
use crate::request::Request;

/// Settings of `hard_shadow_map`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HardShadowMap {
    /// Texels a side.
    pub resolution: u32,
}

impl Default for HardShadowMap {
    fn default() -> Self {
        Self { resolution: 2048 }
    }
}

const LOOK_UP: Kernel = Kernel { file: "hard_shadow_map/look_up.wgsl", entry: "look_up" };

impl HardShadowMap {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        if (16..=16_384).contains(&self.resolution) {
            return Ok(());
        }
        let reason = format!("must lie between 16 and 16384, got {}", self.resolution);
        Err(TechniqueError::Setting { technique: "hard_shadow_map", setting: "resolution", reason })
    }
}

/// Depth of every view, then one lookup a receiver.
pub(crate) fn plan(request: &Request<'_>, settings: &HardShadowMap) -> Plan {
    let mut plan = Plan::new("hard shadow map");
    let count = request.block.count;
    let receivers = receivers::append(&mut plan, request);
    let light = plan.parameter("light", size_of::<LightRecord>() as u64);
    let bytes = count as u64 * 4 * u64::from(request.channels);
    let visibility = plan.persistent(VISIBILITY, bytes);
    let maps = shadow_views::append(&mut plan, request, settings.resolution);
    let over = Over::Items { count: count as u32, work_per_item: 1 };
    plan.compute("look up", "compares each receiver with the map", LOOK_UP, over)
        .bind("light", light)
        .bind("shadow_views", maps.views)
        .bind("depth_map", maps.depth)
        .bind("receivers", receivers)
        .bind("visibility", visibility);
    seen_values::append(&mut plan, request, receivers, light, visibility);
    plan
}

/// The values of the plan's parameters for one light.
pub(crate) fn values(request: &Request<'_>, settings: &HardShadowMap, light: &Light) -> Result<Values, TechniqueError> {
    let mut values = seen_values::values(request, light)?;
    shadow_views::values(request, settings.resolution, &mut values);
    Ok(values)
}
