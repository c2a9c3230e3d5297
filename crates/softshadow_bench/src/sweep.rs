//! How steady techniques are: a light that slides, receivers that rise, and an object that slides by less than a pixel's worth a frame.
//!
//! In each frame the technique stands beside rays; what flickers is the change of its error from a frame to the next
//! (`softshadow::measure::compare_frames`).

use serde::Serialize;
use softshadow::measure::{Frame, TemporalReport, compare_frames};
use softshadow::{
    Context, Error, Evaluation, Light, Options, Points, Receivers, Scene, Technique, Visibility, visibility,
};

use crate::case::Case;
use crate::error::BenchError;
use crate::measure::Failure;
use crate::scenes::Measured;
use crate::table::Table;

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Moving {
    /// The light, along its own x axis by a tenth of the scene.
    Light,
    /// A level grid of receivers, from the lowest to the highest point of the scene.
    Receivers,
    /// The mesh of the most triangles, along x by a hundredth of the scene.
    Object,
}

const SWEEPS: [Moving; 3] = [Moving::Light, Moving::Receivers, Moving::Object];

/// One case over one sweep.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Sweep {
    case: String,
    technique: Technique,
    moving: Moving,
    frames: u32,
    /// `None` where no receiver is ever in the penumbra.
    steadiness: Option<TemporalReport>,
}

/// Every case over every sweep.
pub(crate) fn measure<'a>(
    context: &Context,
    measured: &Measured,
    cases: impl Iterator<Item = &'a Case>,
    reference: &Technique,
    frames: u32,
) -> Result<(Vec<Sweep>, Vec<Failure>), BenchError> {
    let cases: Vec<&Case> = cases.collect();
    let (mut sweeps, mut failures) = (Vec::new(), Vec::new());
    for moving in SWEEPS {
        let places = (0..frames).map(|frame| placed(measured, moving, f64::from(frame) / f64::from(frames - 1)));
        let places: Vec<Place> = places.collect::<Result<_, _>>()?;
        let truths = places.iter().map(|place| place.see(context, reference, true)).collect::<Result<Vec<_>, _>>()?;
        // Points have no neighbours to be averaged with, and no image to draw over.
        let serves = |case: &&&Case| moving != Moving::Receivers || !needs_image(&case.technique);
        for case in cases.iter().filter(serves) {
            match places.iter().map(|place| place.see(context, &case.technique, false)).collect::<Result<Vec<_>, _>>() {
                Ok(seen) => sweeps.push(Sweep {
                    case: case.text.clone(),
                    technique: case.technique.clone(),
                    moving,
                    frames,
                    steadiness: steadiness(&seen, &truths)?,
                }),
                Err(error) => failures.push(Failure { case: (*case).clone(), error: error.into() }),
            }
        }
    }
    Ok((sweeps, failures))
}

fn needs_image(technique: &Technique) -> bool {
    let is_blended = match technique {
        Technique::DepthComplexity(settings) => settings.evaluation == Evaluation::Blended,
        _ => false,
    };
    technique.interleaves() || is_blended
}

fn steadiness(seen: &[Visibility], truths: &[Visibility]) -> Result<Option<TemporalReport>, BenchError> {
    let frame = |(seen, truth): (_, _)| {
        let (seen, truth): (&Visibility, &Visibility) = (seen, truth);
        let standard_error = truth.standard_error.as_deref();
        // Owned by the results, which outlive the frames.
        (seen.values.as_slice(), truth.values.as_slice(), standard_error)
    };
    let parts: Vec<_> = seen.iter().zip(truths).map(frame).collect();
    let frames: Vec<Frame<'_>> =
        parts.iter().map(|&(values, reference, standard_error)| Frame { values, reference, standard_error }).collect();
    compare_frames(&frames).map_err(|error| Error::Measure(error.to_string()).into())
}

/// One frame.
struct Place {
    scene: Scene,
    light: Light,
    receivers: Receivers,
}

impl Place {
    fn see(&self, context: &Context, technique: &Technique, standard_error: bool) -> Result<Visibility, Error> {
        let options = Options { standard_error, ..Options::default() };
        let lights = std::slice::from_ref(&self.light);
        visibility(context, &self.scene, lights, &self.receivers, technique, &options, &mut |_, _| true)
    }
}

/// A sweep's frame at `at`, from 0 to 1.
fn placed(measured: &Measured, moving: Moving, at: f64) -> Result<Place, BenchError> {
    let Measured { scene, light, camera, .. } = measured;
    let (low, high) = scene.bounds().unwrap_or(([0.0; 3], [0.0; 3]));
    let span = [0, 1, 2].map(|k| high[k] - low[k]).into_iter().fold(0.0, f64::max);
    let mut place = Place { scene: scene.clone(), light: light.clone(), receivers: Receivers::Camera(*camera) };
    match moving {
        Moving::Light => {
            let mut pose = light.world_from_light();
            let step = 0.1 * span * (at - 0.5);
            (0..3).for_each(|k| pose[k][3] += step * pose[k][0]);
            place.light = Light::new(light.shape().clone(), pose)?.with_radiance(light.radiance())?;
        }
        Moving::Receivers => {
            let [columns, rows] = camera.size();
            let (width, height) = (f64::from(columns), f64::from(rows));
            let y = low[1] + at * (high[1] - low[1]);
            let point = |pixel: u32| {
                let (x, z) = ((f64::from(pixel % columns) + 0.5) / width, (f64::from(pixel / columns) + 0.5) / height);
                [low[0] + x * (high[0] - low[0]), y, low[2] + z * (high[2] - low[2])]
            };
            let points: Vec<[f64; 3]> = (0..columns * rows).map(point).collect();
            let up = vec![[0.0, 1.0, 0.0]; points.len()];
            place.receivers = Receivers::Points(Points::new(points, Some(up))?);
        }
        Moving::Object => {
            let largest = scene.meshes().iter().enumerate().max_by_key(|(_, mesh)| mesh.triangles.len());
            let moved = largest.map(|(index, mesh)| {
                let step = 0.01 * span * at;
                (index, mesh.vertices.iter().map(|[x, y, z]| [x + step, *y, *z]).collect::<Vec<_>>())
            });
            let mut vertices = vec![None; scene.meshes().len()];
            if let Some((index, moved)) = moved {
                vertices[index] = Some(moved);
            }
            place.scene = scene.with_vertices(vertices)?;
        }
    }
    Ok(place)
}

/// A line a case and sweep.
pub(crate) fn table(sweeps: &[Sweep]) -> Table {
    let header = "sweep|moving|frames|flicker|largest jump|reference's own|pairs";
    let mut table = Table::new(2, header.split('|'));
    for sweep in sweeps {
        let moving = format!("{:?}", sweep.moving).to_lowercase();
        let mut row = vec![sweep.case.clone(), moving, sweep.frames.to_string()];
        row.extend(match &sweep.steadiness {
            None => ["-", "-", "-", "0"].map(str::to_owned),
            Some(TemporalReport { pairs, flicker, largest_jump, reference_flicker }) => {
                let own = reference_flicker.map_or("-".into(), |own| format!("{own:.4}"));
                [format!("{flicker:.4}"), format!("{largest_jump:.3}"), own, pairs.to_string()]
            }
        });
        table.add(row);
    }
    table
}
