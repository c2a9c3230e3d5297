//! A scene that moves: what a frame costs where the last one is refitted, and where its scene is made anew.

use serde::Serialize;
use softshadow::{Context, Scene, Technique, Timing, procedural};

use crate::case::Case;
use crate::error::BenchError;
use crate::measure::{Failure, Subjects, run};
use crate::scenes::Measured;
use crate::statistics::{median, range};
use crate::table::Table;

/// What one case costs on a scene in motion. Lists have an entry a frame.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Waving {
    case: String,
    technique: Technique,
    triangles: usize,
    /// From the last frame to this one: order, hierarchies, faces and edges.
    refit_ms: Vec<f64>,
    /// The same vertices as a scene that nobody has seen.
    build_ms: Vec<f64>,
    /// Shadows of the frame that was refitted, its upload included.
    wall_ms: Vec<f64>,
    /// The whole call on that frame.
    call_ms: Vec<f64>,
    /// Frames of which anything was made anew all the same, in the library's words.
    rebuild_reasons: Vec<String>,
    /// Receivers whose value is not that of the scene made anew, over all frames.
    differing_receivers: usize,
}

/// Every case by itself over one period of the scene's sway.
pub(crate) fn measure<'a>(
    context: &Context,
    subjects: &Subjects,
    cases: impl Iterator<Item = &'a Case>,
    frames: u32,
) -> (Vec<Waving>, Vec<Failure>) {
    let (mut measured, mut failures) = (Vec::new(), Vec::new());
    for case in cases {
        match sway(context, &subjects.of(case).measured, case, frames) {
            Ok(waving) => measured.push(waving),
            Err(error) => failures.push(Failure { case: case.clone(), error }),
        }
    }
    (measured, failures)
}

fn sway(context: &Context, measured: &Measured, case: &Case, frames: u32) -> Result<Waving, BenchError> {
    // Another case has left its last frame in the caches; this scene is nobody's next one.
    let still = anew(&measured.scene)?;
    let shadows = |scene: Scene| run(context, &Measured { scene, ..measured.clone() }, case, Timing::Device);
    shadows(procedural::waving(&still, 0.0)?)?;
    let mut waving = Waving {
        case: case.text.clone(),
        technique: case.technique.clone(),
        triangles: still.triangle_count(),
        refit_ms: Vec::new(),
        build_ms: Vec::new(),
        wall_ms: Vec::new(),
        call_ms: Vec::new(),
        rebuild_reasons: Vec::new(),
        differing_receivers: 0,
    };
    for frame in 1..=frames {
        let now = procedural::waving(&still, f64::from(frame) / f64::from(frames))?;
        let fresh = anew(&now)?;
        let (moved, made) = (shadows(now)?, shadows(fresh)?);
        waving.refit_ms.push(moved.seen.info.preparation.preparation_ms);
        waving.build_ms.push(made.seen.info.preparation.preparation_ms);
        waving.wall_ms.push(moved.seen.info.wall_ms);
        waving.call_ms.push(moved.call_ms);
        waving.rebuild_reasons.extend(moved.seen.info.preparation.rebuild_reasons);
        let values = moved.seen.values.iter().zip(&made.seen.values);
        waving.differing_receivers += values.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    }
    Ok(waving)
}

fn anew(scene: &Scene) -> Result<Scene, BenchError> {
    Ok(Scene::new(scene.meshes().to_vec())?)
}

/// A line a case; milliseconds of a frame.
pub(crate) fn table(rows: &[Waving]) -> Table {
    let header = "waving|frames|refit ms|from|to|build ms|refit : build|ms|from|to|call ms|rebuilt|differing";
    let mut table = Table::new(1, header.split('|'));
    for row in rows {
        let ratios: Vec<f64> = row.refit_ms.iter().zip(&row.build_ms).map(|(refit, build)| refit / build).collect();
        let tenths = |ms: f64| format!("{ms:.1}");
        let spread = |ms: &[f64]| [median(ms), range(ms)[0], range(ms)[1]].map(tenths);
        let mut cells = vec![row.case.clone(), row.refit_ms.len().to_string()];
        cells.extend(spread(&row.refit_ms));
        cells.extend([tenths(median(&row.build_ms)), format!("{:.2}", median(&ratios))]);
        cells.extend(spread(&row.wall_ms));
        cells.push(tenths(median(&row.call_ms)));
        cells.extend([row.rebuild_reasons.len(), row.differing_receivers].map(|count| count.to_string()));
        table.add(cells);
    }
    table
}
