//! Twins of the kernels of `ray_traced`.

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    let _ = (file, entry);
    None
}
