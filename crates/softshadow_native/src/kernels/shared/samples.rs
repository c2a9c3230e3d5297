//! The twin of `shared/samples.wgsl`: how many samples a receiver has, and which they are.

use bytemuck::{Pod, Zeroable};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Sampling {
    pub(crate) count: u32,
    pub(crate) words: u32,
    pub(crate) probes: u32,
    pub(crate) pass_index: u32,
    pub(crate) passes: u32,
    /// Sets of samples, of which every receiver has one; with a row, the side of the square of pixels that has all.
    pub(crate) sets: u32,
    /// Pixels of a row, where sets are taken by place; 0 where they are drawn.
    pub(crate) row: u32,
    /// Of the block, among all of the call.
    pub(crate) first_receiver: u32,
}

/// A number whose every bit depends on every bit of the index (Wellons' lowbias32).
pub(crate) fn mixed(index: u32) -> u32 {
    let x = (index ^ (index >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Where the set of a receiver of the block begins among all samples.
pub(crate) fn first_sample(sampling: &Sampling, index: u32) -> u32 {
    if sampling.sets <= 1 {
        return 0;
    }
    let at = sampling.first_receiver.wrapping_add(index);
    let row = sampling.row.max(1);
    let placed = (at % row) % sampling.sets + sampling.sets * ((at / row) % sampling.sets);
    let chosen = if sampling.row > 0 { placed } else { mixed(at) % sampling.sets };
    chosen * sampling.count
}
