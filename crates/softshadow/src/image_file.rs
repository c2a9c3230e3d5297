//! Images as PNG: visibility as 16-bit linear grey, pictures as 8-bit sRGB.

use std::path::Path;

use crate::error::Error;

/// Visibility in 0…1 as 16-bit linear grey; what is not a number becomes black.
///
/// # Errors
/// [`Error::File`] when the values do not fill the image.
pub fn png_grey16_bytes(values: &[f32], size: [u32; 2]) -> Result<Vec<u8>, Error> {
    let grey = |v: &f32| ((f64::from(v.clamp(0.0, 1.0)) * 65_535.0).round() as u16).to_be_bytes();
    let bytes: Vec<u8> = values.iter().flat_map(grey).collect();
    encode(&bytes, size, png::ColorType::Grayscale, png::BitDepth::Sixteen)
}

/// Three sRGB bytes a pixel.
///
/// # Errors
/// [`Error::File`] when the bytes do not fill the image.
pub fn png_srgb8_bytes(bytes: &[u8], size: [u32; 2]) -> Result<Vec<u8>, Error> {
    encode(bytes, size, png::ColorType::Rgb, png::BitDepth::Eight)
}

/// Writes [`png_grey16_bytes`] to a file.
///
/// # Errors
/// [`Error::File`].
pub fn png_grey16(path: &Path, values: &[f32], size: [u32; 2]) -> Result<(), Error> {
    write(path, &png_grey16_bytes(values, size)?)
}

/// Writes [`png_srgb8_bytes`] to a file.
///
/// # Errors
/// [`Error::File`].
pub fn png_srgb8(path: &Path, bytes: &[u8], size: [u32; 2]) -> Result<(), Error> {
    write(path, &png_srgb8_bytes(bytes, size)?)
}

fn encode(
    bytes: &[u8],
    [width, height]: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
) -> Result<Vec<u8>, Error> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    match color {
        png::ColorType::Rgb => encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric),
        // Gamma 1: viewers and readers know that grey is linear.
        _ => encoder.set_source_gamma(png::ScaledFloat::new(1.0)),
    }
    let failed = |error: png::EncodingError| Error::File(format!("PNG of {width} × {height}: {error}"));
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(bytes).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(file)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    std::fs::write(path, bytes).map_err(|error| Error::File(format!("{}: {error}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_survives_to_a_sixteenth_bit_and_sizes_are_checked() {
        let values = [0.0, 0.25, 1.0, f32::NAN, 0.5, 2.0];
        let bytes = png_grey16_bytes(&values, [3, 2]).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let read: Vec<u16> = pixels.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
        assert_eq!(read, [0, 16_384, 65_535, 0, 32_768, 65_535]);
        assert!(png_grey16_bytes(&values, [3, 3]).is_err());
    }
}
