//! For every bundle those edges of its part's list that can be silhouettes between its receivers and the light.

use std::sync::atomic::Ordering::Relaxed;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::super::occluders::{IncidentFace, OccluderEdge};
use super::super::tiles::{BUNDLES, HEAD, count};
use super::bundles::Tiles;
use super::entries::{KeptEdges, ShaftInLanes};
use super::lists::Lists;
use crate::engine::{Call, shared};
use crate::kernels::lanes::LANES;
use crate::kernels::records;

/// Parts of a group of the pass: its size is one of groups.
const GROUP_PARTS: usize = 64 / BUNDLES;

struct Narrow<'a> {
    tiles: Tiles<'a>,
    edges: &'a [OccluderEdge],
    incident_faces: &'a [IncidentFace],
    lists: Lists<'a>,
}

/// What a thread keeps from part to part.
#[derive(Default)]
struct Scratch {
    of_part: Vec<u32>,
    kept: Vec<KeptEdges>,
    of_bundle: Vec<u32>,
}

pub(in super::super) fn narrow(call: &mut Call) {
    let (groups, level) = (call.item_range(), call.level);
    let (frame, range) = (call.uniform("light_frame"), call.uniform("cluster_range"));
    let [edges, incident_faces, receivers, slots, lists, counts] =
        call.buffers(["edges", "incident_faces", "receivers", "slots", "lists", "counts"]);
    let tiles = Tiles { frame, range, receivers: records(receivers), slots: records(slots) };
    let end = (groups.end * GROUP_PARTS).min(counts[count::PARTS] as usize);
    let lists = Lists::new(lists, counts, range.tile_count);
    let narrow = Narrow { tiles, edges: records(edges), incident_faces: records(incident_faces), lists };
    let heads = groups.start * GROUP_PARTS..end;
    heads.into_par_iter().with_min_len(GROUP_PARTS).for_each_init(Scratch::default, |scratch, head| {
        dispatch!(level, simd => narrow_part(simd, &narrow, head, scratch));
    });
}

#[inline(always)]
fn narrow_part<S: Simd>(simd: S, narrow: &Narrow<'_>, head: usize, scratch: &mut Scratch) {
    let Narrow { tiles, edges, incident_faces, lists } = narrow;
    let head = &lists.heads[head * HEAD..][..HEAD];
    let (part, first) = (shared(&head[0]), shared(&head[1]));
    let bundles = tiles.bundles(simd, part as usize, tiles.frame.whole_light());
    scratch.of_part.clear();
    lists.read(first, &mut scratch.of_part);
    scratch.kept.clear();
    for indices in scratch.of_part.chunks(LANES) {
        scratch.kept.push(KeptEdges::new(simd, edges, incident_faces, indices));
    }
    for (bundle, word) in bundles.iter().zip(&head[2..]) {
        let list = &mut scratch.of_bundle;
        list.clear();
        if bundle.receiver_count > 0 {
            let shaft = ShaftInLanes::new(simd, &bundle.shaft);
            for kept in &scratch.kept {
                shaft.list_entries(simd, kept, list);
            }
        }
        let written = lists.write(list);
        // Where there is no room, the whole tile's list serves the bundle as well.
        word.store(if written.full { first } else { written.first }, Relaxed);
    }
}
