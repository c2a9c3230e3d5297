//! How techniques end that give one value a receiver: a picture, where one is wanted, and what leaves. The light in the picture is the
//! unshadowed light times that value, over samples that no shadow asks for.

use softshadow_plan::{Plan, ResourceId, Values};
use softshadow_scene::{Light, LightSampling, SamplePattern, SceneError};

use crate::parts::light_buffers::{self, LightBuffers, Sampling};
use crate::parts::receivers;
use crate::parts::shading::{self, Seen};
use crate::request::Request;

/// Light samples of the unshadowed light in a picture.
const SAMPLES: u32 = 64;

fn sampling() -> LightSampling {
    LightSampling::correlated(SamplePattern::Stratified, SAMPLES, 0)
}

/// Adds the picture where it is wanted, and lets values and receivers leave.
pub(crate) fn append(
    plan: &mut Plan,
    request: &Request<'_>,
    receivers: ResourceId,
    light: ResourceId,
    visibility: ResourceId,
) {
    if request.wants.picture.is_some() {
        let record = plan.parameter("sampling", size_of::<Sampling>() as u64);
        let samples = plan.parameter("light samples", u64::from(SAMPLES) * 16);
        let buffers = LightBuffers { light, sampling: record, samples };
        shading::append(plan, request, receivers, &buffers, Seen::Values(visibility), &sampling());
    }
    plan.outputs.push(visibility);
    plan.outputs.extend(request.opens_block.then_some(receivers));
}

/// The values of receivers, light and picture.
///
/// # Errors
/// As [`light_buffers::values`].
pub(crate) fn values(request: &Request<'_>, light: &Light) -> Result<Values, SceneError> {
    let mut values = Values::new();
    receivers::values(request, &mut values);
    light_buffers::values(request, light, &sampling(), &mut values)?;
    let record = Sampling::new(request, &sampling(), 0, 1);
    values.insert("sampling".into(), bytemuck::bytes_of(&record).to_vec());
    shading::values(request, 1, &mut values);
    Ok(values)
}
