//! What an earlier run has written: a run that was ended goes on where it stopped.

use std::fs::{self, File};
use std::path::Path;

use serde_json::Value;

use crate::Arguments;
use crate::case::Case;
use crate::error::BenchError;
use crate::report::Environment;

/// Lines of JSON about measurements of this device.
#[derive(Debug, Default)]
pub(crate) struct Known {
    lines: Vec<Value>,
}

impl Known {
    /// Whether every case of a scene in a size was measured against this reference, in as many turns.
    pub(crate) fn has(&self, scene: &str, size: [u32; 2], arguments: &Arguments, cases: &[Case]) -> bool {
        let reference = serde_json::to_value(&arguments.reference).unwrap_or_default();
        let is_here = |line: &&Value| {
            line["kind"] == "measurement"
                && line["scene"] == scene
                && line["size"] == serde_json::json!(size)
                && line["reference"] == reference
                && line["wall_ms"].as_array().is_some_and(|turns| turns.len() == arguments.repeats as usize)
        };
        let here: Vec<&Value> = self.lines.iter().filter(is_here).collect();
        !cases.is_empty() && cases.iter().all(|case| here.iter().any(|line| line["case"] == case.text.as_str()))
    }
}

/// Opens a file to add to it, and reads what it has of this device. A last line that was cut is taken away.
pub(crate) fn open(path: &Path, environment: &Environment) -> Result<(File, Known), BenchError> {
    let failed = |error: std::io::Error| BenchError::file(path.display().to_string(), error);
    let text = match fs::read_to_string(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        read => read.map_err(failed)?,
    };
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    let own = serde_json::to_value(environment).unwrap_or_default();
    let mut lines = Vec::new();
    for (number, line) in text[..whole].lines().enumerate() {
        let line: Value = serde_json::from_str(line)
            .map_err(|error| BenchError::file(format!("{}, line {}", path.display(), number + 1), error))?;
        if line["environment"] == own {
            lines.push(line);
        }
    }
    let file = File::options().append(true).create(true).open(path).map_err(failed)?;
    file.set_len(whole as u64).map_err(failed)?;
    Ok((file, Known { lines }))
}
