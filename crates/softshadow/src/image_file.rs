//! Images as PNG: visibility as 16-bit linear grey, pictures as 8-bit sRGB. And as OpenEXR: named channels of linear float32.

use std::collections::BTreeSet;
use std::io::Cursor;
use std::path::Path;

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};

use crate::error::Error;

/// One named channel of an image: a value a pixel, row by row.
pub type Channel = (String, Vec<f32>);

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

/// A palette of sRGB colours, and the place of each pixel's colour in it.
///
/// # Errors
/// [`Error::File`] when the places do not fill the image, for one beyond the palette, and for a palette of none or more than 256.
pub fn png_palette8_bytes(places: &[u8], palette: &[[u8; 3]], size: [u32; 2]) -> Result<Vec<u8>, Error> {
    let [width, height] = size;
    if !(1..=256).contains(&palette.len()) || places.iter().any(|place| usize::from(*place) >= palette.len()) {
        let colors = palette.len();
        let reason = format!("a palette of {colors} colours; every pixel needs one of 1 to 256");
        return Err(Error::File(format!("PNG of {width} × {height}: {reason}")));
    }
    encode_with(places, size, png::ColorType::Indexed, png::BitDepth::Eight, palette.as_flattened())
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

/// An OpenEXR file of linear float32 channels, compressed without loss. NaN stays NaN. `info` becomes its attribute `softshadow`.
///
/// # Errors
/// [`Error::File`] for an empty image, for a channel that does not fill it, and for names that are empty, longer than 255 bytes, not
/// printable ASCII or given twice.
pub fn exr_bytes(channels: Vec<Channel>, [width, height]: [u32; 2], info: &str) -> Result<Vec<u8>, Error> {
    let failed = |reason: String| Error::File(format!("EXR of {width} × {height}: {reason}"));
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || channels.is_empty() {
        return Err(failed("an image needs a pixel and a channel".into()));
    }
    let mut names = BTreeSet::new();
    for (name, values) in &channels {
        let is_printable = name.bytes().all(|byte| byte == b' ' || byte.is_ascii_graphic());
        if name.is_empty() || name.len() > 255 || !is_printable || !names.insert(name.as_str()) {
            return Err(failed(format!(
                "channel '{name:.40}': names are printable ASCII, up to 255 bytes, and differ"
            )));
        }
        if values.len() as u64 != pixels {
            return Err(failed(format!("channel '{name:.40}' has {} values", values.len())));
        }
    }
    let list = channels
        .into_iter()
        .map(|(name, values)| AnyChannel::new(Text::new_or_none(&name).unwrap_or_default(), FlatSamples::F32(values)));
    let mut attributes = LayerAttributes::default();
    let text = Text::new_or_none(info).ok_or_else(|| failed("info must be Latin-1".into()))?;
    attributes.other.insert(Text::from("softshadow"), AttributeValue::Text(text));
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(list.collect()));
    let mut file = Cursor::new(Vec::new());
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut file);
    written.map_err(|error| failed(error.to_string()))?;
    Ok(file.into_inner())
}

fn encode(bytes: &[u8], size: [u32; 2], color: png::ColorType, depth: png::BitDepth) -> Result<Vec<u8>, Error> {
    encode_with(bytes, size, color, depth, &[])
}

fn encode_with(
    bytes: &[u8],
    [width, height]: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
    palette: &[u8],
) -> Result<Vec<u8>, Error> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(palette);
    }
    match color {
        png::ColorType::Rgb | png::ColorType::Indexed => {
            encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
        }
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
    use exr::prelude::{ReadChannels, ReadLayers, read};

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

    #[test]
    fn a_palette_gives_every_pixel_its_colour() {
        let palette = [[1, 2, 3], [200, 0, 90]];
        let bytes = png_palette8_bytes(&[0, 1, 1, 0, 0, 1], &palette, [3, 2]).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels.as_chunks::<3>().0, [0, 1, 1, 0, 0, 1].map(|place: usize| palette[place]));
        for (places, colors, size) in
            [(&[0, 2][..], 2, [2, 1]), (&[0], 2, [2, 1]), (&[], 0, [1, 1]), (&[0], 257, [1, 1])]
        {
            assert!(png_palette8_bytes(places, &vec![[0; 3]; colors], size).is_err(), "{places:?} of {colors}");
        }
    }

    #[test]
    fn an_exr_holds_every_bit_of_every_channel_under_its_name() {
        // More rows than one compressed block of 16.
        let values: Vec<f32> = (0..3 * 40).map(|i| (i as f32 * 0.37).sin()).collect();
        let odd: Vec<f32> =
            values.iter().enumerate().map(|(i, v)| if i % 7 == 0 { f32::NAN } else { v * 1e-30 }).collect();
        let long = format!("visibility.{}", "x".repeat(200));
        let channels =
            vec![("visibility.key".into(), values.clone()), (long.clone(), odd.clone()), ("G".into(), values.clone())];
        let bytes = exr_bytes(channels, [3, 40], "{\"a\": 1}").unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let layer = image.layer_data;
        assert_eq!((layer.size.x(), layer.size.y()), (3, 40));
        assert_eq!(
            layer.attributes.other.get(&Text::from("softshadow")),
            Some(&AttributeValue::Text("{\"a\": 1}".into()))
        );
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let found = layer.channel_data.list.into_iter().map(|channel| match channel.sample_data {
            FlatSamples::F32(values) => (channel.name.to_string(), bits(&values)),
            other => panic!("float32 expected, got {other:?}"),
        });
        let found = found.collect::<Vec<_>>();
        assert_eq!(found, [("G".into(), bits(&values)), ("visibility.key".into(), bits(&values)), (long, bits(&odd))]);
    }

    #[test]
    fn what_an_exr_cannot_hold_is_refused_by_name() {
        let refused = |names: &[&str], count: usize, size| {
            let channels = names.iter().map(|name| ((*name).to_owned(), vec![0.5; count])).collect();
            exr_bytes(channels, size, "").unwrap_err().to_string()
        };
        assert!(refused(&["a"], 5, [3, 2]).contains("channel 'a' has 5 values"));
        assert!(refused(&["a"], 0, [0, 2]).contains("needs a pixel"));
        assert!(refused(&[], 6, [3, 2]).contains("and a channel"));
        for names in [&["a", "a"][..], &[""], &["caf\u{e9}"], &["a\0"], &[&"x".repeat(256)]] {
            assert!(refused(names, 6, [3, 2]).contains("names are printable ASCII"), "{names:?}");
        }
    }
}
