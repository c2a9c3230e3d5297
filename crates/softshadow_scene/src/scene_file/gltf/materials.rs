//! The part of a glTF material that pictures and shadows use.

use std::collections::BTreeSet;

use ::gltf::json::material::{AlphaMode, Material as JsonMaterial};
use ::gltf::json::validation::Checked;

use crate::mesh::Material;

/// Reflectance at normal incidence of the dielectric that section 3.9.2 of the specification assumes.
const DIELECTRIC_SPECULAR: f32 = 0.04;

/// Base colour, roughness and opacity; what is left out goes into the notes. Numbers outside 0..=1 are clamped.
pub(super) fn read(material: &JsonMaterial, notes: &mut BTreeSet<String>) -> Material {
    let pbr = &material.pbr_metallic_roughness;
    let has_texture = pbr.base_color_texture.is_some()
        || pbr.metallic_roughness_texture.is_some()
        || material.occlusion_texture.is_some()
        || material.emissive_texture.is_some();
    let is_emissive = material.emissive_factor.0 != [0.0; 3];
    for (is_left_out, note) in [
        (has_texture, "textures left out"),
        (material.normal_texture.is_some(), "normal maps left out"),
        (pbr.metallic_factor.0 > 0.0, "metallic factors left out"),
        (is_emissive, "emissive factors left out"),
        (material.alpha_mode == Checked::Valid(AlphaMode::Mask), "alpha masks left out; their surfaces are opaque"),
    ] {
        if is_left_out {
            notes.insert(note.into());
        }
    }
    let [red, green, blue, alpha] = pbr.base_color_factor.0;
    // Alpha means coverage in no other mode (section 3.9.4).
    let is_blended = material.alpha_mode == Checked::Valid(AlphaMode::Blend);
    Material {
        base_color: [red, green, blue].map(|x| x.clamp(0.0, 1.0)),
        roughness: pbr.roughness_factor.0.clamp(0.0, 1.0),
        specular: DIELECTRIC_SPECULAR,
        opacity: if is_blended { alpha.clamp(0.0, 1.0) } else { 1.0 },
    }
}
