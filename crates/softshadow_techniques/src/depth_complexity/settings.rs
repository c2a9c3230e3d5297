//! The settings of `depth_complexity`, and which calls they can serve.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use softshadow_plan::{Content, Host};
use softshadow_scene::{Light, LightSampling, LightShape, SamplePattern, SampleSpread, pass_seed};

use super::blended::{self, BASES};
use super::tiled::{self, SLOT_BYTES};
use super::unit::OccluderUnit;
use super::values::{MOST_SAMPLES, SET_SAMPLES};
use crate::TechniqueError;
use crate::parts::interleaving::{self, NOISY_BYTES};
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::opacity::{self, OpacityContents};
use crate::parts::scene_buffers::SceneContents;
use crate::parts::{pattern_name, spread};
use crate::request::ReceiverSource;

/// Digits of the smallest base take the fewest words where counts stay small, and wider ones are found where they do not.
const SMALLEST_BASE: u32 = BASES[0];

/// Settings of `depth_complexity`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DepthComplexity {
    /// Light samples of one pass, 1 to 256.
    pub samples: u32,
    /// How they are spread.
    #[serde(with = "pattern_name")]
    pub pattern: SamplePattern,
    /// Which set of them.
    pub seed: u32,
    /// Progressive passes.
    pub passes: u32,
    /// Whether the light's visible area answers where a single layer hides it; the blended evaluation knows samples alone.
    pub exact_area: bool,
    /// What is folded: silhouette edges, or triangles.
    pub unit: OccluderUnit,
    /// Which edges count.
    pub silhouettes: Silhouettes,
    /// How samples beyond an edge are found, where all receivers share samples that stand still.
    pub coverage: Coverage,
    /// Which receivers share a set of samples; the blended evaluation knows one set for all.
    #[serde(with = "spread")]
    pub spread: SampleSpread,
    /// Side of the square of pixels that interleaves, 2 to 8.
    pub tile: u32,
    /// How several semi-opaque layers add up; the blended evaluation knows opaque ones alone.
    pub attenuation: Attenuation,
    /// How edges find their receivers.
    pub evaluation: Evaluation,
    /// Blended only: how layers over the reference point are counted.
    pub initial_counts: InitialCounts,
    /// Blended only: where counters are kept.
    pub counters: Counters,
    /// Blended only: the smallest base of a counter's digit, 8, 16, 64 or 256. Where counts can be larger, a larger one is taken.
    pub base: u32,
    /// Blended only: 1 counts changes as they come, 2 all that add before all that take away.
    pub batches: u32,
}

/// How samples beyond an edge are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coverage {
    /// Looked up, and tested where they lie near the edge: as tests of all would say.
    Exact,
    /// Looked up alone, as published: samples near an edge may count for its other side.
    Table,
}

/// Which edges count as silhouettes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Silhouettes {
    /// All that are silhouettes for any part of the light: the answer of rays.
    Accurate,
    /// Those of one point near its middle: fewer, and wrong where they end or a round body hides part of the light alone.
    Standard,
}

/// How edges find their receivers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evaluation {
    /// Tiles of receivers list their edges, in compute shaders; for points and cameras.
    Tiled,
    /// Edges are drawn as wedges over the camera's image, and counters added by the hardware.
    Blended,
}

/// How several semi-opaque layers add up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Attenuation {
    /// Logarithms: what passes is the product of what passes each.
    #[default]
    Logarithmic,
    /// Opacities, as in the paper: right for a single layer, too dark for more.
    Sum,
}

/// How the blended evaluation counts layers over the reference point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InitialCounts {
    /// By a ray a receiver, with the signs by which edges count: as in tiles.
    Rays,
    /// By shadow volumes behind the receiver, as published: wrong for some receivers next to edges and in contact.
    ZFail,
}

/// Where the blended evaluation keeps its counters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Counters {
    /// In 32-bit words, by atomics: on every host, in any order.
    Words,
    /// In float32 colour targets, by additive blending, as published.
    Float,
}

