//! The twin of `depth_complexity/spread_reference.wgsl`.
//!
//! What passes is as far off the WGSL's as the driver's own power of two is.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::frame::LightFrame;
use super::tiles::{NO_VIEW, Slot};
use crate::engine::{Call, atomic_words, shared};
use crate::kernels::{RUN, records};

/// What one unit takes away.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct AttenuationScale {
    /// Of the light: layers multiply.
    halvings: f32,
    /// Of all light: layers add.
    shares: f32,
}

impl AttenuationScale {
    /// What passes a sum.
    fn passed(&self, units: i32) -> f32 {
        let layers = units.max(0) as f32;
        ((-layers * self.halvings).exp2() - layers * self.shares).max(0.0)
    }
}

pub(super) fn spread_reference(call: &mut Call) {
    let items = call.item_range();
    let (frame, scale): (LightFrame, AttenuationScale) =
        (call.uniform("light_frame"), call.uniform("attenuation_scale"));
    let [slots, transmittance] = call.buffers(["slots", "sample_transmittance"]);
    let samples = frame.sample_count as usize;
    let transmittance = atomic_words(transmittance);
    let spread = |slot: &Slot| {
        // Without a view of the light nothing was counted.
        if slot.depth == NO_VIEW || (slot.depth == 0 && slot.attenuation == 0) {
            return;
        }
        let passes = if slot.depth == 0 { scale.passed(slot.attenuation) } else { 0.0 };
        let multiply = |word: &AtomicU32| word.store((f32::from_bits(shared(word)) * passes).to_bits(), Relaxed);
        transmittance[slot.receiver as usize * samples..][..samples].iter().for_each(multiply);
    };
    records::<Slot>(slots)[items].par_iter().with_min_len(RUN).for_each(spread);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_is_halved_or_taken_away() {
        let logarithmic = AttenuationScale { halvings: 1.0 / 4096.0, shares: 0.0 };
        assert_eq!([-5, 0, 4096, 8192].map(|units| logarithmic.passed(units)), [1.0, 1.0, 0.5, 0.25]);
        let sum = AttenuationScale { halvings: 0.0, shares: 1.0 / 65_536.0 };
        assert_eq!([0, 16_384, 65_536, 99_999].map(|units| sum.passed(units)), [1.0, 0.75, 0.0, 0.0]);
    }
}
