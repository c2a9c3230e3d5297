//! Twins of the kernels, one file a WGSL file, at the same path.
//!
//! A twin takes its buffers by the names of the WGSL bindings, reads and writes the same records, and leaves the same contents;
//! only where the WGSL appends to a list in no particular order may the order differ. What is written item by item is cut into runs for the threads;
//! what is written here and there goes through atomic words. Inner loops are eight lanes wide ([`lanes`]) and chosen for the processor
//! with `fearless_simd::dispatch!`; functions below it are `#[inline(always)]`, because only then they use its instructions.

mod depth_complexity;
mod lanes;
mod occlusion_layers;
mod ray_traced;
mod receivers;
mod resolve;
mod shading;
mod shared;

use bytemuck::Pod;
use softshadow_plan::Kernel;

use crate::engine::Call;

/// What runs a kernel here.
type Twin = fn(&mut Call);

/// Items that a thread takes at once.
const RUN: usize = 1024;

/// Whether a kernel runs natively.
#[must_use]
pub fn has_twin(kernel: Kernel) -> bool {
    twin(kernel).is_some()
}

/// The twin of a kernel, by its name.
pub(crate) fn twin(kernel: Kernel) -> Option<Twin> {
    let Kernel { file, entry } = kernel;
    let (folder, file) = file.strip_suffix(".wgsl")?.split_once('/')?;
    match folder {
        "depth_complexity" => depth_complexity::twin(file, entry),
        "occlusion_layers" => occlusion_layers::twin(file, entry),
        "ray_traced" => ray_traced::twin(file, entry),
        "receivers" => receivers::twin(file, entry),
        "resolve" => resolve::twin(file, entry),
        "shading" => shading::twin(file, entry),
        _ => None,
    }
}

/// Words as records; what is left over at the end is not one.
fn records<T: Pod>(words: &[u32]) -> &[T] {
    let count = words.len() * 4 / size_of::<T>();
    bytemuck::cast_slice(&words[..count * size_of::<T>() / 4])
}

/// Words as records to write.
fn records_mut<T: Pod>(words: &mut [u32]) -> &mut [T] {
    let count = words.len() * 4 / size_of::<T>();
    bytemuck::cast_slice_mut(&mut words[..count * size_of::<T>() / 4])
}
