//! Twins of the kernels of `resolve`.

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    let _ = (file, entry);
    None
}
