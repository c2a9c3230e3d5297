//! The twin of `shared/samples.wgsl`.

use bytemuck::{Pod, Zeroable};

/// How many samples a receiver has, which they are, and how their masks lie in memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Sampling {
    pub(crate) count: u32,
    /// 32-bit words of a receiver's mask.
    pub(crate) words: u32,
    /// Samples traced for every receiver.
    pub(crate) probes: u32,
    pub(crate) pass_index: u32,
    pub(crate) passes: u32,
    /// Of samples, of which every receiver has one; with a row, the side of the square of pixels that has all.
    pub(crate) sets: u32,
    /// Pixels of a row, where sets are taken by place; 0 where they are drawn.
    pub(crate) row: u32,
    /// Of the block, among all of the call.
    pub(crate) first_receiver: u32,
}

/// A number whose every bit depends on every bit of the index (Wellons' lowbias32).
fn mixed(index: u32) -> u32 {
    let x = (index ^ (index >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

impl Sampling {
    /// Where the set of a receiver of the block begins among all samples.
    pub(crate) fn first_sample(&self, index: u32) -> u32 {
        let at = self.first_receiver.wrapping_add(index);
        let set = match (self.sets, self.row) {
            (0 | 1, _) => 0,
            (sets, 0) => mixed(at) % sets,
            (sets, row) => (at % row) % sets + sets * ((at / row) % sets),
        };
        set * self.count
    }
}
