//! What made a result: every result carries it.

use serde::Serialize;
use softshadow_plan::{AdapterInfo, PassTime, RunReport};
use softshadow_scene::{Light, LightShape, LocalScene, Scene};
use softshadow_techniques::Technique;
use softshadow_techniques::depth_complexity::Evaluation;

use crate::choose::Choice;

/// Adapter, technique, cost, and how well the values are known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Info {
    /// The device.
    pub adapter: AdapterInfo,
    /// The technique and all its settings.
    pub technique: Technique,
    /// Lights.
    pub lights: usize,
    /// Receivers asked for.
    pub receivers: usize,
    /// Receivers that see anything at all; unknown where results stay on the device.
    pub valid_receivers: Option<usize>,
    /// Receivers for which rays were traced, added up over lights, passes and sub-scenes; the others have nothing between them
    /// and the light.
    pub traced_receivers: u64,
    /// Receivers for which the first 64 samples let the visible area of a light answer, added up over lights and passes. Of more than
    /// 64 samples the others may contradict, and answer after all.
    pub area_receivers: u64,
    /// Silhouette edges in the lists of all tiles, added up over lights and passes.
    pub silhouette_edges: u64,
    /// Receivers with more silhouettes before them than `occlusion_camera` found in its steps, added up over lights.
    pub colliding_receivers: u64,
    /// Most steps that `occlusion_camera` took for any receiver.
    pub camera_steps: u32,
    /// The largest distance, in world units along a light's view, by which something had to be nearer to the light than a receiver moved by
    /// `occlusion_camera` to hide it.
    pub camera_bias: f64,
    /// What `depth_complexity` folded for each light: `edges`, `triangles`, or `none` where nothing can hide it.
    pub occluder_units: Vec<&'static str>,
    /// Triangles that the planes of lights cut.
    pub cut_triangles: usize,
    /// Triangles that touch balls of light and were tried sample by sample, added up over lights; by `depth_complexity` only.
    pub touching_triangles: usize,
    /// Triangles that lie behind lights and were left out for them, added up over lights.
    pub triangles_behind: usize,
    /// How this call came to its scene, apart from `wall_ms`.
    #[serde(flatten)]
    pub preparation: Preparation,
    /// Wall time from plan to values in milliseconds.
    pub wall_ms: f64,
    /// Time by pass, where the device has a clock.
    pub pass_ms: Vec<PassTime>,
    /// Exact bytes on the device by resource.
    pub bytes: Vec<(String, u64)>,
    /// Command buffers handed to the device.
    pub submissions: usize,
    /// Blocks of receivers.
    pub blocks: usize,
    /// Triangles without area, left out.
    pub zero_area_triangles: usize,
    /// Triangles that vanish in local float32, left out.
    pub unresolved_triangles: usize,
    /// Triangles of opacity 0, left out.
    pub invisible_triangles: usize,
    /// What the scene's file holds that is not modelled, what the technique does not, and settings that the call could not follow.
    pub notes: Vec<String>,
    /// `statistical`: values have a standard error, or a bound holds with a confidence. `none`: nothing is known about their error. Of results
    /// that were chosen for their error also `certified` and `measured`.
    pub error_kind: &'static str,
    /// Root mean square of the standard error over the penumbra, where there is one.
    pub standard_error: Option<f64>,
    /// How the technique was chosen and how wrong the result is, where an error or a time was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<Box<Choice>>,
    /// The passes, why each is there, and what each resource weighs.
    pub plan: String,
}

/// What a call made of its scene before it ran; all zeros where everything was kept from earlier calls.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Preparation {
    /// Whether the scene was laid out anew, 0 or 1.
    pub scene_builds: usize,
    /// Whether it was made from an earlier frame of a moving scene, 0 or 1.
    pub scene_refits: usize,
    /// Lights for which faces and edges were made anew. Lights that leave the same triangles whole share them.
    pub occluder_builds: usize,
    /// Lights for which they were made from an earlier frame.
    pub occluder_refits: usize,
    /// Why something was made anew though an earlier frame or another light had left it, in words; no entry for what is new.
    pub rebuild_reasons: Vec<String>,
    /// Milliseconds of all that.
    pub preparation_ms: f64,
}

impl Info {
    pub(crate) fn add_run(&mut self, run: RunReport) {
        self.wall_ms = run.wall_ms;
        self.pass_ms = run.pass_ms;
        self.bytes = run.bytes;
        self.submissions = run.submissions;
    }
}

/// What a result does not model of its scene and lights, and settings that a call cannot follow where it answers all the same, in words.
pub(crate) fn notes(scene: &Scene, lights: &[Light], technique: &Technique, local: &LocalScene) -> Vec<String> {
    let semi_opaque = local.opacities.iter().filter(|opacity| **opacity < 1.0).count();
    let maps = matches!(
        technique,
        Technique::HardShadowMap(_)
            | Technique::PenumbraMap(_)
            | Technique::OcclusionCamera(_)
            | Technique::OcclusionLayers(_)
    );
    let name = technique.name();
    let taken = (semi_opaque > 0 && maps)
        .then(|| format!("{semi_opaque} semi-opaque triangles taken for opaque: {name} knows no others"));
    let by_samples = match technique {
        Technique::DepthComplexity(settings) if settings.exact_area && settings.evaluation == Evaluation::Blended => {
            Some("exact_area: evaluation 'blended' answers by samples alone".into())
        }
        _ => None,
    };
    let outlines = if matches!(technique, Technique::PenumbraMap(_)) { outline_notes(lights) } else { Vec::new() };
    scene.notes().iter().cloned().chain(taken).chain(by_samples).chain(outlines).collect()
}

/// What `penumbra_map` leaves out of lights.
fn outline_notes(lights: &[Light]) -> Vec<String> {
    let textured = lights.iter().filter(|light| light.texture().is_some()).count();
    let concave = lights.iter().filter(|light| is_concave(light.shape())).count();
    let textures =
        (textured > 0).then(|| format!("textures of {textured} lights left out: penumbra_map knows outlines"));
    let hulls = (concave > 0).then(|| format!("{concave} concave polygons taken for their hulls by penumbra_map"));
    textures.into_iter().chain(hulls).collect()
}

/// Whether an outline turns both ways.
fn is_concave(shape: &LightShape) -> bool {
    let LightShape::Polygon { outline } = shape else { return false };
    let corner = |i: usize| outline[i % outline.len()];
    let turn = |i: usize| {
        let ([ax, ay], [bx, by], [cx, cy]) = (corner(i), corner(i + 1), corner(i + 2));
        (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
    };
    let turns = || (0..outline.len()).map(turn);
    turns().any(|t| t > 0.0) && turns().any(|t| t < 0.0)
}

/// From this share of the casters' area on, what is seen from the side is worth a word. Of surfaces that look everywhere alike 0.08 is.
const MUCH_EDGE_ON: f64 = 0.2;

/// What slices of the scene miss of a light's casters, where that is much.
pub(crate) fn edge_on_note(light: usize, share: f64) -> Option<String> {
    (share > MUCH_EDGE_ON).then(|| {
        let percent = (share * 100.0).round();
        format!(
            "light {light} sees {percent} % of the area of what can hide it from the side, as walls under a lamp: slices do not hold it, \
             so its shadows are too bright; use ray_traced or depth_complexity"
        )
    })
}
