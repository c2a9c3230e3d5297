//! The twin of `depth_complexity/reference_depth.wgsl`: counts the layers over the reference point by the signs with which edges count.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Simd, dispatch, f32x8, i32x8, mask32x8, prelude::*, u32x8};
use rayon::prelude::*;

use super::attenuation::{LARGEST_ATTENUATION, OPAQUE};
use super::clusters::ClusterRange;
use super::cover::{Loop, cover};
use super::edge::edge_image;
use super::frame::{FrameView, LightFrame};
use super::lists::{Bundle, SLOT, entries, lanes_of};
use super::occluders::{Face, NO_SIDE, OccluderEdge};
use super::tiles::{BUNDLE, BUNDLES, TILE, count, first_chunk_word};
use super::walk::scattered;
use crate::engine::{Call, atomic_words};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::records;
use crate::kernels::shared::receiver::Receiver;

/// Rounding, with room to spare.
const SLACK: f32 = 4e-6;

/// Tiles that a thread takes at once: they differ in cost.
const TILES: usize = 4;

struct Faces<'a> {
    frame: LightFrame,
    range: ClusterRange,
    receivers: &'a [Receiver],
    faces: &'a [Face],
    edges: &'a [OccluderEdge],
    /// First chunks of the lists of a part's bundles.
    first: &'a [u32],
    chunks: &'a [u32],
}

pub(super) fn reference_depth(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (frame, range) = (call.uniform::<LightFrame>("light_frame"), call.uniform("cluster_range"));
    let names = ["receivers", "faces", "edges", "first_faces", "lists", "slots", "blocked"];
    let [receivers, faces, edges, first, lists, slots, blocked] = call.buffers(names);
    let faces = Faces::new(frame, range, [receivers, faces, edges, first, lists]);
    let (slots, blocked) = (atomic_words(slots), atomic_words(blocked));
    let words = frame.sample_count.div_ceil(32) as usize;
    let write = |at: usize, receiver: u32, depth: i32| {
        slots[SLOT * at + 2].store(depth as u32, Ordering::Relaxed);
        if depth != 0 {
            let masks = &blocked[receiver as usize * words..][..words];
            masks.iter().for_each(|word| word.store(u32::MAX, Ordering::Relaxed));
        }
    };
    let groups = (items.start / TILE..items.end / TILE).into_par_iter().with_max_len(TILES);
    groups.for_each(|group| {
        let tile = scattered(group, faces.range.tile_count as usize);
        dispatch!(level, simd => count_tile(simd, &faces, tile, slots, write));
    });
}

/// As `reference_depth`, of opaque and semi-opaque faces apart.
pub(super) fn reference_depth_attenuated(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (frame, range) = (call.uniform("light_frame"), call.uniform("cluster_range"));
    let names = ["receivers", "faces", "edges", "first_faces", "lists", "slots", "triangle_attenuation", "counts"];
    let [receivers, faces, edges, first, lists, slots, units, counts] = call.buffers(names);
    let faces = Faces::new(frame, range, [receivers, faces, edges, first, lists]);
    let (slots, counts) = (atomic_words(slots), atomic_words(counts));
    let groups = (items.start / TILE..items.end / TILE).into_par_iter().with_max_len(TILES);
    groups.for_each(|group| {
        let tile = scattered(group, faces.range.tile_count as usize);
        dispatch!(level, simd => attenuate_tile(simd, &faces, units, tile, slots, counts));
    });
}

