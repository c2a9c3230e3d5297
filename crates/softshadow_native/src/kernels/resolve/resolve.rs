//! The twin of `resolve/resolve.wgsl`: from masks to visibility and its standard error. Its entries; what they say of a receiver stands
//! in `answers`, `attenuated` and `interleave`, what becomes of that in `passes`.

use super::answers::{Areas, Masks, Radiance, Textured};
use super::attenuated::{TexturedTransmittance, Transmittance};
use super::interleave::Kept;
use super::passes::Pass;
use crate::engine::Call;
use crate::kernels::records;
use crate::kernels::shared::continuity::Interleaving;

pub(super) fn resolve(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, blocked, visibility, error] = call.buffers(["decided", "blocked", "visibility", "standard_error"]);
    pass.accumulate(&Masks { sampling: pass.sampling, decided, blocked }, [visibility, error]);
}

pub(super) fn keep_samples(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, blocked, pass_values] = call.buffers(["decided", "blocked", "pass_values"]);
    pass.keep(&Masks { sampling: pass.sampling, decided, blocked }, pass_values);
}

pub(super) fn resolve_areas(call: &mut Call) {
    let pass = Pass::of(call);
    let [blocked, areas, visibility, error] = call.buffers(["blocked", "areas", "visibility", "standard_error"]);
    pass.accumulate(&Areas::new(pass.sampling, blocked, areas), [visibility, error]);
}

pub(super) fn keep_areas(call: &mut Call) {
    let pass = Pass::of(call);
    let [blocked, areas, pass_values] = call.buffers(["blocked", "areas", "pass_values"]);
    pass.keep(&Areas::new(pass.sampling, blocked, areas), pass_values);
}

pub(super) fn resolve_textured(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, blocked, radiance, visibility, error] =
        call.buffers(["decided", "blocked", "sample_radiance", "visibility", "standard_error"]);
    let masks = Masks { sampling: pass.sampling, decided, blocked };
    pass.accumulate(&Textured { masks, radiance: Radiance::new(&pass.sampling, radiance) }, [visibility, error]);
}

pub(super) fn keep_textured(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, blocked, radiance, pass_values] =
        call.buffers(["decided", "blocked", "sample_radiance", "pass_values"]);
    let masks = Masks { sampling: pass.sampling, decided, blocked };
    pass.keep(&Textured { masks, radiance: Radiance::new(&pass.sampling, radiance) }, pass_values);
}

pub(super) fn resolve_attenuated(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, samples, visibility, error] =
        call.buffers(["decided", "sample_transmittance", "visibility", "standard_error"]);
    let transmittance = Transmittance { sampling: pass.sampling, decided, samples: records(samples) };
    pass.accumulate(&transmittance, [visibility, error]);
}

pub(super) fn keep_attenuated(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, samples, pass_values] = call.buffers(["decided", "sample_transmittance", "pass_values"]);
    pass.keep(&Transmittance { sampling: pass.sampling, decided, samples: records(samples) }, pass_values);
}

pub(super) fn resolve_attenuated_textured(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, samples, radiance, visibility, error] =
        call.buffers(["decided", "sample_transmittance", "sample_radiance", "visibility", "standard_error"]);
    let transmittance = Transmittance { sampling: pass.sampling, decided, samples: records(samples) };
    pass.accumulate(
        &TexturedTransmittance { transmittance, radiance: Radiance::new(&pass.sampling, radiance) },
        [visibility, error],
    );
}

pub(super) fn keep_attenuated_textured(call: &mut Call) {
    let pass = Pass::of(call);
    let [decided, samples, radiance, pass_values] =
        call.buffers(["decided", "sample_transmittance", "sample_radiance", "pass_values"]);
    let transmittance = Transmittance { sampling: pass.sampling, decided, samples: records(samples) };
    pass.keep(&TexturedTransmittance { transmittance, radiance: Radiance::new(&pass.sampling, radiance) }, pass_values);
}

pub(super) fn interleave(call: &mut Call) {
    let pass = Pass::of(call);
    let interleaving: Interleaving = call.uniform("interleaving");
    let [receivers, pass_values, visibility, error] =
        call.buffers(["receivers", "pass_values", "visibility", "standard_error"]);
    let kept = Kept { interleaving, receivers: records(receivers), pass_values: records(pass_values) };
    match interleaving.channels {
        3 => pass.accumulate::<3>(&kept, [visibility, error]),
        _ => pass.accumulate::<1>(&kept, [visibility, error]),
    }
}
