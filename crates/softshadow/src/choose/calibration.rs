//! What a device needs for each kernel, measured once and kept: in the process, and in a file of the user's cache folder.
//!
//! Every setting of one pass that can be chosen computes a shipped scene in two sizes. A kernel's time is taken for `fixed + per unit ×
//! units`, with the units of [`softshadow_plan::PassWork`]; what no pass explains grows with the receivers. A scene differs from the
//! calibration's by a factor a kernel, which pilots and runs find.
//!
//! **Where.** `$SOFTSHADOW_CACHE`, else `$XDG_CACHE_HOME/softshadow` or `~/.cache/softshadow`, on macOS `~/Library/Caches/softshadow`, on
//! Windows `%LOCALAPPDATA%\softshadow`; a file for each device, driver, number of threads and version of the library. With
//! `SOFTSHADOW_CACHE=off` nothing is kept. A file that cannot be read, or is another device's, is made anew and replaced, and one that cannot
//! be written is left out; both are logged, and every result says which costs it was chosen by.

use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use softshadow_plan::{AdapterInfo, PassWork, Timing};
use softshadow_scene::{Camera, Light, LightShape, Receivers, Scene, look_at, procedural};
use softshadow_techniques::Technique;

use crate::context::Device;
use crate::error::Error;
use crate::info::Info;
use crate::visibility::{Options, run, work};

/// What a kernel takes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Line {
    fixed_ms: f64,
    ms_per_unit: f64,
}

impl Line {
    fn through([small, large]: [(f64, f64); 2]) -> Self {
        let ms_per_unit = ((large.1 - small.1) / (large.0 - small.0).max(1.0)).max(0.0);
        // Where it does not grow, the larger is the safer guess.
        let fixed_ms =
            if ms_per_unit > 0.0 { (small.1 - ms_per_unit * small.0).max(0.0) } else { small.1.max(large.1) };
        Self { fixed_ms, ms_per_unit }
    }

    fn ms(self, units: f64) -> f64 {
        self.fixed_ms + self.ms_per_unit * units
    }
}

/// What a setting takes, by kernel, and [`REST`].
type Lines = BTreeMap<String, Line>;

/// How much more or less a scene takes, by kernel, and [`REST`].
pub(crate) type Factors = BTreeMap<String, f64>;

/// What no pass explains: planning, uploads, and results that are read back. Its units are receivers.
const REST: &str = "rest";

/// Costs of a device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Calibration {
    key: Key,
    settings: Vec<(Technique, Lines)>,
}

/// What costs hold for.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
struct Key {
    version: String,
    adapter: String,
    backend: String,
    driver: String,
    threads: usize,
}

impl Key {
    fn of(adapter: &AdapterInfo) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            adapter: adapter.name.clone(),
            backend: adapter.backend.clone(),
            driver: adapter.driver.clone(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }

    fn file_name(&self) -> String {
        let mut hasher = DefaultHasher::new();
        self.hash(&mut hasher);
        format!("calibration-{:016x}.json", hasher.finish())
    }
}

/// Where calibrations are kept; `None` where nothing is kept.
#[must_use]
pub fn cache_folder() -> Option<PathBuf> {
    let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if let Some(given) = variable("SOFTSHADOW_CACHE") {
        return (given.as_os_str() != "off").then_some(given);
    }
    let home = || variable("HOME");
    let base = match std::env::consts::OS {
        "windows" => variable("LOCALAPPDATA"),
        "macos" => home().map(|home| home.join("Library/Caches")),
        _ => variable("XDG_CACHE_HOME").or_else(|| home().map(|home| home.join(".cache"))),
    };
    base.map(|base| base.join("softshadow"))
}

/// The shipped scene by which devices are calibrated, and the width of its two images.
const SCENE: &str = "fork";
const SIZES: [[u32; 2]; 2] = [[48, 36], [144, 108]];

impl Calibration {
    /// Reads what is kept, or measures and keeps it; with words about where it comes from.
    pub(crate) fn load_or_make(device: &Device) -> Result<(Self, String), Error> {
        let key = Key::of(device.adapter());
        let path = cache_folder().map(|folder| folder.join(key.file_name()));
        let kept = path.as_ref().and_then(|path| match fs::read(path) {
            Ok(bytes) => Some(Self::read(&bytes, &key).map_err(|reason| (path.clone(), reason))),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => Some(Err((path.clone(), error.to_string()))),
        });
        let spoilt = match kept {
            Some(Ok(kept)) => return Ok((kept, "kept from an earlier process".into())),
            Some(Err((path, reason))) => {
                log::warn!("{}: {reason}; calibrating '{}' anew", path.display(), key.adapter);
                Some(reason)
            }
            None => None,
        };
        let made = Self::make(device, key)?;
        let mut words = spoilt.map_or("made".to_owned(), |reason| format!("made anew ({reason})"));
        let written = path.map(|path| made.write(&path).map_err(|error| (path, error)));
        match written {
            None => words += ", and not kept",
            Some(Ok(())) => words += ", and kept",
            Some(Err((path, error))) => {
                log::warn!("{}: {error}; the calibration is not kept", path.display());
                words += &format!(", and not kept ({error})");
            }
        }
        Ok((made, words))
    }

