//! The twin of `shading/interleave_colors.wgsl`.

use fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*, u32x8};
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::lanes::LANES;
use crate::kernels::shared::continuity::Interleaving;
use crate::kernels::shared::receiver::{RECEIVER_NONE, Receiver};
use crate::kernels::{RUN, records, records_mut};

struct Image<'a> {
    interleaving: Interleaving,
    receivers: &'a [Receiver],
    triangle_materials: &'a [u32],
    noisy_color: &'a [[f32; 4]],
}

pub(super) fn interleave_colors(call: &mut Call) {
    let (items, level, interleaving) = (call.item_range(), call.level, call.uniform("interleaving"));
    let [receivers, triangle_materials, noisy_color, color] =
        call.buffers(["receivers", "triangle_materials", "noisy_color", "color"]);
    let image =
        Image { interleaving, receivers: records(receivers), triangle_materials, noisy_color: records(noisy_color) };
    let color = &mut records_mut::<[f32; 4]>(color)[items.clone()];
    color.par_chunks_mut(RUN).enumerate().for_each(|(run, color)| {
        let first = items.start + run * RUN;
        dispatch!(level, simd => average_run(simd, &image, first, color));
    });
}

#[inline(always)]
fn average_run<S: Simd>(simd: S, image: &Image<'_>, first: usize, color: &mut [[f32; 4]]) {
    for (at, color) in color.chunks_mut(LANES).enumerate() {
        let (first, last) = (first + at * LANES, color.len() - 1);
        let pixels: [usize; LANES] = std::array::from_fn(|k| first + k.min(last));
        let averaged = image.average(simd, pixels);
        for (k, color) in color.iter_mut().enumerate() {
            let is_seen = image.receivers[pixels[k]].kind != RECEIVER_NONE;
            let channel = |c: usize| averaged[c].as_slice()[k];
            *color = if is_seen { [channel(0), channel(1), channel(2), 1.0] } else { [0.0; 4] };
        }
    }
}

impl Image<'_> {
    /// What a pixel's surface is made of; where nothing is seen any material does, it is not continuous.
    #[inline(always)]
    fn material(&self, pixel: usize) -> u32 {
        let receiver = &self.receivers[pixel];
        if receiver.kind == RECEIVER_NONE { 0 } else { self.triangle_materials[receiver.triangle as usize] }
    }

    #[inline(always)]
    fn average<S: Simd>(&self, simd: S, pixels: [usize; LANES]) -> [f32x8<S>; 3] {
        let zero = f32x8::splat(simd, 0.0);
        let materials = u32x8::from_fn(simd, |k| self.material(pixels[k]));
        let (mut sum, mut total) = ([zero; 3], zero);
        self.interleaving.around(simd, self.receivers, pixels, |there| {
            let is_alike = u32x8::from_fn(simd, |k| self.material(there.at[k])).simd_eq(materials) & there.continuous;
            let is_one = there.exist & (is_alike | mask32x8::splat(simd, there.own));
            let weight = is_one.select(f32x8::splat(simd, there.share), zero);
            for (channel, sum) in sum.iter_mut().enumerate() {
                *sum += weight * f32x8::from_fn(simd, |k| self.noisy_color[there.at[k]][channel]);
            }
            total += weight;
        });
        sum.map(|sum| sum / total)
    }
}