impl<'a> Faces<'a> {
    fn new(frame: LightFrame, range: ClusterRange, words: [&'a [u32]; 5]) -> Self {
        let [receivers, faces, edges, first, lists] = words;
        Self {
            frame,
            range,
            receivers: records(receivers),
            faces: records(faces),
            edges: records(edges),
            first,
            chunks: &lists[first_chunk_word(range.tile_count as usize)..],
        }
    }

    /// Calls `each` for the bundles of a tile: a list, the first slot, who has this list.
    #[inline(always)]
    fn bundles(&self, tile: usize, slots: &[AtomicU32], mut each: impl FnMut(u32, usize, &Bundle, u32)) {
        if tile >= self.range.tile_count as usize {
            return;
        }
        let lists = &self.first[2 * BUNDLES * tile..][..2 * BUNDLES];
        for at in 0..BUNDLES {
            if lists[at] == 0 && lists[BUNDLES + at] == 0 {
                continue;
            }
            let first = TILE * tile + BUNDLE * at;
            let bundle = Bundle::at(first, self.range.receiver_count as usize, slots, self.receivers);
            for part in 0..2 {
                let (list, members) = (lists[BUNDLES * part + at], bundle.members(part as u32));
                if list != 0 && members != 0 {
                    each(list, first, &bundle, members);
                }
            }
        }
    }
}

#[inline(always)]
fn count_tile<S: Simd>(simd: S, faces: &Faces<'_>, tile: usize, slots: &[AtomicU32], write: impl Fn(usize, u32, i32)) {
    faces.bundles(
        tile,
        slots,
        #[inline(always)]
        |list, first, bundle, members| {
            let mut depth = i32x8::splat(simd, 0);
            covers(
                simd,
                faces,
                list,
                bundle,
                members,
                #[inline(always)]
                |_, times| depth += times,
            );
            for k in lanes_of(members) {
                write(first + k, bundle.slots[k].receiver, depth.as_slice()[k]);
            }
        },
    );
}

#[inline(always)]
fn attenuate_tile<S: Simd>(
    simd: S,
    faces: &Faces<'_>,
    units: &[u32],
    tile: usize,
    slots: &[AtomicU32],
    counts: &[AtomicU32],
) {
    faces.bundles(
        tile,
        slots,
        #[inline(always)]
        |list, first, bundle, members| {
            let mut depth = i32x8::splat(simd, 0);
            let (mut attenuation, mut most) = ([0i32; LANES], [0u32; LANES]);
            covers(
                simd,
                faces,
                list,
                bundle,
                members,
                #[inline(always)]
                |face, times| {
                    let units = units[face.triangle as usize];
                    if units == OPAQUE {
                        depth += times;
                        return;
                    }
                    for (k, times) in times.to_array().into_iter().enumerate() {
                        if times != 0 && most[k] <= LARGEST_ATTENUATION {
                            attenuation[k] = attenuation[k].wrapping_add(times.wrapping_mul(units as i32));
                            most[k] = most[k].wrapping_add(units);
                        }
                    }
                },
            );
            for k in lanes_of(members) {
                let slot = &slots[SLOT * (first + k)..][..SLOT];
                slot[2].store(depth.as_slice()[k] as u32, Ordering::Relaxed);
                slot[3].store(attenuation[k] as u32, Ordering::Relaxed);
                if most[k] > LARGEST_ATTENUATION {
                    counts[count::OVERFLOWED].fetch_add(1, Ordering::Relaxed);
                }
            }
        },
    );
}

/// Calls `each` for the faces that cover the reference point of any of a bundle's members: how often.
#[inline(always)]
fn covers<S: Simd>(
    simd: S,
    faces: &Faces<'_>,
    list: u32,
    bundle: &Bundle,
    members: u32,
    mut each: impl FnMut(&Face, i32x8<S>),
) {
    let view = faces.frame.view(simd, bundle.positions(simd));
    let triangles = bundle.triangles(simd);
    let members = mask32x8::from_bitmask(simd, u64::from(members));
    let size = Vec3x8::new(1.0 + view.position.x.abs(), 1.0 + view.position.y.abs(), 1.0 + view.position.z.abs());
    let way_size = Vec3x8::new(view.way.x.abs(), view.way.y.abs(), view.way.z.abs());
    for entry in entries(faces.chunks, list) {
        let face = &faces.faces[entry as usize];
        let of_another = triangles.simd_ne(u32x8::splat(simd, face.triangle));
        let waiting = members & of_another & !turns_away(simd, &view, face, size, way_size);
        if !waiting.any_true() {
            continue;
        }
        let mut border = Loop::empty(simd);
        for reference in face.sides.into_iter().filter(|reference| *reference != NO_SIDE) {
            let image = edge_image(simd, &view, &faces.edges[(reference >> 1) as usize]);
            border.add(simd, &image, reference & 1 == 0);
        }
        let times = waiting.select(cover(simd, &view, face, &border), i32x8::splat(simd, 0));
        if times.simd_ne(0).any_true() {
            each(face, times);
        }
    }
}

/// Whether the way to the reference point leads off a face's plane, by more than rounding could turn it: then it does not meet the face.
#[inline(always)]
fn turns_away<S: Simd>(
    simd: S,
    view: &FrameView<S>,
    face: &Face,
    position_size: Vec3x8<S>,
    way_size: Vec3x8<S>,
) -> mask32x8<S> {
    let normal = Vec3x8::splat(simd, face.normal);
    let height = normal.dot(view.position - Vec3x8::splat(simd, face.point));
    let slope = normal.dot(view.way);
    let normal_size = Vec3x8::splat(simd, face.normal.abs());
    let size = normal_size.dot(position_size + Vec3x8::splat(simd, face.point.abs()));
    let margin: f32x8<S> = SLACK * size;
    let turn = SLACK * normal_size.dot(way_size);
    (height.simd_gt(margin) & slope.simd_gt(turn)) | (height.simd_lt(-margin) & slope.simd_lt(-turn))
}
