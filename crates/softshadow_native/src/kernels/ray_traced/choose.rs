//! The twin of `ray_traced/choose.wgsl`.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::shared::receiver::{RECEIVER_NONE, Receiver};
use crate::kernels::shared::samples::Sampling;
use crate::kernels::{RUN, records};

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ProbeImage {
    /// Of the rows in this block; 0 where receivers have no neighbours.
    width: u32,
    height: u32,
}

impl ProbeImage {
    /// Whether the receiver's own probes or a neighbour's, taken together, disagree.
    fn any_around(self, index: u32, mut disagree: impl FnMut(u32) -> bool) -> bool {
        if disagree(index) {
            return true;
        }
        if self.width == 0 {
            return false;
        }
        let (x, y) = (index % self.width, index / self.width);
        let columns = x.max(1) - 1..=(x + 1).min(self.width - 1);
        let mut rows = y.max(1) - 1..=(y + 1).min(self.height - 1);
        rows.any(|row| columns.clone().any(|column| disagree(row * self.width + column)))
    }
}

/// Asks for all samples of the receivers around which probes disagree.
fn choose_where(call: &mut Call, masks: &'static str, disagrees: impl Fn(&Probes<'_>, ProbeImage, u32) -> bool + Sync) {
    let items = call.item_range();
    let (sampling, image): (Sampling, ProbeImage) = (call.uniform("sampling"), call.uniform("probe_image"));
    let [receivers, values, decided] = call.buffers(["receivers", masks, "decided"]);
    let probes = Probes { sampling, receivers: records(receivers), values };
    let decided = &mut decided[items.clone()];
    let choose = |(at, decided): (usize, &mut u32)| {
        if *decided != 0 && disagrees(&probes, image, (items.start + at) as u32) {
            *decided = sampling.count;
        }
    };
    decided.par_iter_mut().enumerate().with_min_len(RUN).for_each(choose);
}

struct Probes<'a> {
    sampling: Sampling,
    receivers: &'a [Receiver],
    /// Masks, or what passes.
    values: &'a [u32],
}

impl Probes<'_> {
    fn has_none(&self, index: u32) -> bool {
        self.receivers[index as usize].kind == RECEIVER_NONE
    }

    /// `LIT`, `DARK` or both, from the probes of one receiver; nothing where there is no receiver.
    fn classes(&self, index: u32) -> u32 {
        if self.has_none(index) {
            return 0;
        }
        let Sampling { probes, words, .. } = self.sampling;
        let own = &self.values[(index * words) as usize..];
        let kept = |word: u32| u32::MAX >> (32 - (probes - 32 * word).min(32));
        let hidden: u32 = (0..probes.div_ceil(32)).map(|word| (own[word as usize] & kept(word)).count_ones()).sum();
        (u32::from(hidden < probes) * LIT) | (u32::from(hidden > 0) * DARK)
    }

    /// What passes to the probes of one receiver; nothing where there is no receiver.
    fn passing(&self, index: u32) -> &[f32] {
        let Sampling { probes, count, .. } = self.sampling;
        let probes = if self.has_none(index) { 0 } else { probes as usize };
        bytemuck::cast_slice(&self.values[(index * count) as usize..][..probes])
    }
}

const LIT: u32 = 1;
const DARK: u32 = 2;

pub(super) fn choose(call: &mut Call) {
    choose_where(call, "blocked", |probes, image, index| {
        let mut classes = 0;
        image.any_around(index, |index| {
            classes |= probes.classes(index);
            classes == LIT | DARK
        })
    });
}

pub(super) fn choose_attenuated(call: &mut Call) {
    choose_where(call, "sample_transmittance", |probes, image, index| {
        let (mut least, mut most) = (1.0_f32, 0.0_f32);
        image.any_around(index, |index| {
            for passes in probes.passing(index) {
                (least, most) = (least.min(*passes), most.max(*passes));
            }
            least < most
        })
    });
}
