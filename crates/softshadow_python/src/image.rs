//! Images as the bytes of a PNG or OpenEXR file.

use std::borrow::Cow;

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use softshadow::image_file;

use crate::detached::detached;

/// Linear values in 0..=1 as a 16-bit grey PNG; `size` is `[width, height]`.
#[pyfunction]
pub(crate) fn png_grey16(
    py: Python<'_>,
    values: PyReadonlyArray1<'_, f32>,
    size: [u32; 2],
) -> PyResult<Cow<'static, [u8]>> {
    let values = values.as_slice()?.to_vec();
    detached(py, || image_file::png_grey16_bytes(&values, size)).map(Cow::Owned)
}

/// sRGB bytes, red, green, blue, as an 8-bit PNG; `size` is `[width, height]`.
#[pyfunction]
pub(crate) fn png_srgb8(
    py: Python<'_>,
    colors: PyReadonlyArray1<'_, u8>,
    size: [u32; 2],
) -> PyResult<Cow<'static, [u8]>> {
    let colors = colors.as_slice()?.to_vec();
    detached(py, || image_file::png_srgb8_bytes(&colors, size)).map(Cow::Owned)
}

/// Named channels of linear float32, a value a pixel, as an OpenEXR file; `size` is `[width, height]`.
#[pyfunction]
pub(crate) fn exr(
    py: Python<'_>,
    channels: Vec<(String, PyReadonlyArray1<'_, f32>)>,
    size: [u32; 2],
    info: &str,
) -> PyResult<Cow<'static, [u8]>> {
    let copies = channels.into_iter().map(|(name, values)| Ok((name, values.as_slice()?.to_vec())));
    let copies = copies.collect::<PyResult<Vec<_>>>()?;
    detached(py, || image_file::exr_bytes(copies, size, info)).map(Cow::Owned)
}