impl Default for DepthComplexity {
    fn default() -> Self {
        Self {
            samples: 64,
            pattern: SamplePattern::Stratified,
            seed: 0,
            passes: 1,
            exact_area: true,
            unit: OccluderUnit::Auto,
            silhouettes: Silhouettes::Accurate,
            coverage: Coverage::Exact,
            spread: SampleSpread::Correlated,
            tile: spread::TILE,
            attenuation: Attenuation::default(),
            evaluation: Evaluation::Tiled,
            initial_counts: InitialCounts::Rays,
            counters: Counters::Words,
            base: SMALLEST_BASE,
            batches: 1,
        }
    }
}

impl Attenuation {
    /// What each triangle takes away.
    pub(super) fn of(self, opacity: &OpacityContents) -> &Content {
        match self {
            Self::Logarithmic => &opacity.halvings,
            Self::Sum => &opacity.shares,
        }
    }
}

impl DepthComplexity {
    pub(crate) fn check(&self) -> Result<(), TechniqueError> {
        let fail =
            |setting, reason: String| Err(TechniqueError::Setting { technique: "depth_complexity", setting, reason });
        if self.samples == 0 || self.samples > MOST_SAMPLES {
            let reason = format!("must lie between 1 and {MOST_SAMPLES}, got {}; more come as passes", self.samples);
            return fail("samples", reason);
        }
        if self.passes == 0 {
            return fail("passes", "must be at least 1".into());
        }
        if !BASES.contains(&self.base) {
            return fail("base", format!("must be 8, 16, 64 or 256, got {}", self.base));
        }
        if !(1..=2).contains(&self.batches) {
            return fail("batches", format!("must be 1 or 2, got {}", self.batches));
        }
        if self.evaluation == Evaluation::Blended && self.spread != SampleSpread::Correlated {
            return fail("spread", "must be 'correlated' for evaluation 'blended'; use 'tiled'".into());
        }
        let has_tiles = self.evaluation == Evaluation::Tiled && self.spread == SampleSpread::Correlated;
        if self.unit == OccluderUnit::Triangles && !has_tiles {
            return fail("unit", "'triangles' needs evaluation 'tiled' and spread 'correlated'; use 'edges'".into());
        }
        let looks_up = self.evaluation == Evaluation::Tiled && self.spread == SampleSpread::Correlated;
        if self.coverage == Coverage::Table && !looks_up {
            return fail("coverage", "'table' needs evaluation 'tiled' and spread 'correlated'; use 'exact'".into());
        }
        spread::check("depth_complexity", &self.sampling(0), SET_SAMPLES)?;
        if self.evaluation == Evaluation::Blended && self.attenuation != Attenuation::default() {
            return fail(
                "attenuation",
                "counts for evaluation 'tiled' alone: 'blended' knows opaque triangles only".into(),
            );
        }
        let defaults = Self::default();
        let changed = [
            ("initial_counts", self.initial_counts != defaults.initial_counts),
            ("counters", self.counters != defaults.counters),
            ("base", self.base != defaults.base),
            ("batches", self.batches != defaults.batches),
        ];
        match changed.iter().find(|(_, differs)| self.evaluation == Evaluation::Tiled && *differs) {
            Some((setting, _)) => fail(setting, "counts for evaluation 'blended' alone".into()),
            None => Ok(()),
        }
    }

    /// Whether wedges can be drawn for these receivers and lights on this host.
    pub(crate) fn check_call(
        &self,
        receivers: ReceiverSource<'_>,
        lights: &[Light],
        host: &Host,
    ) -> Result<(), TechniqueError> {
        let fail = |setting, reason: &str| {
            Err(TechniqueError::Setting { technique: "depth_complexity", setting, reason: reason.into() })
        };
        let is_sphere = |light: &Light| matches!(light.shape(), LightShape::Sphere { .. });
        let is_camera = matches!(receivers, ReceiverSource::Camera(_));
        match self.evaluation {
            Evaluation::Tiled => Ok(()),
            Evaluation::Blended if !is_camera => {
                fail("evaluation", "'blended' draws over a camera's image and knows no points; use 'tiled'")
            }
            Evaluation::Blended if self.counters == Counters::Float && !host.features.float32_blendable => fail(
                "counters",
                "'float' needs float32-blendable, which this device lacks; use 'words', or evaluation 'tiled'",
            ),
            Evaluation::Blended if self.initial_counts == InitialCounts::ZFail && lights.iter().any(is_sphere) => fail(
                "initial_counts",
                "'z_fail' needs one reference point, and that of a sphere light moves with the receiver; use 'rays'",
            ),
            Evaluation::Blended => Ok(()),
        }
    }

