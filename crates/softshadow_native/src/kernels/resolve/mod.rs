//! Twins of the kernels of `resolve`.

mod answers;
mod attenuated;
mod interleave;
mod mask_samples;
mod open_samples;
mod passes;
#[expect(clippy::module_inception, reason = "the WGSL file has the name of its folder")]
mod resolve;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("mask_samples", "mask_samples") => mask_samples::mask_samples,
        ("open_samples", "open_samples") => open_samples::open_samples,
        ("resolve", "resolve") => resolve::resolve,
        ("resolve", "resolve_areas") => resolve::resolve_areas,
        ("resolve", "resolve_textured") => resolve::resolve_textured,
        ("resolve", "resolve_attenuated") => resolve::resolve_attenuated,
        ("resolve", "resolve_attenuated_textured") => resolve::resolve_attenuated_textured,
        ("resolve", "keep_samples") => resolve::keep_samples,
        ("resolve", "keep_areas") => resolve::keep_areas,
        ("resolve", "keep_textured") => resolve::keep_textured,
        ("resolve", "keep_attenuated") => resolve::keep_attenuated,
        ("resolve", "keep_attenuated_textured") => resolve::keep_attenuated_textured,
        ("resolve", "interleave") => resolve::interleave,
        _ => return None,
    })
}
