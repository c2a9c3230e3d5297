//! Twins of the kernels of `shading`.

mod interleave_colors;
mod pow;
mod shade;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("interleave_colors", "interleave_colors") => interleave_colors::interleave_colors,
        ("shade", "integrated") => shade::integrated,
        ("shade", "integrated_attenuated") => shade::integrated_attenuated,
        ("shade", "modulated") => shade::modulated,
        _ => return None,
    })
}
