//! One run of the benchmark: scene by scene, said as soon as it is known.

use std::fs::File;
use std::io::Write;

use serde::Serialize;
use softshadow::{Context, DeviceKind, Technique};

use crate::Arguments;
use crate::case::Case;
use crate::error::BenchError;
use crate::measure::{Failure, Subject, Subjects, take_turns};
use crate::progress::Progress;
use crate::ratios::{self, MeasuredRatio};
use crate::reference;
use crate::report::{self, Environment, Place, Row};
use crate::resume::{self, Known};
use crate::scenes::{self, Measured};
use crate::sweep::{self, Sweep};
use crate::waving::{self, Waving};

/// Measured where neither cases nor ratios are asked for.
const DEFAULT_CASES: [&str; 5] = [
    "hard_shadow_map",
    "ray_traced:samples=64",
    "depth_complexity:samples=16",
    "depth_complexity:samples=64",
    "depth_complexity:samples=256",
];

pub(crate) struct Session<'a> {
    arguments: &'a Arguments,
    out: &'a mut dyn Write,
    json: Option<File>,
    /// What an earlier run has measured.
    known: Known,
    progress: Progress,
    context: Context,
    environment: Environment,
    cases: Vec<Case>,
    skipped: usize,
    failed: usize,
}

/// A line of JSON about a ratio.
#[derive(Serialize)]
struct RatioLine<'a> {
    kind: &'static str,
    scene: &'a str,
    size: [u32; 2],
    #[serde(flatten)]
    ratio: &'a MeasuredRatio,
    environment: &'a Environment,
}

/// A line of JSON about a case on a scene that moves.
#[derive(Serialize)]
struct WavingLine<'a> {
    kind: &'static str,
    scene: &'a str,
    size: [u32; 2],
    #[serde(flatten)]
    waving: &'a Waving,
    environment: &'a Environment,
}

/// A line of JSON about a case while something moves.
#[derive(Serialize)]
struct SweepLine<'a> {
    kind: &'static str,
    scene: &'a str,
    size: [u32; 2],
    #[serde(flatten)]
    sweep: &'a Sweep,
    reference: &'a Technique,
    environment: &'a Environment,
}

/// A line of JSON about what was not measured.
#[derive(Serialize)]
struct AbsentLine<'a> {
    kind: &'static str,
    scene: &'a str,
    size: [u32; 2],
    case: Option<&'a str>,
    reason: String,
}

impl<'a> Session<'a> {
    pub(crate) fn new(arguments: &'a Arguments, out: &'a mut dyn Write) -> Result<Self, BenchError> {
        let mut cases = Vec::new();
        arguments.cases.iter().for_each(|case| ratios::add_case(&mut cases, case.clone()));
        if let Some(chosen) = arguments.ratios {
            ratios::cases(chosen)?.into_iter().for_each(|case| ratios::add_case(&mut cases, case));
        }
        if cases.is_empty() {
            cases = DEFAULT_CASES.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
        }
        let context = Context::new(&arguments.device)?;
        let environment = Environment::of(context.adapter());
        let (json, known) = match &arguments.json {
            Some(path) if arguments.resume => {
                let (file, known) = resume::open(path, &environment)?;
                (Some(file), known)
            }
            Some(path) => {
                let file = File::create(path).map_err(|error| BenchError::file(path.display().to_string(), error))?;
                (Some(file), Known::default())
            }
            None => (None, Known::default()),
        };
        let mut session = Self {
            arguments,
            out,
            json,
            known,
            progress: Progress::on_stderr(),
            context,
            environment,
            cases,
            skipped: 0,
            failed: 0,
        };
        session.leave_out_what_draws()?;
        Ok(session)
    }

    /// Everything is measured on one device with the same receivers: one that does not draw triangles leaves out what does.
    fn leave_out_what_draws(&mut self) -> Result<(), BenchError> {
        if self.context.adapter().device_type != DeviceKind::Native {
            return Ok(());
        }
        let (drawn, cases): (Vec<Case>, Vec<Case>) = self.cases.drain(..).partition(|case| case.technique.draws());
        self.cases = cases;
        for case in drawn {
            self.say(&format!("left out: {} draws triangles; --device software does", case.text))?;
        }
        Ok(())
    }

    /// Measures everything; returns how many cases failed.
    pub(crate) fn run(mut self) -> Result<usize, BenchError> {
        let line = self.environment.line();
        self.say(&line)?;
        for warning in self.environment.warnings() {
            self.say(&format!("warning: {warning}"))?;
        }
        let meshes = scenes::meshes_folder();
        for name in &scenes::listed(&self.arguments.scenes, &meshes)? {
            for &size in &self.arguments.sizes {
                if self.known.has(name, size, self.arguments, &self.cases) {
                    self.say(&format!("\n{name}, {} × {}: measured before", size[0], size[1]))?;
                    continue;
                }
                match scenes::find(name, size, &meshes) {
                    Ok(measured) => self.measure(&measured)?,
                    Err(missing @ BenchError::MissingMesh { .. }) => {
                        self.skipped += 1;
                        self.absent("skip", name, size, None, &missing)?;
                    }
                    Err(error) => return Err(error),
                }
            }
        }
        let (skipped, failed) = (self.skipped, self.failed);
        self.say(&format!("\n{skipped} scenes skipped, {failed} cases failed"))?;
        Ok(failed)
    }

