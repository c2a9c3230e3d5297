//! The twin of `depth_complexity/cull.wgsl`: lists of faces for every bundle, of edges for every part, and of those for every bundle.
//!
//! Walks and lists have no budget of steps, and tiles are taken in order: both are for drivers that end loops without a word, or give
//! threads fixed runs of work.

mod bundles;
mod entries;
mod faces;
mod lists;
mod narrow;
mod stock;

use std::sync::atomic::Ordering::Relaxed;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::clusters::{Cluster, ClusterRange};
use super::tiles::{HEAD, TilePart, count};
use crate::engine::Call;
use crate::kernels::records;
use entries::{Shaft, ShaftInLanes};
pub(super) use faces::list_faces;
use lists::Lists;
pub(super) use narrow::narrow;
use stock::Stock;

/// Parts that a thread takes at once.
const PARTS: usize = 16;

pub(super) fn cull(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let range: ClusterRange = call.uniform("cluster_range");
    let [edges, incident_faces, clusters, groups, parts, lists, counts] =
        call.buffers(["edges", "incident_faces", "clusters", "groups_of_clusters", "parts", "lists", "counts"]);
    let clusters = &records::<Cluster>(clusters)[..range.cluster_count as usize];
    let stock = Stock::new(level, records(edges), records(incident_faces), clusters, records(groups));
    let lists = Lists::new(lists, counts, range.tile_count);
    let parts = &records::<TilePart>(parts)[..items.end];
    items.into_par_iter().with_min_len(PARTS).for_each_init(Vec::new, |list, index| {
        let part = &parts[index];
        if part.receiver_count > 0 && part.has_faces > 0 {
            list.clear();
            dispatch!(level, simd => list_edges(simd, &stock, part, list));
            finish(&lists, index, part.receiver_count, list);
        }
    });
}

#[inline(always)]
fn list_edges<S: Simd>(simd: S, stock: &Stock, part: &TilePart, list: &mut Vec<u32>) {
    let shaft = Shaft { planes: part.planes, middle: (part.low + part.high) * 0.5, half: (part.high - part.low) * 0.5 };
    let in_lanes = ShaftInLanes::new(simd, &shaft);
    stock.visit(simd, &shaft.planes, |kept| in_lanes.list_edges(simd, kept, list));
}

/// Writes a part's list, and its head where it has any.
fn finish(lists: &Lists<'_>, part: usize, receiver_count: u32, list: &[u32]) {
    let written = lists.write(list);
    if written.first != 0 {
        let head = lists.add(count::PARTS, 1) as usize * HEAD;
        lists.heads[head].store(part as u32, Relaxed);
        lists.heads[head + 1].store(written.first, Relaxed);
        lists.add(count::EDGES, list.len() as u32);
    }
    if written.full {
        lists.add(count::UNFINISHED, receiver_count);
    }
}
