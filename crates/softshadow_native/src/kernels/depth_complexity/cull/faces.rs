//! For every bundle the faces that can lie between its receivers and the reference point.

use std::ops::ControlFlow;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::super::shaft::PlanesInLanes;
use super::super::tiles::{BUNDLES, TilePart, count};
use super::super::tree::{TreeNode, walk};
use super::bundles::Tiles;
use super::lists::Lists;
use crate::engine::Call;
use crate::kernels::records;

/// Parts that a thread takes at once.
const PARTS: usize = 16;

struct Faces<'a> {
    tiles: Tiles<'a>,
    parts: &'a [TilePart],
    tree: &'a [TreeNode],
    lists: Lists<'a>,
}

pub(in super::super) fn list_faces(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (frame, range) = (call.uniform("light_frame"), call.uniform("cluster_range"));
    let [receivers, slots, tree, parts, first_faces, lists, counts] =
        call.buffers(["receivers", "slots", "face_tree", "parts", "first_faces", "lists", "counts"]);
    let tiles = Tiles { frame, range, receivers: records(receivers), slots: records(slots) };
    let lists = Lists::new(lists, counts, range.tile_count);
    let faces = Faces { tiles, parts: records(parts), tree: records(tree), lists };
    // The plan rounds the number of items up.
    let end = items.end.min(first_faces.len());
    let first_faces = &mut first_faces[items.start.min(end)..end];
    first_faces.par_chunks_mut(PARTS * BUNDLES).enumerate().for_each_init(Vec::new, |list, (run, first_faces)| {
        let part = items.start / BUNDLES + run * PARTS;
        dispatch!(level, simd => {
            for (k, first_faces) in first_faces.chunks_mut(BUNDLES).enumerate() {
                list_faces_of_part(simd, &faces, part + k, first_faces, list);
            }
        });
    });
}

#[inline(always)]
fn list_faces_of_part<S: Simd>(simd: S, faces: &Faces<'_>, part: usize, first_faces: &mut [u32], list: &mut Vec<u32>) {
    first_faces.fill(0);
    if faces.parts[part].has_faces == 0 {
        return;
    }
    let tiles = &faces.tiles;
    let bundles = tiles.bundles(simd, part, tiles.frame.reference_point());
    for (first_face, bundle) in first_faces.iter_mut().zip(&bundles) {
        if bundle.receiver_count == 0 {
            continue;
        }
        list.clear();
        walk(simd, faces.tree, &PlanesInLanes::new(simd, &bundle.shaft.planes), |leaf| {
            list.extend(leaf.start as u32..leaf.end as u32);
            ControlFlow::Continue(())
        });
        let written = faces.lists.write(list);
        *first_face = written.first;
        if written.full {
            faces.lists.add(count::UNFINISHED, bundle.receiver_count);
        }
    }
}
