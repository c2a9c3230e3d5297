//! The device and everything cached on it.

use pyo3::prelude::*;
use softshadow::DeviceChoice;

use crate::detached::detached;
use crate::errors::{exception, internal_exception};
use crate::technique::json;

/// A device of this process.
#[pyclass(frozen, module = "softshadow._core")]
pub(crate) struct Context {
    /// Empty only while it is dropped.
    inner: Option<softshadow::Context>,
    process: u32,
}

impl Context {
    pub(crate) fn get(&self) -> PyResult<&softshadow::Context> {
        match &self.inner {
            Some(inner) if self.process == std::process::id() => Ok(inner),
            _ => Err(internal_exception("a device does not survive a fork; make one in each process".into())),
        }
    }
}

#[pymethods]
impl Context {
    #[new]
    fn new(py: Python<'_>, device: &str) -> PyResult<Self> {
        let choice: DeviceChoice = device.parse().map_err(exception)?;
        let inner = detached(py, || softshadow::Context::new(&choice))?;
        Ok(Self { inner: Some(inner), process: std::process::id() })
    }

    /// Name, backend, device type and limits of the adapter, as JSON.
    #[getter]
    fn adapter(&self) -> PyResult<String> {
        json(self.get()?.adapter())
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // The driver's threads are not in a forked child: closing the device there would wait for them for ever.
        if self.process != std::process::id() {
            std::mem::forget(self.inner.take());
        }
    }
}

/// All adapters of the machine, as JSON.
#[pyfunction]
pub(crate) fn adapters(py: Python<'_>) -> PyResult<String> {
    json(&detached(py, || Ok(softshadow::adapters()))?)
}
