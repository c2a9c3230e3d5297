//! The settings of `occlusion_layers`, and which calls they can serve.

use serde::{Deserialize, Serialize};
use softshadow_plan::Host;

use super::tables::table_bytes;
use crate::TechniqueError;

/// Settings of `occlusion_layers`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OcclusionLayers {
    /// Slices of the scene, 1 to 128.
    pub slices: u32,
    /// Texels a side of every slice: a power of two from 64 to 2,048.
    pub resolution: u32,
    /// How the share of a box is found.
    pub filter: Filter,
    /// Parts of the light a side, 1 to 8: slices are put together in each for itself.
    pub split: u32,
    /// How the slices before a receiver are put together.
    pub combine: Combine,
    /// From where the scene is projected onto its slices.
    pub projection: Projection,
    /// What is done about what lies between a receiver and the first slice before it.
    pub near: Near,
    /// Whether every slice is written into the next one, too: closes gaps where thin surfaces pass from slice to slice.
    pub repair_leaks: bool,
}

/// How the share of a box of texels that is set is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Exactly, from a summed-area table of whole numbers.
    SummedArea,
    /// Between means over squares of two powers of two, kept at every texel: for comparison.
    Nbuffer,
    /// As textures are made smaller: for comparison.
    Mipmap,
}

/// How the slices before a receiver are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// What passes each, multiplied: right for slices that know nothing of each other.
    Product,
    /// The one that hides most: never too dark.
    Maximum,
    /// What all hide, added up: never too bright.
    Sum,
}

/// From where the scene is projected onto its slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// From a point behind the light.
    Perspective,
    /// Straight along the light's emission: for comparison.
    Parallel,
}

/// What is done about what lies between a receiver and the first slice before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Near {
    /// It hides nothing, and that slice fades in from its own plane to the next: the paper.
    Fade,
    /// A short ray is traced to the middle of every part of the light.
    Rays,
}

impl Default for OcclusionLayers {
    fn default() -> Self {
        Self {
            slices: 8,
            resolution: 512,
            filter: Filter::SummedArea,
            split: 4,
            combine: Combine::Product,
            projection: Projection::Perspective,
            near: Near::Rays,
            repair_leaks: false,
        }
    }
}

/// Bytes of a receiver's bits of parts that something near hides.
pub(super) const NEAR_BYTES: u64 = 8;

pub(super) const NAME: &str = "occlusion_layers";
const SLICES: std::ops::RangeInclusive<u32> = 1..=128;
const RESOLUTIONS: std::ops::RangeInclusive<u32> = 64..=2048;
const SPLITS: std::ops::RangeInclusive<u32> = 1..=8;

fn fail(setting: &'static str, reason: String) -> Result<(), TechniqueError> {
    Err(TechniqueError::Setting { technique: NAME, setting, reason })
}

impl OcclusionLayers {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        if !SLICES.contains(&self.slices) {
            return fail("slices", format!("must lie between 1 and 128, got {}", self.slices));
        }
        if !RESOLUTIONS.contains(&self.resolution) || !self.resolution.is_power_of_two() {
            return fail("resolution", format!("must be a power of two from 64 to 2048, got {}", self.resolution));
        }
        if !SPLITS.contains(&self.split) {
            return fail("split", format!("must lie between 1 and 8, got {}", self.split));
        }
        Ok(())
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64) -> u64 {
        let near = if self.near == Near::Rays { NEAR_BYTES } else { 0 };
        4 * channels + near
    }

    pub(crate) fn check_call(&self, host: &Host) -> Result<(), TechniqueError> {
        let limit = host.limits.storage_binding_bytes.min(host.limits.buffer_bytes);
        let needed = table_bytes(self);
        if needed > limit {
            let most =
                (1..self.slices).rev().find(|slices| table_bytes(&Self { slices: *slices, ..self.clone() }) <= limit);
            let fewer = most.map_or(String::new(), |most| format!("at most {most} slices, or "));
            let reason = format!(
                "{} slices of {} texels a side take {needed} bytes, this device binds at most {limit}: take {fewer}a smaller resolution",
                self.slices, self.resolution
            );
            return fail("resolution", reason);
        }
        Ok(())
    }
}
