//! The twin of `depth_complexity/find_faces.wgsl`.

use std::ops::ControlFlow;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::shaft::PlanesInLanes;
use super::tiles::TilePart;
use super::tree::{TreeNode, walk};
use crate::engine::Call;
use crate::kernels::{records, records_mut};

/// Parts that a thread takes at once: walks differ in length.
const PARTS: usize = 64;

pub(super) fn find_faces(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let [tree, parts] = call.buffers(["face_tree", "parts"]);
    let tree = records::<TreeNode>(tree);
    let parts = &mut records_mut::<TilePart>(parts)[items];
    parts.par_chunks_mut(PARTS).for_each(|parts| dispatch!(level, simd => find_in(simd, tree, parts)));
}

#[inline(always)]
fn find_in<S: Simd>(simd: S, tree: &[TreeNode], parts: &mut [TilePart]) {
    for part in parts.iter_mut().filter(|part| part.receiver_count > 0) {
        let shaft = PlanesInLanes::new(simd, &part.planes);
        part.has_faces = 0;
        walk(simd, tree, &shaft, |_| {
            part.has_faces = 1;
            ControlFlow::Break(())
        });
    }
}
