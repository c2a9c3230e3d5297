//! Every Rust error as the Python exception that says the same. The exceptions are defined in `softshadow/errors.py`,
//! because a class with two bases cannot be made here.

use pyo3::PyErr;
use softshadow::{Error, SceneError};

mod python {
    use pyo3::import_exception;

    import_exception!(softshadow.errors, BoundNotMet);
    import_exception!(softshadow.errors, GpuError);
    import_exception!(softshadow.errors, GpuOutOfMemory);
    import_exception!(softshadow.errors, Interrupted);
    import_exception!(softshadow.errors, MeasureError);
    import_exception!(softshadow.errors, NoAdapterError);
    import_exception!(softshadow.errors, OutputError);
    import_exception!(softshadow.errors, SceneError);
    import_exception!(softshadow.errors, SceneFileNotFound);
    import_exception!(softshadow.errors, SettingsError);
    import_exception!(softshadow.errors, SoftShadowError);
    import_exception!(softshadow.errors, TooLargeError);
}

/// The exception for an error of the library.
pub(crate) fn exception(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Scene(error) => scene_exception(&error),
        Error::Settings(_) => python::SettingsError::new_err(text),
        Error::Device(_) => python::NoAdapterError::new_err(text),
        Error::TooLarge { .. } => python::TooLargeError::new_err(text),
        Error::OutOfMemory(_) => python::GpuOutOfMemory::new_err(text),
        Error::Gpu(_) => python::GpuError::new_err(text),
        Error::Interrupted => python::Interrupted::new_err(text),
        Error::Measure(_) => python::MeasureError::new_err(text),
        Error::File(_) => python::OutputError::new_err(text),
        // Its best result has been taken out before.
        Error::BoundNotMet(_) => python::BoundNotMet::new_err(text),
        // The enum may grow; an error without a class of its own is still one of ours.
        _ => python::SoftShadowError::new_err(text),
    }
}

/// The exception for something wrong with a scene, light, camera or receivers.
pub(crate) fn scene_exception(error: &SceneError) -> PyErr {
    let text = error.to_string();
    match error {
        SceneError::FileUnreadable { path, .. } if !path.exists() => python::SceneFileNotFound::new_err(text),
        SceneError::TooLarge { .. } => python::TooLargeError::new_err(text),
        _ => python::SceneError::new_err(text),
    }
}

/// The exception for settings that the library refuses.
pub(crate) fn settings_exception(text: String) -> PyErr {
    python::SettingsError::new_err(text)
}

/// The exception for what only a mistake of this library can cause.
pub(crate) fn internal_exception(text: String) -> PyErr {
    python::SoftShadowError::new_err(text)
}
