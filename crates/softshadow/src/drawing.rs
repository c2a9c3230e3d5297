//! Drawings as PNG: SVG goes in, with one font that comes along, so that every machine draws the same.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{ImageHrefResolver, Options, Tree};

use crate::error::Error;
use crate::image_file::png_srgb8_bytes;

/// Latin and Greek letters and the signs of figures.
const FONT: &[u8] = include_bytes!("../fonts/NotoSans-Latin.ttf");
/// Its family, for every text whatever family it asks for.
const FAMILY: &str = "Noto Sans";
/// A pixel more would be no figure any more; the largest takes 256 MiB.
const LARGEST_SIDE: u32 = 8192;

/// Draws an SVG of `width` × `height` in its own units, `scale` times as large, on white. Pictures within it are left out.
///
/// # Errors
/// [`Error::File`] for text that is no SVG, and for a drawing without a pixel or more than 8,192 a side.
pub fn svg_png_bytes(svg: &str, scale: f32) -> Result<Vec<u8>, Error> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = Database::new();
        fonts.load_font_data(FONT.to_vec());
        fonts.set_sans_serif_family(FAMILY);
        // The last that is tried for a family that is not there.
        fonts.set_serif_family(FAMILY);
        Arc::new(fonts)
    });
    let options = Options {
        font_family: FAMILY.into(),
        fontdb: Arc::clone(fonts),
        // Nothing is read from the disk.
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Options::default()
    };
    let failed = |reason: String| Error::File(format!("drawing: {reason}"));
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(error.to_string()))?;
    let side = |length: f32| f64::from(length * scale).round();
    let [width, height] = [tree.size().width(), tree.size().height()].map(side);
    if ![width, height].iter().all(|side| (1.0..=f64::from(LARGEST_SIDE)).contains(side)) {
        return Err(failed(format!("{width} × {height} pixels; between 1 and {LARGEST_SIDE} a side are possible")));
    }
    let size = [width as u32, height as u32];
    let mut pixels = Pixmap::new(size[0], size[1]).ok_or_else(|| failed("too large".into()))?;
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let bytes: Vec<u8> = pixels.data().chunks_exact(4).flat_map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect();
    png_srgb8_bytes(&bytes, size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(svg: &str, scale: f32) -> ([u32; 2], usize) {
        let bytes = svg_png_bytes(svg, scale).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        ([frame.width, frame.height], pixels.chunks_exact(3).filter(|rgb| rgb[0] < 128).count())
    }

    fn svg(body: &str) -> String {
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='60' height='40'>{body}</svg>")
    }

    #[test]
    fn shapes_and_letters_are_drawn_at_any_scale() {
        assert_eq!(dark_pixels(&svg("<rect x='10' y='10' width='20' height='5'/>"), 2.0), ([120, 80], 400));
        assert_eq!(dark_pixels(&svg(""), 1.0), ([60, 40], 0));
        // Whatever family a text asks for, and signs that figures need.
        for text in ["front", "1 ≤ 2 × 3 µs − α", "10⁻³"] {
            let drawn = dark_pixels(&svg(&format!("<text x='2' y='20' font-family='Nobody'>{text}</text>")), 2.0).1;
            assert!(drawn > 100, "{text}: {drawn}");
        }
    }

    #[test]
    fn classes_take_their_colours_from_a_style() {
        let styled = "<style>.a { fill: none } .b .c { fill: #fff }</style>\
            <rect class='a' width='9' height='9'/><g class='b'><rect class='c' width='9' height='9'/></g>";
        assert_eq!(dark_pixels(&svg(styled), 1.0).1, 0);
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        for wrong in ["", "no picture", "<html/>", "<svg xmlns='http://www.w3.org/2000/svg' width='60'"] {
            assert!(matches!(svg_png_bytes(wrong, 1.0), Err(Error::File(_))), "{wrong}");
        }
        for scale in [0.0, -1.0, 1e9, f32::NAN] {
            let error = svg_png_bytes(&svg(""), scale).unwrap_err().to_string();
            assert!(error.contains("between 1 and 8192"), "{error}");
        }
        // A file of this machine is not drawn, however it is asked for.
        let path = std::env::temp_dir().join(format!("softshadow-drawing-{}.svg", std::process::id()));
        let dark = svg("<rect width='60' height='40'/>");
        std::fs::write(&path, &dark).unwrap();
        let own = svg(&format!("<image href='{}' width='60' height='40'/>", path.display()));
        let drawn = dark_pixels(&own, 1.0).1;
        std::fs::remove_file(&path).unwrap();
        assert_eq!((dark_pixels(&dark, 1.0).1, drawn), (2400, 0));
    }
}