    fn read(bytes: &[u8], key: &Key) -> Result<Self, String> {
        let found: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        let lines = found.settings.iter().flat_map(|(_, lines)| lines.values());
        let is_sound = |line: &Line| [line.fixed_ms, line.ms_per_unit].iter().all(|x| x.is_finite() && *x >= 0.0);
        match () {
            () if found.key != *key => Err("it is of another device or version".into()),
            () if found.settings.is_empty() || !lines.clone().all(is_sound) => Err("it holds no costs".into()),
            () => Ok(found),
        }
    }

    /// By another name first, so that nobody ever reads half of it.
    fn write(&self, path: &std::path::Path) -> std::io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let beside = path.with_extension(format!("{}.tmp", std::process::id()));
        fs::write(&beside, serde_json::to_vec_pretty(self)?)?;
        fs::rename(&beside, path)
    }

    fn make(device: &Device, key: Key) -> Result<Self, Error> {
        let described = procedural::shipped(SCENE)?;
        let scene = described.build()?;
        let (l, c) = (described.light(), described.camera());
        // Any light serves whose shadow is in the picture: this one is as large as the scene's own.
        let pose = look_at(l.position, l.target, Some(l.up))?;
        let side = match l.shape {
            procedural::LightShape::Rectangle { width, .. } => width,
            procedural::LightShape::Disc { radius } | procedural::LightShape::Sphere { radius } => radius,
            procedural::LightShape::Sun { .. } => 1.0,
        };
        let light = Light::new(LightShape::Rectangle { width: side, height: side }, pose)?;
        let views = SIZES.map(|size| Camera::look_at(c.eye, c.target, Some(c.up), c.fov_y_deg, size));
        let [small, large] = views;
        let views = [Receivers::Camera(small?), Receivers::Camera(large?)];
        let mut settings = Vec::new();
        for technique in Technique::defaults().iter().flat_map(Technique::rising_quality) {
            // Passes are alike, and what lies between costs about what its neighbours do.
            if technique.passes() > 1 || !technique.samples().is_power_of_two() {
                continue;
            }
            match Self::measure(device, &scene, &light, &views, &technique) {
                Ok(lines) => settings.push((technique, lines)),
                // What this device cannot do is no candidate either.
                Err(Error::Settings(_)) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(Self { key, settings })
    }

    fn measure(
        device: &Device,
        scene: &Scene,
        light: &Light,
        views: &[Receivers; 2],
        technique: &Technique,
    ) -> Result<Lines, Error> {
        let lights = std::slice::from_ref(light);
        let mut points: [BTreeMap<String, (f64, f64)>; 2] = Default::default();
        for (view, points) in views.iter().zip(&mut points) {
            let (work, stages) = work(device, scene, lights, view, technique)?;
            // The first run makes pipelines and buffers. Of the others, what was faster was disturbed less.
            for turn in 0..4 {
                let options = Options { timing: Timing::EachPass, ..Options::default() };
                let info = run(device, scene, lights, view, technique, &options, None, &mut |_, _| true)?.0.info;
                for (kernel, (units, ms)) in by_kernel(&work, stages, view, &info) {
                    let known = points.entry(kernel).or_insert((units, f64::INFINITY));
                    known.1 = if turn == 0 { f64::INFINITY } else { known.1.min(ms) };
                }
            }
        }
        let [small, large] = points;
        let line = |(kernel, at_large): (String, (f64, f64))| {
            let at_small = small.get(&kernel).copied().unwrap_or_default();
            (kernel, Line::through([at_small, at_large]))
        };
        Ok(large.into_iter().map(line).collect())
    }

    /// The lines of a setting: its own, or those of the setting of its technique with about as many samples.
    fn lines(&self, technique: &Technique) -> Option<&Lines> {
        let own = || self.settings.iter().filter(|(known, _)| known.name() == technique.name());
        let same = own().find(|(known, _)| known == technique);
        let away = |known: &Technique| (f64::from(known.samples()) / f64::from(technique.samples())).ln().abs();
        same.or_else(|| own().min_by(|a, b| away(&a.0).total_cmp(&away(&b.0)))).map(|(_, lines)| lines)
    }

    /// What a call should take.
    pub(crate) fn ms(
        &self,
        technique: &Technique,
        work: &[PassWork],
        stages: usize,
        receivers: &Receivers,
        factors: &Factors,
    ) -> f64 {
        let Some(lines) = self.lines(technique) else { return f64::INFINITY };
        let ms = |kernel: &str, units: f64| line(lines, kernel).ms(units) * factors.get(kernel).copied().unwrap_or(1.0);
        let mut units: BTreeMap<&str, f64> = BTreeMap::new();
        work.iter().for_each(|pass| *units.entry(&pass.kernel).or_default() += pass.units);
        let passes: f64 = units.into_iter().map(|(kernel, units)| ms(kernel, units)).sum();
        passes * stages as f64 + ms(REST, receivers.count() as f64)
    }

    /// How much more or less than calibrated a run took, kernel by kernel.
    pub(crate) fn factors(
        &self,
        technique: &Technique,
        work: &[PassWork],
        stages: usize,
        receivers: &Receivers,
        info: &Info,
    ) -> Factors {
        let Some(lines) = self.lines(technique) else { return Factors::new() };
        let has_passes = !info.pass_ms.is_empty();
        let took = by_kernel(work, stages, receivers, info);
        let whole = self.ms(technique, work, stages, receivers, &Factors::new()).max(f64::MIN_POSITIVE);
        let common = info.wall_ms / whole;
        // What takes next to nothing says next to nothing, and may be a large part of a larger call.
        let doubt = DOUBT * whole / stages.max(1) as f64;
        let of = |(kernel, (units, ms)): (&String, &(f64, f64))| {
            let expected = line(lines, kernel).ms(*units);
            let factor = if has_passes { (ms + doubt * common) / (expected + doubt) } else { common };
            (kernel.clone(), factor.clamp(1e-3, 1e3))
        };
        took.iter().map(of).collect()
    }
}

/// Share of a run's time by which a kernel's own may be off: one that takes much less has the factor of the whole run.
const DOUBT: f64 = 0.05;

/// What a kernel takes. One that the calibration's scene has no use for is taken for the slowest of its technique.
fn line(lines: &Lines, kernel: &str) -> Line {
    let slowest = || lines.values().copied().max_by(|a, b| a.ms_per_unit.total_cmp(&b.ms_per_unit));
    lines.get(kernel).copied().or_else(slowest).unwrap_or_default()
}

/// Units and milliseconds of one stage, by kernel, and of what no pass explains.
fn by_kernel(work: &[PassWork], stages: usize, receivers: &Receivers, info: &Info) -> BTreeMap<String, (f64, f64)> {
    let mut found: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    for pass in work {
        let time = info.pass_ms.iter().find(|time| time.label == pass.label).map_or(0.0, |time| time.ms);
        let entry = found.entry(pass.kernel.clone()).or_default();
        entry.0 += pass.units;
        entry.1 += time / stages.max(1) as f64;
    }
    let passes: f64 = info.pass_ms.iter().map(|time| time.ms).sum();
    found.insert(REST.into(), (receivers.count() as f64, (info.wall_ms - passes).max(0.0)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> Key {
        let words = ["1", "a", "native", "d"].map(str::to_owned);
        let [version, adapter, backend, driver] = words;
        Key { version, adapter, backend, driver, threads: 2 }
    }

    fn calibration() -> Calibration {
        let technique = Technique::defaults().remove(0);
        let line = Line { fixed_ms: 1.0, ms_per_unit: 0.5 };
        let lines = [("k".to_owned(), line), (REST.to_owned(), Line::default())].into_iter().collect();
        Calibration { key: key(), settings: vec![(technique, lines)] }
    }

    #[test]
    fn a_line_goes_through_both_points_and_never_falls() {
        let line = Line::through([(10.0, 6.0), (30.0, 16.0)]);
        assert_eq!(line, Line { fixed_ms: 1.0, ms_per_unit: 0.5 });
        assert_eq!(Line::through([(10.0, 6.0), (30.0, 4.0)]), Line { fixed_ms: 6.0, ms_per_unit: 0.0 });
        assert_eq!(Line::through([(5.0, 6.0), (5.0, 6.0)]), Line { fixed_ms: 6.0, ms_per_unit: 0.0 });
    }

    #[test]
    fn costs_follow_from_plans_and_a_scenes_factors() {
        let (calibration, technique) = (calibration(), Technique::defaults().remove(0));
        let one = Camera::look_at([1.0; 3], [0.0; 3], None, 40.0, [1, 1]).unwrap();
        let receivers = Receivers::Camera(one);
        let work = |units: f64| vec![PassWork { label: "p".into(), kernel: "k".into(), units }];
        let ms =
            |units, stages, factors: &Factors| calibration.ms(&technique, &work(units), stages, &receivers, factors);
        let plain = Factors::new();
        assert_eq!((ms(4.0, 1, &plain), ms(8.0, 1, &plain), ms(4.0, 3, &plain)), (3.0, 5.0, 9.0));
        assert_eq!(ms(4.0, 1, &[("k".to_owned(), 2.0)].into_iter().collect()), 6.0);
    }

    #[test]
    fn what_is_kept_comes_back_and_nothing_else_does() {
        let bytes = serde_json::to_vec(&calibration()).unwrap();
        assert_eq!(Calibration::read(&bytes, &key()), Ok(calibration()));
        let other = Key { driver: "newer".into(), ..key() };
        assert!(Calibration::read(&bytes, &other).unwrap_err().contains("another device"));
        assert!(Calibration::read(&bytes[..bytes.len() / 2], &key()).is_err());
        let empty = Calibration { settings: vec![], ..calibration() };
        assert!(Calibration::read(&serde_json::to_vec(&empty).unwrap(), &key()).unwrap_err().contains("no costs"));
    }
}
