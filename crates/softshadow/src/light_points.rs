//! Light samples where the caller can read them, so that two renderers can be compared sample by sample.

use softshadow_scene::{
    Light, LightSamples, LightSampling, LightShape, LocalFrame, SampleSpread, Scene, occluder_bounds, sample_positions,
};

use crate::error::Error;

/// Samples of one light.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPoints {
    /// rows × samples: where each sample lies on the light. One row where receivers share their samples, else one a receiver.
    pub parameters: Vec<[f32; 2]>,
    /// rows × samples: world positions, or directions towards a sun. NaN for a receiver inside a sphere light.
    pub positions: Vec<[f64; 3]>,
    /// Rows of positions: one a receiver for a sphere light, and where receivers have samples of their own; else one in all.
    pub rows: usize,
    /// Positions are directions.
    pub at_infinity: bool,
}

/// The samples that sampled techniques use for a light with these settings, in float64 world coordinates of the float32 values.
///
/// `receivers` are those of a call, all of them in its order: their number decides who takes which set. `image_width` is that of the image
/// whose pixels they are; of points it is 0.
///
/// # Errors
/// [`Error::Scene`] for a number of samples out of range; [`Error::Settings`] for interleaved samples without an image.
pub fn light_points(
    scene: &Scene,
    light: &Light,
    sampling: &LightSampling,
    receivers: &[[f64; 3]],
    image_width: u32,
) -> Result<LightPoints, Error> {
    if sampling.spread == SampleSpread::Interleaved && image_width == 0 {
        return Err(Error::Settings("light_points spread: interleaved samples are those of an image's pixels".into()));
    }
    let frame = LocalFrame::around(occluder_bounds(scene));
    light.check_local(&frame)?;
    let samples = LightSamples::new(light, &frame, sampling)?;
    let at_infinity = matches!(light.shape(), LightShape::Sun { .. });
    let turns = matches!(light.shape(), LightShape::Sphere { .. });
    let shares = sampling.spread == SampleSpread::Correlated;
    let scale = frame.world_from_local_scale();
    let origin = glam::DVec3::from(frame.origin());
    let world = |p: glam::DVec3| if at_infinity { p } else { p * scale + origin };
    let count = sampling.count as usize;
    let own = |index: usize| {
        let first = sampling.set_of(index as u32, image_width) as usize * count;
        first..first + count
    };
    let seen_from: Vec<[f64; 3]> = if turns || !shares { receivers.to_vec() } else { vec![frame.origin()] };
    let mut positions = Vec::with_capacity(seen_from.len() * count);
    for (index, receiver) in seen_from.iter().enumerate() {
        match sample_positions(light, &frame, &samples.records[own(index)], frame.local_from_world(*receiver)) {
            Some(row) => positions.extend(row.into_iter().map(|(p, _)| world(p).to_array())),
            None => positions.extend(std::iter::repeat_n([f64::NAN; 3], count)),
        }
    }
    let parameters = match shares {
        true => samples.parameters,
        false => (0..seen_from.len()).flat_map(|index| samples.parameters[own(index)].to_vec()).collect(),
    };
    Ok(LightPoints { parameters, positions, rows: seen_from.len(), at_infinity })
}
