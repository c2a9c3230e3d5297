//! `render`: the picture. Real direct light on the scene's materials, shadowed by a technique.

use softshadow_scene::{Camera, Light, Receivers, Scene};
use softshadow_techniques::{Shading, Technique};

use crate::Progress;
use crate::context::Context;
use crate::error::Error;
use crate::visibility::{Options, Visibility, run};

/// How a picture is made.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PictureOptions {
    /// How light and visibility are put together.
    pub shading: Shading,
    /// Brightness in stops: colours are multiplied by 2^exposure.
    pub exposure: f32,
    /// Linear colour where the camera sees nothing; not exposed.
    pub background: [f32; 3],
    /// As for visibility.
    pub options: Options,
}

/// A picture and the visibility behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// `[width, height]`.
    pub size: [u32; 2],
    /// Linear, exposed colour a pixel, row by row.
    pub linear: Vec<[f32; 3]>,
    /// The visibility of every light.
    pub visibility: Visibility,
}

/// Makes a picture.
///
/// # Errors
/// Any [`Error`].
pub fn render(
    context: &Context,
    scene: &Scene,
    lights: &[Light],
    camera: &Camera,
    technique: &Technique,
    options: &PictureOptions,
    on_progress: Progress<'_>,
) -> Result<Picture, Error> {
    let finite = options.exposure.is_finite() && options.background.iter().all(|c| c.is_finite());
    if !finite {
        return Err(Error::Settings("exposure and background must be finite".into()));
    }
    let receivers = Receivers::Camera(*camera);
    let shading = Some(options.shading);
    let (visibility, colors) = run(
        context.device([technique])?,
        scene,
        lights,
        &receivers,
        technique,
        &options.options,
        shading,
        on_progress,
    )?;
    let gain = options.exposure.exp2();
    let linear = (0..visibility.receivers)
        .map(|index| match (visibility.valid[index], colors.get(index)) {
            (true, Some(c)) => [c[0] * gain, c[1] * gain, c[2] * gain],
            _ => options.background,
        })
        .collect();
    Ok(Picture { size: camera.size(), linear, visibility })
}

impl Picture {
    /// Clipped and encoded as sRGB, three bytes a pixel.
    #[must_use]
    pub fn srgb8(&self) -> Vec<u8> {
        self.linear.iter().flatten().map(|c| (srgb_from_linear(*c) * 255.0).round() as u8).collect()
    }
}

/// The sRGB transfer function (IEC 61966-2-1) of a value that is clipped to 0…1 first.
fn srgb_from_linear(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}
