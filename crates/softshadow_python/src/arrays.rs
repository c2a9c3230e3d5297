//! Numpy arrays as rows, copied at the door: another Python thread may write to them while the interpreter is released.

use numpy::{Element, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::internal_exception;

/// The rows of a C-contiguous array of shape `(n, N)`.
pub(crate) fn rows<T: Element + Copy, const N: usize>(array: &PyReadonlyArray2<'_, T>) -> PyResult<Vec<[T; N]>> {
    let shape = array.shape();
    if shape[1] != N {
        return Err(internal_exception(format!("an array of shape (n, {N}) expected, got {shape:?}")));
    }
    Ok(array.as_slice()?.as_chunks().0.to_vec())
}
