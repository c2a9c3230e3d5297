//! Lights in UsdLux's words.

use std::fmt::Display;

use super::model::{LightFields, LightType};
use super::placement::world_from_light;
use crate::light::{Light, LightShape};

/// A checked light. Sizes that are not given are UsdLux's own; the intensity is 1 for all, also for distant lights.
pub(super) fn build(fields: &LightFields) -> Result<Light, String> {
    refuse_foreign(fields)?;
    let shape = match fields.kind {
        LightType::Rect => {
            LightShape::Rectangle { width: fields.width.unwrap_or(1.0), height: fields.height.unwrap_or(1.0) }
        }
        LightType::Disk => LightShape::Disc { radius: fields.radius.unwrap_or(0.5) },
        LightType::Sphere => LightShape::Sphere { radius: fields.radius.unwrap_or(0.5) },
        LightType::Distant => LightShape::Sun { angular_diameter: fields.angle.unwrap_or(0.53).to_radians() },
    };
    let strength = fields.intensity.unwrap_or(1.0) * fields.exposure.unwrap_or(0.0).exp2();
    let radiance = fields.color.unwrap_or([1.0; 3]).map(|channel| (channel * strength) as f32);
    let text = |error: &dyn Display| error.to_string();
    let light = Light::new(shape, world_from_light(fields)?).map_err(|e| text(&e))?;
    light.with_radiance(radiance).map_err(|e| format!("color · intensity · 2^exposure: {e}"))
}

/// A size that this kind of light does not have would change nothing.
fn refuse_foreign(fields: &LightFields) -> Result<(), String> {
    let (name, own): (_, &[&str]) = match fields.kind {
        LightType::Rect => ("RectLight", &["width", "height"]),
        LightType::Disk => ("DiskLight", &["radius"]),
        LightType::Sphere => ("SphereLight", &["radius"]),
        LightType::Distant => ("DistantLight", &["angle"]),
    };
    let sizes =
        [("width", fields.width), ("height", fields.height), ("radius", fields.radius), ("angle", fields.angle)];
    match sizes.iter().find(|(size, value)| value.is_some() && !own.contains(size)) {
        Some((size, _)) => Err(format!("a {name} has no '{size}'; it has {}", own.join(" and "))),
        None => Ok(()),
    }
}
