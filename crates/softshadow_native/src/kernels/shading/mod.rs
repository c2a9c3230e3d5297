//! Twins of the kernels of `shading`.

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    let _ = (file, entry);
    None
}