    fn measure(&mut self, measured: &Measured) -> Result<(), BenchError> {
        let [width, height] = measured.camera.size();
        let (name, triangles) = (&measured.name, measured.scene.triangle_count());
        self.say(&format!("\n{name}, {width} × {height}, {triangles} triangles"))?;
        let technique = &self.arguments.reference;
        let subject = |measured: Measured| {
            let folder = self.arguments.reference_cache.as_deref();
            Ok::<_, BenchError>(Subject {
                reference: reference::make(&self.context, &measured, technique, folder)?,
                measured,
            })
        };
        let semi_opaque = self.cases.iter().any(|case| case.semi_opaque);
        let subjects = Subjects {
            opaque: subject(measured.clone())?,
            semi_opaque: semi_opaque.then(|| subject(measured.semi_opaque()?)).transpose()?,
        };
        let standard_error = subjects.opaque.reference.rms_standard_error;
        let standard_error = standard_error.map_or("unknown".into(), |e| format!("{e:.5}"));
        let samples = u64::from(technique.samples()) * u64::from(technique.passes());
        self.say(&format!("reference: {} with {samples} samples, standard error {standard_error}", technique.name()))?;
        let (measurements, failures) =
            take_turns(&self.context, &subjects, &self.cases, self.arguments.repeats, &|done, total| {
                self.progress.say(name, done, total);
            });
        self.progress.clear();
        let environment = self.environment.clone();
        let place = Place {
            scene: &measured.name,
            size: measured.camera.size(),
            reference: technique,
            reference_standard_error: subjects.opaque.reference.rms_standard_error,
            environment: &environment,
        };
        for measurement in &measurements {
            let reference_standard_error = subjects.of(&measurement.case).reference.rms_standard_error;
            self.record(&Row::of(Place { reference_standard_error, ..place }, measurement))?;
        }
        self.say(&format!("\n{}", report::summary(&measurements)))?;
        if let Some(warning) = report::noise(&measurements) {
            self.say(&format!("warning: {warning}"))?;
        }
        if let Some(chosen) = self.arguments.ratios {
            self.say_ratios(place, &ratios::of(&measurements, chosen)?)?;
        }
        self.say(&format!("{}\n{}", report::passes(&measurements), report::bytes(&measurements)))?;
        let mut failures = failures;
        if let Some(frames) = self.arguments.waving {
            let all = self.cases.iter().filter(|case| !failures.iter().any(|failure| failure.case.is(case)));
            let (waving, failed) = waving::measure(&self.context, &subjects, all, frames);
            for row in &waving {
                self.record(&WavingLine {
                    kind: "waving",
                    scene: name,
                    size: place.size,
                    waving: row,
                    environment: &environment,
                })?;
            }
            self.say(&waving::table(&waving).to_string())?;
            failures.extend(failed);
        }
        if let Some(frames) = self.arguments.sweep {
            let all = self.cases.iter().filter(|case| !case.semi_opaque);
            let all = all.filter(|case| !failures.iter().any(|failure| failure.case.is(case)));
            let (sweeps, failed) = sweep::measure(&self.context, measured, all, technique, frames)?;
            for row in &sweeps {
                let (size, environment) = (place.size, &environment);
                self.record(&SweepLine {
                    kind: "sweep",
                    scene: name,
                    size,
                    sweep: row,
                    reference: technique,
                    environment,
                })?;
            }
            self.say(&sweep::table(&sweeps).to_string())?;
            failures.extend(failed);
        }
        for Failure { case, error } in &failures {
            self.failed += 1;
            self.absent("failure", name, place.size, Some(&case.text), error)?;
        }
        Ok(())
    }

    fn say_ratios(&mut self, place: Place<'_>, ratios: &[MeasuredRatio]) -> Result<(), BenchError> {
        let Place { scene, size, environment, .. } = place;
        for ratio in ratios {
            self.record(&RatioLine { kind: "ratio", scene, size, ratio, environment })?;
        }
        self.say(&ratios::table(ratios).to_string())
    }

    /// Names what was not measured, and why.
    fn absent(
        &mut self,
        kind: &'static str,
        scene: &str,
        size: [u32; 2],
        case: Option<&str>,
        error: &BenchError,
    ) -> Result<(), BenchError> {
        let reason = error.to_string();
        let what = case.map_or_else(String::new, |case| format!(", {case}"));
        self.say(&format!("{kind}: {scene}{what}: {reason}"))?;
        self.record(&AbsentLine { kind, scene, size, case, reason })
    }

    fn say(&mut self, text: &str) -> Result<(), BenchError> {
        writeln!(self.out, "{text}").and_then(|()| self.out.flush()).map_err(|e| BenchError::file("output", e))
    }

    fn record(&mut self, line: &impl Serialize) -> Result<(), BenchError> {
        let Some(file) = &mut self.json else { return Ok(()) };
        let text = serde_json::to_string(line).map_err(|error| BenchError::file("a line of JSON", error))?;
        writeln!(file, "{text}").map_err(|error| BenchError::file("JSON lines", error))
    }
}
