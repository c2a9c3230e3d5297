//! The settings of a call, as JSON: a `scene.json` with `technique`, `options`, `points` and `normals` beside what that has. What can
//! be read is computed natively, as long as that is little work.

use std::sync::OnceLock;
use std::time::Duration;

use serde_json::Value;
use softshadow::scene_file::parse_all;
use softshadow::{
    Camera, Context, DeviceChoice, Error, LightSampling, Options, PictureOptions, Points, RayTraced, Receivers,
    Shading, Technique, light_points, render, visibility,
};

use crate::files::{folder, words};
use crate::harness::Target;

pub(crate) const SETTINGS: Target = Target {
    name: "settings",
    words: WORDS,
    longest: 8 << 10,
    memory: 256 << 20,
    patience: Duration::from_secs(20),
    run: outcome,
};

const WORDS: &[&str] = &[
    "\"technique\":{\"name\":\"ray_traced\"},",
    "\"technique\":{\"name\":\"depth_complexity\"},",
    "\"technique\":{\"name\":\"hard_shadow_map\"},",
    "\"samples\":",
    "\"pattern\":\"low_discrepancy\",",
    "\"seed\":",
    "\"passes\":",
    "\"probes\":",
    "\"spread\":\"decorrelated\",",
    "\"spread\":\"interleaved\",",
    "\"tile\":",
    "\"resolution\":",
    "\"exact_area\":false,",
    "\"silhouettes\":\"standard\",",
    "\"coverage\":\"table\",",
    "\"attenuation\":\"sum\",",
    "\"evaluation\":\"blended\",",
    "\"initial_counts\":\"z_fail\",",
    "\"counters\":\"float\",",
    "\"base\":",
    "\"batches\":",
    "\"unit\":\"triangles\",",
    "\"unit\":\"edges\",",
    "\"memory_limit_bytes\":",
    "\"standard_error\":true,",
    "\"receivers\":true,",
    "\"sample_masks\":true,",
    "\"exposure\":",
    "\"shading\":\"modulated\",",
    "\"points\":[[0,0,0]],",
    "\"normals\":[[0,1,0]],",
    "\"type\":\"RectLight\",",
    "\"type\":\"DiskLight\",",
    "\"type\":\"SphereLight\",",
    "\"type\":\"DistantLight\",",
    "\"width\":",
    "\"radius\":",
    "\"angle\":",
    "\"target\":[0,0,0],",
    "\"translate\":[0,0.5,0],",
    "\"opacity\":0.5,",
    "\"eye\":[0,1,0],",
    "\"fov_y_deg\":",
    "\"size\":[3,5],",
    "null",
    "-",
    "0.",
    "e30",
    "e-30",
];

/// Receivers × samples × lights above this are too much work for one of many inputs.
const WORK: u64 = 1 << 16;

fn outcome(bytes: &[u8]) -> String {
    match call(bytes) {
        Ok(words) => words,
        Err(error) => words(&error),
    }
}

fn call(bytes: &[u8]) -> Result<String, Error> {
    static CONTEXT: OnceLock<Context> = OnceLock::new();
    let context = CONTEXT.get_or_init(|| Context::new(&DeviceChoice::Native).unwrap());
    let settings = |error: serde_json::Error| Error::Settings(error.to_string());
    let mut all: Value = serde_json::from_slice(bytes).map_err(settings)?;
    let mut take = |name: &str| all.as_object_mut().and_then(|fields| fields.remove(name)).unwrap_or_default();
    let [technique, options, points, normals] = ["technique", "options", "points", "normals"].map(&mut take);
    let technique: Technique = serde_json::from_value(technique).map_err(settings)?;
    technique.check()?;
    let file = parse_all(&folder().join("scene.json"), all.to_string().as_bytes())?;
    let lights: Vec<_> = file.lights.into_iter().map(|light| light.light).collect();
    let (pixels, camera) = match file.camera {
        Some(c) => (
            u64::from(c.size[0]) * u64::from(c.size[1]),
            Some(Camera::look_at(c.eye, c.target, c.up, c.fov_y_deg, c.size)?),
        ),
        None => (0, None),
    };
    let mut words = Vec::new();
    let work = u64::from(technique.samples()) * u64::from(technique.passes()) * (1 + lights.len() as u64);
    let flag = |name: &str| options.get(name).and_then(Value::as_bool).unwrap_or_default();
    let number = |name: &str| options.get(name).and_then(Value::as_f64);
    let options = Options {
        memory_limit_bytes: options.get("memory_limit_bytes").and_then(Value::as_u64).unwrap_or(1 << 24),
        standard_error: flag("standard_error"),
        receivers: flag("receivers"),
        sample_masks: flag("sample_masks"),
        ..Options::default()
    };
    if let Some(points) = rows(&points) {
        let receivers = Receivers::Points(Points::new(points.clone(), rows(&normals))?);
        if receivers.count().saturating_mul(work) <= WORK {
            let seen = visibility(context, &file.scene, &lights, &receivers, &technique, &options, &mut |_, _| true)?;
            words.push(shares(&seen.values, &seen.valid));
            if let (Technique::RayTraced(settings), Some(light)) = (&technique, lights.first()) {
                light_points(&file.scene, light, &sampling(settings), &points, 0)?;
            }
        }
    }
    if let Some(camera) = camera.filter(|_| pixels.saturating_mul(work) <= WORK) {
        let shading = if flag("modulated") { Shading::Modulated } else { Shading::Integrated };
        let exposure = number("exposure").unwrap_or_default() as f32;
        let picture = PictureOptions { shading, exposure, options, ..PictureOptions::default() };
        let picture = render(context, &file.scene, &lights, &camera, &technique, &picture, &mut |_, _| true)?;
        assert!(picture.linear.iter().flatten().all(|c| !c.is_nan()), "a colour is not a number");
        words.push(shares(&picture.visibility.values, &picture.visibility.valid));
    }
    Ok(format!("{}: {}", technique.name(), words.join(", ")))
}

fn sampling(settings: &RayTraced) -> LightSampling {
    let RayTraced { samples: count, pattern, seed, spread, tile, .. } = *settings;
    LightSampling { pattern, count, seed, spread, tile }
}

/// Rows of three numbers; anything else in a row is not a number.
fn rows(value: &Value) -> Option<Vec<[f64; 3]>> {
    let number = |row: &Value, k: usize| row.get(k).and_then(Value::as_f64).unwrap_or(f64::NAN);
    Some(value.as_array()?.iter().map(|row| [0, 1, 2].map(|k| number(row, k))).collect())
}

/// Which shares of the light there are, in words; each has to be one.
fn shares(values: &[f32], valid: &[bool]) -> String {
    let of = |receiver: usize| valid[receiver % valid.len()];
    for (index, value) in values.iter().enumerate() {
        assert!(value.is_nan() != of(index) && (value.is_nan() || (0.0..=1.0).contains(value)), "{value} is no share");
    }
    let has = |what: &str, is: &dyn Fn(f32) -> bool| {
        if values.iter().any(|v| is(*v)) { what.to_owned() } else { String::new() }
    };
    [
        has("dark", &|v| v == 0.0),
        has("half", &|v| v > 0.0 && v < 1.0),
        has("lit", &|v| v == 1.0),
        has("none", &|v| v.is_nan()),
    ]
    .concat()
}
