//! Work outside the interpreter: other Python threads run, Ctrl-C is heard between blocks, and no panic gets through.

use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::prelude::*;
use softshadow::Error;

use crate::errors::{exception, internal_exception};

/// Runs `work` with the interpreter released.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T, Error> + Send) -> PyResult<T> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(result) => result.map_err(exception),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            Err(internal_exception(format!("internal error, please report it: {text}")))
        }
    }
}

/// As [`detached`], for work that reports its progress: between blocks signals are checked and `callback(done, total)` is called.
/// An exception of either ends the work and is raised here; `False` from the callback ends it with `Interrupted`.
pub(crate) fn detached_with_progress<T: Send>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(u64, u64) -> bool) -> Result<T, Error> + Send,
) -> PyResult<T> {
    let mut raised = None;
    let result = detached(py, || {
        work(&mut |done, total| {
            Python::attach(|py| ask(py, callback.as_ref(), done, total)).unwrap_or_else(|error| {
                raised = Some(error);
                false
            })
        })
    });
    raised.map_or(result, Err)
}

fn ask(py: Python<'_>, callback: Option<&Py<PyAny>>, done: u64, total: u64) -> PyResult<bool> {
    py.check_signals()?;
    let Some(callback) = callback else { return Ok(true) };
    let answer = callback.call1(py, (done, total))?;
    Ok(!matches!(answer.extract::<bool>(py), Ok(false)))
}