    /// Whether layers of this scene can be counted: blended counters and masks of triangles hold opaque ones.
    pub(crate) fn check_scene(&self, scene: &SceneContents) -> Result<(), TechniqueError> {
        let fail = |setting, reason: &str| {
            Err(TechniqueError::Setting { technique: "depth_complexity", setting, reason: reason.into() })
        };
        match (self.evaluation, self.unit) {
            _ if scene.opacity.is_none() => Ok(()),
            (Evaluation::Blended, _) => fail(
                "evaluation",
                "'blended' counts opaque triangles alone, and the scene has semi-opaque ones; use 'tiled'",
            ),
            (_, OccluderUnit::Triangles) => fail(
                "unit",
                "'triangles' hide what is behind them wholly, and the scene has semi-opaque ones; use 'edges'",
            ),
            (Evaluation::Tiled, _) => Ok(()),
        }
    }

    /// Whether all that hides the lights can be drawn: no wedge says where the shadow of a triangle ends that touches a ball of light.
    pub(crate) fn check_occluders(&self, occluders: &[Arc<OccluderContents>]) -> Result<(), TechniqueError> {
        match self.evaluation {
            Evaluation::Blended if occluders.iter().any(|o| o.touching.is_some()) => Err(TechniqueError::Setting {
                technique: "depth_complexity",
                setting: "evaluation",
                reason: "'blended' draws edges alone, and triangles touch a sphere light; use 'tiled'".into(),
            }),
            Evaluation::Blended | Evaluation::Tiled => Ok(()),
        }
    }

    /// Stages of one pass: wedges are drawn once to bound counters, and once to count.
    pub(crate) fn stages(&self) -> u32 {
        match self.evaluation {
            Evaluation::Tiled => 1,
            Evaluation::Blended => 2,
        }
    }

    /// From 16 samples on, each 1.5 or 1.33 times as many; beyond 256 twice as many passes each time, with samples of their own.
    pub(crate) fn rising_quality(&self) -> impl Iterator<Item = Self> {
        spread::rising_samples(MOST_SAMPLES).map(|(samples, passes)| Self { samples, passes, ..self.clone() })
    }

    /// How a pass samples the light.
    #[must_use]
    pub fn sampling(&self, pass: u32) -> LightSampling {
        let Self { samples, pattern, seed, spread, tile, .. } = *self;
        LightSampling { pattern, count: samples, seed: pass_seed(seed, pass), spread, tile }
    }

    pub(crate) fn halo_rows(&self) -> u32 {
        interleaving::halo_rows(&self.sampling(0))
    }

    pub(crate) fn bytes_per_receiver(&self, channels: u64, is_semi_opaque: bool) -> u64 {
        let passes = if is_semi_opaque { opacity::bytes_per_receiver(self.samples) } else { 0 };
        let area = if self.exact_area && channels == 1 && self.evaluation == Evaluation::Tiled { 4 } else { 0 };
        let noisy = if self.spread == SampleSpread::Interleaved { NOISY_BYTES } else { 0 };
        // What both evaluations have: order, slot, mask, decided samples, lists; values and their errors.
        let common = 4 + SLOT_BYTES + u64::from(self.words()) * 4 + 4 + 8 * channels + tiled::list_bytes_per_receiver();
        common
            + match self.evaluation {
                Evaluation::Tiled => area + noisy + passes,
                Evaluation::Blended => blended::bytes_per_receiver(self),
            }
    }

    pub(super) fn words(&self) -> u32 {
        self.samples.div_ceil(32)
    }
}
