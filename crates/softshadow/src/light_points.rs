//! Light samples where the caller can read them, so that two renderers can be compared sample by sample.

use softshadow_scene::{
    Light, LightSamples, LightShape, LocalFrame, SamplePattern, Scene, occluder_bounds, sample_positions,
};

use crate::error::Error;

/// Samples of one light.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPoints {
    /// Where each sample lies on the light.
    pub parameters: Vec<[f32; 2]>,
    /// rows × samples: world positions, or directions towards a sun. NaN for a receiver inside a sphere light.
    pub positions: Vec<[f64; 3]>,
    /// One row a receiver for a sphere light, else one row in all.
    pub rows: usize,
    /// Positions are directions.
    pub at_infinity: bool,
}

/// The samples that `ray_traced` uses for a light with these settings, in float64 world coordinates of the float32 values.
///
/// # Errors
/// [`Error::Scene`] for a number of samples out of range.
pub fn light_points(
    scene: &Scene,
    light: &Light,
    pattern: SamplePattern,
    count: u32,
    seed: u32,
    receivers: &[[f64; 3]],
) -> Result<LightPoints, Error> {
    let frame = LocalFrame::around(occluder_bounds(scene));
    let samples = LightSamples::new(light, &frame, pattern, count, seed)?;
    let at_infinity = matches!(light.shape(), LightShape::Sun { .. });
    let turns = matches!(light.shape(), LightShape::Sphere { .. });
    let scale = frame.world_from_local_scale();
    let origin = glam::DVec3::from(frame.origin());
    let world = |p: glam::DVec3| if at_infinity { p } else { p * scale + origin };
    let seen_from: Vec<[f64; 3]> = if turns { receivers.to_vec() } else { vec![frame.origin()] };
    let mut positions = Vec::with_capacity(seen_from.len() * count as usize);
    for receiver in &seen_from {
        match sample_positions(light, &frame, &samples, frame.local_from_world(*receiver)) {
            Some(row) => positions.extend(row.into_iter().map(|(p, _)| world(p).to_array())),
            None => positions.extend(std::iter::repeat_n([f64::NAN; 3], count as usize)),
        }
    }
    Ok(LightPoints { parameters: samples.parameters, positions, rows: seen_from.len(), at_infinity })
}
