//! The private module `softshadow._core`: converts, detaches from the interpreter, maps errors, and nothing else.
//!
//! Kind messages about types, defaults and documentation are the business of `python/softshadow`; every function here
//! takes one exact type per argument. Settings and information cross as JSON, arrays as numpy arrays: they are copied on
//! the way in and moved on the way out.

mod arrays;
mod camera;
mod compare;
mod context;
mod detached;
mod errors;
mod foreign;
mod image;
mod light;
mod light_points;
mod scene;
mod scene_file;
mod shipped;
mod technique;
mod visibility;

#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::camera::{Camera, look_at};
    #[pymodule_export]
    use super::compare::compare;
    #[pymodule_export]
    use super::context::{Context, adapters};
    #[pymodule_export]
    use super::foreign::{ForeignCall, ForeignDevice, shader};
    #[pymodule_export]
    use super::image::{exr, png_grey16, png_palette8, png_srgb8, svg_png};
    #[pymodule_export]
    use super::light::Light;
    #[pymodule_export]
    use super::light_points::light_points;
    #[pymodule_export]
    use super::scene::{Scene, default_material};
    #[pymodule_export]
    use super::scene_file::load_scene_file;
    #[pymodule_export]
    use super::shipped::{shipped_names, shipped_scene};
    #[pymodule_export]
    use super::technique::{check_technique, technique_defaults};
    #[pymodule_export]
    use super::visibility::{cache_folder, render, visibility, visibility_within};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
