//! Calls for a device that the caller owns: stage by stage a description as JSON, and bytes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};
use softshadow::plan::{
    AdapterInfo, Content, ContentKey, Delivery, DeviceKind, DeviceProgram as _, EngineError, Exported, Features, Host,
    Limits, RunReport, StageReport, shader_text,
};
use softshadow::{Error, Options};

use crate::camera::Camera;
use crate::detached::detached;
use crate::errors::{exception, internal_exception};
use crate::light::Light;
use crate::scene::Scene;
use crate::technique::{json, parse_technique};
use crate::visibility::{lights_of, receivers_of};

/// What the caller says of the device.
#[derive(Deserialize)]
struct Described {
    name: String,
    backend: String,
    is_software: bool,
    driver: String,
    features: Vec<String>,
    storage_binding_bytes: u64,
    buffer_bytes: u64,
    texture_size: u32,
    texture_layers: u32,
    groups: u32,
    storage_buffers: u32,
    color_targets: u32,
    color_bytes: u32,
}

/// Optional abilities that the library knows.
const FEATURES: [&str; 1] = ["float32-blendable"];

/// What is kept for somebody else's device.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct ForeignDevice(softshadow::ForeignDevice);

#[pymethods]
impl ForeignDevice {
    #[new]
    fn new(described: &str) -> PyResult<Self> {
        let it: Described = serde_json::from_str(described).map_err(|error| internal_exception(error.to_string()))?;
        let has = |feature: &str| it.features.iter().any(|name| name == feature);
        let host = Host {
            limits: Limits {
                storage_binding_bytes: it.storage_binding_bytes,
                buffer_bytes: it.buffer_bytes,
                texture_size: it.texture_size,
                texture_layers: it.texture_layers,
                groups: it.groups,
                storage_buffers: it.storage_buffers,
                color_targets: it.color_targets,
                color_bytes: it.color_bytes,
            },
            features: Features {
                raster: true,
                float32_blendable: has(FEATURES[0]),
                float32_drawable: it.backend != "gl",
            },
        };
        let adapter = AdapterInfo {
            index: 0,
            features: FEATURES.into_iter().filter(|name| has(name)).collect(),
            name: it.name,
            backend: it.backend,
            device_type: if it.is_software { DeviceKind::Software } else { DeviceKind::Gpu },
            driver: it.driver,
            storage_binding_bytes: it.storage_binding_bytes,
            texture_size: it.texture_size,
        };
        Ok(Self(softshadow::ForeignDevice::new(adapter, host)))
    }

    #[pyo3(signature = (scene, lights, *, camera, points, normals, technique, memory_limit, standard_error))]
    #[expect(clippy::too_many_arguments, reason = "the keyword arguments of the Python function")]
    fn visibility(
        &self,
        py: Python<'_>,
        scene: &Bound<'_, Scene>,
        lights: Vec<Py<Light>>,
        camera: Option<Bound<'_, Camera>>,
        points: Option<PyReadonlyArray2<'_, f64>>,
        normals: Option<PyReadonlyArray2<'_, f64>>,
        technique: &str,
        memory_limit: Option<u64>,
        standard_error: bool,
    ) -> PyResult<ForeignCall> {
        let (scene, lights, technique) = (&scene.get().0, lights_of(&lights), parse_technique(technique)?);
        let receivers = receivers_of(camera.as_ref(), points.as_ref(), normals.as_ref())?;
        let memory_limit_bytes = memory_limit.unwrap_or(Options::default().memory_limit_bytes);
        let options = Options { memory_limit_bytes, standard_error, ..Options::default() };
        let call = detached(py, || self.0.visibility(scene, &lights, receivers, &technique, &options))?;
        Ok(ForeignCall { uploads: call.uploads(), call, bytes: Mutex::default() })
    }
}

