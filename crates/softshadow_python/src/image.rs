//! Images and drawings as the bytes of a PNG or OpenEXR file.

use std::borrow::Cow;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use softshadow::{drawing, image_file};

use crate::arrays::rows;
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

/// The place of each pixel's colour in a palette of sRGB bytes as an 8-bit PNG; `size` is `[width, height]`.
#[pyfunction]
pub(crate) fn png_palette8(
    py: Python<'_>,
    places: PyReadonlyArray1<'_, u8>,
    palette: PyReadonlyArray2<'_, u8>,
    size: [u32; 2],
) -> PyResult<Cow<'static, [u8]>> {
    let (places, palette) = (places.as_slice()?.to_vec(), rows(&palette)?);
    detached(py, || image_file::png_palette8_bytes(&places, &palette, size)).map(Cow::Owned)
}

/// An SVG, `scale` times as large as it says, as an 8-bit PNG.
#[pyfunction]
pub(crate) fn svg_png(py: Python<'_>, svg: &str, scale: f32) -> PyResult<Cow<'static, [u8]>> {
    detached(py, || drawing::svg_png_bytes(svg, scale)).map(Cow::Owned)
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
