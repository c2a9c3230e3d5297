//! The twin of `ray_traced/hierarchy.wgsl`. That driver's limits on loops are not ours: `unfinished` stays 0.

use bytemuck::{Pod, Zeroable};

use crate::kernels::{records, records_mut};

/// A receiver whose bundle of rays meets something, and the part of the hierarchy in which that lies.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Candidate {
    pub(super) receiver: u32,
    pub(super) first_node: u32,
    pub(super) last_node: u32,
}

/// Which samples of the candidates a pass traces.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct TraceRange {
    pub(super) first_sample: u32,
    pub(super) end_sample: u32,
    pub(super) node_count: u32,
    reserved: u32,
}

/// Invocations of one workgroup.
pub(super) const GROUP: u32 = 64;
pub(super) const SAMPLES_PER_INVOCATION: u32 = 8;

/// Words of a list before its items; the first is their number.
const HEADER: usize = 4;

/// The candidates of a list.
pub(super) fn listed(list: &[u32]) -> &[Candidate] {
    &records(&list[HEADER..])[..list[0] as usize]
}

/// Appends what runs found, in their order: no list depends on the threads.
pub(super) fn append(list: &mut [u32], found: &[Vec<Candidate>]) {
    let (header, items) = list.split_at_mut(HEADER);
    let items: &mut [Candidate] = records_mut(items);
    for found in found {
        let count = header[0] as usize;
        items[count..count + found.len()].copy_from_slice(found);
        header[0] += found.len() as u32;
    }
}
