//! The twin of `depth_complexity/cover_faces.wgsl`: face by face, which samples it hides from eight receivers, 64 samples at a time, until
//! all are hidden.
//!
//! A bundle walks the hierarchy once. Nodes and faces wait until there are eight of them, and then what cannot hide a sample that anybody
//! still sees is passed by ([`Beam`]); of what remains, each face is tried for eight receivers at once ([`Hider`]).
//!
//! No driver ends loops here: the first round finishes every walk, and later rounds find nothing to do.

use std::sync::atomic::{AtomicU32, Ordering};

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, dispatch, f32x8, prelude::*, u32x8};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::beam::Beam;
use super::bundles::{groups, reach_of};
use super::edge::Vec2x8;
use super::frame::{FRAME_SPHERE, LightFrame};
use super::hider::Hider;
use super::occluders::Face;
use super::sample_bins::{Bins, SampleBins};
use super::tiles::{NO_VIEW, Slot, TILE};
use super::tree::TreeNode;
use crate::engine::{Call, atomic_words, shared};
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::shared::receiver::Receiver;
use crate::kernels::{records, records_mut};

/// Samples of one pass.
pub(super) const GROUP: usize = 64;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct CoverSettings {
    receiver_count: u32,
    /// Which 64 of a receiver's samples.
    group: u32,
    round: u32,
    rounds: u32,
}

struct Scene<'a> {
    frame: LightFrame,
    samples: [Vec4; GROUP],
    bins: Bins,
    receivers: &'a [Receiver],
    faces: &'a [Face],
    /// In the order of a face's sides; a triangle comes back to its first.
    corners: &'a [[Vec3; 4]],
    tree: &'a [TreeNode],
    blocked: &'a [AtomicU32],
    /// Words of a receiver's mask, and the first of this group's.
    words: usize,
    first_word: usize,
    /// How far apart receivers that walk together may stand.
    reach: f32,
}

pub(super) fn cover_faces(call: &mut Call) {
    let settings: CoverSettings = call.uniform("cover_settings");
    if settings.round > 0 {
        return;
    }
    let (mut items, level) = (call.item_range(), call.level);
    let frame: LightFrame = call.uniform("light_frame");
    let samples = call.uniform("group_samples");
    let bins = Bins::new(&call.uniform::<SampleBins>("sample_bins"));
    let names = ["receivers", "faces", "face_corners", "face_tree", "slots", "blocked"];
    let [receivers, faces, corners, tree, slots, blocked] = call.buffers(names);
    let scene = Scene {
        frame,
        samples,
        bins,
        receivers: records(receivers),
        faces: records(faces),
        corners: records(corners),
        tree: records(tree),
        blocked: atomic_words(blocked),
        words: frame.sample_count.div_ceil(32) as usize,
        first_word: 2 * settings.group as usize,
        reach: reach_of(records(tree)),
    };
    // There are more items than receivers, because the device strews its groups; whoever is free takes the next tile here.
    items.end = items.end.min(settings.receiver_count as usize);
    items.start = items.start.min(items.end);
    let slots = &mut records_mut::<Slot>(slots)[items];
    slots.par_chunks_mut(TILE).for_each(|slots| dispatch!(level, simd => cover_tile(simd, &scene, slots)));
}

#[inline(always)]
fn cover_tile<S: Simd>(simd: S, scene: &Scene<'_>, slots: &mut [Slot]) {
    let mut samples = [[f32x8::splat(simd, 0.0); 2]; GROUP];
    for (sample, at) in samples.iter_mut().zip(&scene.samples) {
        *sample = [f32x8::splat(simd, at.x), f32x8::splat(simd, at.y)];
    }
    let mut waiting = Waiting::default();
    for slots in slots.chunks_mut(LANES) {
        let mut lanes = 0;
        let mut positions = [Vec3::ZERO; LANES];
        for (k, slot) in slots.iter().enumerate().filter(|(_, slot)| slot.depth != NO_VIEW) {
            lanes |= 1 << k;
            positions[k] = scene.receivers[slot.receiver as usize].position;
        }
        for lanes in groups(lanes, &positions, scene.reach) {
            cover_group(simd, scene, &samples, (lanes, slots), &mut waiting);
        }
    }
}

/// Nodes and faces that were not looked at yet.
#[derive(Default)]
struct Waiting {
    nodes: Vec<u32>,
    faces: Vec<u32>,
}

/// Takes the last eight; the last of fewer stands for those that lack.
fn take_eight(waiting: &mut Vec<u32>) -> ([usize; LANES], usize) {
    let count = waiting.len().min(LANES);
    let last = waiting.split_off(waiting.len() - count);
    (std::array::from_fn(|k| last[k.min(count - 1)] as usize), count)
}