/// A prepared call.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct ForeignCall {
    call: softshadow::ForeignCall,
    uploads: BTreeMap<ContentKey, Content>,
    /// Bytes by resource of the largest stage so far.
    bytes: Mutex<Vec<(String, u64)>>,
}

#[derive(IntoPyObject)]
pub(crate) struct ForeignStage<'py> {
    /// An [`Described stage`](StageDescription) as JSON.
    description: String,
    /// Parameters by label.
    values: BTreeMap<String, Bound<'py, PyBytes>>,
}

#[derive(Serialize)]
struct StageDescription<'a> {
    #[serde(flatten)]
    exported: Exported<'a>,
    deliveries: Vec<Delivery>,
}

#[pymethods]
impl ForeignCall {
    /// Name and bytes of each result.
    #[getter]
    fn results(&self) -> Vec<(&'static str, u64)> {
        self.call.results()
    }

    #[getter]
    fn channels(&self) -> usize {
        self.call.channels()
    }

    #[getter]
    fn stages(&self) -> usize {
        self.call.stages()
    }

    /// Keys of uploads that will not be used again.
    #[getter]
    fn superseded(&self) -> Vec<u64> {
        self.call.superseded().iter().map(|key| key.0).collect()
    }

    /// The bytes to upload under a key.
    fn upload<'py>(&self, py: Python<'py>, key: u64) -> PyResult<Bound<'py, PyBytes>> {
        let content = self.uploads.get(&ContentKey(key));
        let content = content.ok_or_else(|| internal_exception(format!("no upload has the key {key}")))?;
        Ok(PyBytes::new(py, &content.bytes))
    }

    /// The stage with this number, checked against the device; `decision` is what the last one left in its decision buffer.
    fn stage<'py>(&self, py: Python<'py>, index: usize, decision: &[u8]) -> PyResult<Option<ForeignStage<'py>>> {
        let decision: Vec<u32> = decision.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let made = detached(py, || {
            let Some((stage, deliveries)) = self.call.step_on_device(index, &decision) else { return Ok(None) };
            let exported = Exported::new(&stage.plan, self.call.host()).map_err(EngineError::from)?;
            let described = serde_json::to_string(&StageDescription { exported, deliveries });
            Ok(Some((described, stage)))
        })?;
        let Some((described, stage)) = made else { return Ok(None) };
        let mut bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner);
        let memory = stage.plan.memory();
        if memory.iter().map(|(_, n)| n).sum::<u64>() > bytes.iter().map(|(_, n)| n).sum() {
            *bytes = memory.into_iter().map(|(label, n)| (label.to_owned(), n)).collect();
        }
        Ok(Some(ForeignStage {
            description: described.map_err(|error| internal_exception(error.to_string()))?,
            values: stage.values.iter().map(|(label, value)| (label.clone(), PyBytes::new(py, value))).collect(),
        }))
    }

    /// What made the results, as JSON; raises where receivers were left unfinished. `outputs` are those of each stage by label.
    fn finish(
        &self,
        py: Python<'_>,
        outputs: Vec<BTreeMap<String, Vec<u8>>>,
        wall_ms: f64,
        submissions: usize,
    ) -> PyResult<String> {
        let own = |(label, bytes): (String, Vec<u8>)| (label, Cow::Owned(bytes));
        let report = |(index, outputs): (usize, BTreeMap<String, Vec<u8>>)| StageReport {
            index,
            outputs: outputs.into_iter().map(own).collect(),
        };
        let stages: Vec<StageReport<'_>> = outputs.into_iter().enumerate().map(report).collect();
        let bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let run = RunReport { wall_ms, submissions, bytes, stages: stages.len(), ..RunReport::default() };
        json(&detached(py, || self.call.finish(&stages, run))?)
    }
}

/// The WGSL of a kernel's file, with everything that it imports.
#[pyfunction]
pub(crate) fn shader(file: &str) -> PyResult<&'static str> {
    shader_text(file).map_err(|error| exception(Error::Gpu(error.to_string())))
}
