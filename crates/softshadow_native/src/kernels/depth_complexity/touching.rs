//! The twin of `depth_complexity/touching.wgsl`: triangles that touch a ball of light, against every sample, eight samples at a time.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, dispatch, mask32x8, prelude::*};
use glam::Vec3;
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::lanes::{LANES, Vec3x8};
use crate::kernels::records;
use crate::kernels::shared::light::{Light, eight_ways, light_view};
use crate::kernels::shared::receiver::{RECEIVER_NONE, Receiver};
use crate::kernels::shared::samples::Sampling;
use crate::kernels::shared::triangle::{Corner, triangle_blocks};

/// Words that a thread takes at once: a word costs as many steps as there are triangles, for each of its samples.
const WORDS: usize = 16;

/// Triangles of this pass.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct TouchingRange {
    first: u32,
    end: u32,
    reserved: [u32; 2],
}

struct Scene<'a> {
    light: Light,
    sampling: Sampling,
    samples: &'a [[f32; 4]],
    receivers: &'a [Receiver],
    triangles: &'a [[Corner; 3]],
}

pub(super) fn try_touching(call: &mut Call) {
    let (items, level) = (call.item_range(), call.level);
    let (light, sampling) = (call.uniform("light"), call.uniform("sampling"));
    let range: TouchingRange = call.uniform("touching_range");
    let [receivers, samples, touching, blocked] = call.buffers(["receivers", "light_samples", "touching", "blocked"]);
    let triangles = &records(touching)[range.first as usize..range.end as usize];
    let scene = Scene { light, sampling, samples: records(samples), receivers: records(receivers), triangles };
    let first = items.start;
    blocked[items].par_chunks_mut(WORDS).enumerate().for_each(|(run, words)| {
        dispatch!(level, simd => {
            for (word, item) in words.iter_mut().zip(first + run * WORDS..) {
                *word |= scene.hidden(simd, item, *word);
            }
        });
    });
}

impl Scene<'_> {
    /// Which of a word's samples, of those that nothing blocked before, the triangles hide.
    #[inline(always)]
    fn hidden<S: Simd>(&self, simd: S, item: usize, blocked: u32) -> u32 {
        let words = self.sampling.words as usize;
        let (index, word) = (item / words, (item % words) as u32);
        let receiver = &self.receivers[index];
        let view = light_view(&self.light, receiver.position);
        if receiver.kind == RECEIVER_NONE || view.inside {
            return 0;
        }
        let count = (self.sampling.count - 32 * word).min(32);
        let first = (self.sampling.first_sample(index as u32) + 32 * word) as usize;
        let mut waiting = !blocked & (u32::MAX >> (32 - count));
        let mut hidden = 0;
        while waiting != 0 {
            let mut taken = [waiting.trailing_zeros(); LANES];
            for bit in &mut taken {
                if waiting != 0 {
                    *bit = waiting.trailing_zeros();
                    waiting &= waiting - 1;
                }
            }
            let samples = taken.map(|bit| self.samples[first + bit as usize]);
            let ways = eight_ways(simd, &self.light, &view, &samples, receiver.position);
            let hits = self.hits(simd, receiver, ways).to_bitmask();
            for (k, bit) in taken.into_iter().enumerate() {
                hidden |= ((hits >> k & 1) as u32) << bit;
            }
        }
        hidden
    }

    /// Which of eight ways meet a triangle.
    #[inline(always)]
    fn hits<S: Simd>(&self, simd: S, receiver: &Receiver, ways: Vec3x8<S>) -> mask32x8<S> {
        let mut hits = mask32x8::splat(simd, false);
        for triangle in self.triangles.iter().filter(|[a, ..]| a.triangle != receiver.triangle) {
            let corners: [Vec3; 3] = [triangle[0].position, triangle[1].position, triangle[2].position];
            hits |= triangle_blocks(simd, corners, receiver.position, ways, false);
            if hits.all_true() {
                break;
            }
        }
        hits
    }
}