/// Which of eight receivers see a sample yet, one bit each, and which samples anybody sees.
pub(super) struct Seen {
    pub(super) lanes: [u8; GROUP],
    pub(super) any: u64,
}

impl Seen {
    fn new(samples: &[u64; LANES]) -> Self {
        let mut lanes = [0; GROUP];
        for (k, samples) in samples.iter().enumerate() {
            for (i, lanes) in lanes.iter_mut().enumerate() {
                *lanes |= ((samples >> i & 1) << k) as u8;
            }
        }
        Self { lanes, any: samples.iter().fold(0, |any, samples| any | samples) }
    }

    /// A sample is hidden from some receivers.
    #[inline(always)]
    pub(super) fn take_away(&mut self, sample: usize, lanes: u64) {
        self.lanes[sample] &= !(lanes as u8);
        if self.lanes[sample] == 0 {
            self.any &= !(1 << sample);
        }
    }

    /// The samples that one receiver sees.
    fn of(&self, lane: usize) -> u64 {
        self.lanes.iter().enumerate().fold(0, |seen, (i, lanes)| seen | u64::from(lanes >> lane & 1) << i)
    }
}

#[inline(always)]
fn cover_group<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    samples: &[Vec2x8<S>; GROUP],
    (lanes, slots): (u8, &mut [Slot]),
    waiting: &mut Waiting,
) {
    // Who does not belong to it looks through the eyes of one who does.
    let exists: [bool; LANES] = std::array::from_fn(|k| lanes >> k & 1 != 0);
    let somebody = lanes.trailing_zeros() as usize;
    let indices: [usize; LANES] =
        std::array::from_fn(|k| slots[if exists[k] { k } else { somebody }].receiver as usize);
    let receivers = indices.map(|index| scene.receivers[index]);
    let words = indices.map(|index| &scene.blocked[index * scene.words..(index + 1) * scene.words][scene.first_word..]);
    let all = scene.bins.all();
    let mut seen = Seen::new(&std::array::from_fn(|k| {
        let second = words[k].get(1).map_or(0, shared);
        if exists[k] { all & !(u64::from(shared(&words[k][0])) | u64::from(second) << 32) } else { 0 }
    }));

    let view = scene.frame.view(simd, Vec3x8::from_fn(simd, |k| receivers[k].position));
    let root = &scene.tree[0];
    let beam = Beam::new(simd, &scene.frame, &view, root.low, root.high);
    let triangles = u32x8::from_fn(simd, |k| receivers[k].triangle);
    let mut moved = *samples;
    if scene.frame.kind == FRAME_SPHERE {
        for sample in &mut moved {
            *sample = scene.frame.placed_sample(simd, &view, *sample);
        }
    }
    let hider = Hider { frame: &scene.frame, view, triangles, samples: &moved };

    waiting.nodes.clear();
    waiting.faces.clear();
    waiting.nodes.push(0);
    while seen.any != 0 {
        if waiting.faces.len() >= LANES || waiting.nodes.is_empty() && !waiting.faces.is_empty() {
            let (faces, count) = take_eight(&mut waiting.faces);
            let corner = |c: usize| Vec3x8::from_fn(simd, |k| scene.corners[faces[k]][c]);
            let near = beam.behind_faces(simd, &scene.bins, &[corner(0), corner(1), corner(2), corner(3)]);
            for k in 0..count {
                if near[k] & seen.any != 0 {
                    let index = faces[k];
                    hider.hide(simd, &scene.faces[index], &scene.corners[index], near[k], &mut seen);
                }
            }
        } else if !waiting.nodes.is_empty() {
            let (nodes, count) = take_eight(&mut waiting.nodes);
            let low = Vec3x8::from_fn(simd, |k| scene.tree[nodes[k]].low);
            let high = Vec3x8::from_fn(simd, |k| scene.tree[nodes[k]].high);
            let near = beam.behind_boxes(simd, &scene.bins, [low, high]);
            for k in 0..count {
                if near[k] & seen.any == 0 {
                    continue;
                }
                let node = &scene.tree[nodes[k]];
                if node.leaf == 0 {
                    let first = nodes[k] as u32 + 1;
                    waiting.nodes.extend([first, scene.tree[nodes[k] + 1].skip]);
                } else {
                    waiting.faces.extend(node.triangles().map(|face| face as u32));
                }
            }
        } else {
            break;
        }
    }
    for (k, slot) in slots.iter_mut().enumerate().filter(|(k, _)| exists[*k]) {
        let hidden = all & !seen.of(k);
        words[k][0].store(hidden as u32, Ordering::Relaxed);
        if let Some(second) = words[k].get(1) {
            second.store((hidden >> 32) as u32, Ordering::Relaxed);
        }
        slot.part = scene.tree.len() as u32;
    }
}
