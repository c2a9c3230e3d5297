//! Techniques and their settings cross as JSON; ranges and defaults are the library's.

use pyo3::prelude::*;
use serde::Serialize;
use softshadow::Technique;

use crate::errors::{internal_exception, settings_exception};

pub(crate) fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| internal_exception(error.to_string()))
}

pub(crate) fn parse_technique(text: &str) -> PyResult<Technique> {
    let technique: Technique = serde_json::from_str(text).map_err(|error| settings_exception(error.to_string()))?;
    technique.check().map_err(|error| settings_exception(error.to_string()))?;
    Ok(technique)
}

/// Every technique with its default settings, as JSON.
#[pyfunction]
pub(crate) fn technique_defaults() -> PyResult<String> {
    json(&Technique::defaults())
}

/// Raises where a technique's settings are out of range.
#[pyfunction]
pub(crate) fn check_technique(technique: &str) -> PyResult<()> {
    parse_technique(technique).map(drop)
}
