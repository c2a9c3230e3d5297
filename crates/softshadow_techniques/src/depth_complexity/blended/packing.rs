//! How counters are packed into digits: of 32-bit words, or of float32 channels that are exact below 2^24 (Forest et al., section 7.3,
//! equations 7 to 10).
//!
//! A digit must hold its sample's final count. A channel must, besides, stay below 2^24 at every moment: in whatever order changes come,
//! that is so while no digit can rise or fall by its base. Both are known before anything is counted, from the largest sums of changes at
//! any receiver, and so nothing overflows: digits are as wide as those sums demand.

use softshadow_plan::Limits;

use super::super::Counters;

/// Bases that the paper packs with.
pub(in super::super) const BASES: [u32; 4] = [8, 16, 64, 256];

/// `Packing` of `packing.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Packing {
    bits: u32,
    fields: u32,
    words: u32,
    bias: u32,
    first_sample: u32,
    sample_count: u32,
    batch: u32,
    reserved: u32,
}

/// `Largest` of `find_largest.wgsl`: what the receivers' counters can reach.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Largest {
    /// The count at the reference point and all that is added.
    pub count: u32,
    /// All that is taken away.
    pub fall: u32,
    /// The count at the reference point.
    pub initial: u32,
    /// Receivers that stand farther from the middle of their pixel than wedges reach.
    pub astray: u32,
}

/// Digits of one width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Digits {
    /// Where they are.
    pub(super) counters: Counters,
    /// Bits of one.
    pub(super) bits: u32,
    /// How many a word or channel has.
    pub(super) fields: u32,
    /// What every digit is read above its count: a count that rounding puts below 0 must not borrow from its neighbour.
    pub(super) bias: u32,
}

const fn words(bits: u32, bias: u32) -> Digits {
    Digits { counters: Counters::Words, bits, fields: 32 / bits, bias }
}

const fn channels(bits: u32, bias: u32) -> Digits {
    Digits { counters: Counters::Float, bits, fields: 24 / bits, bias }
}

/// Every width, narrowest first; the last ones hold anything.
const WORDS: [Digits; 5] = [words(4, 2), words(6, 8), words(8, 16), words(16, 16), words(32, 0)];
const CHANNELS: [Digits; 6] =
    [channels(3, 1), channels(4, 2), channels(6, 8), channels(8, 16), channels(12, 16), channels(24, 16)];

impl Digits {
    /// The narrowest digits of at least this base that hold the counters. More than channels hold goes to words.
    #[must_use]
    pub(super) fn new(counters: Counters, base: u32, largest: Largest) -> Self {
        let wide_enough = |digits: &&Self| digits.bits >= base.ilog2() && digits.hold(largest);
        let channels = CHANNELS.iter().filter(|_| counters == Counters::Float).find(wide_enough);
        // A word of one digit holds what fits a word.
        *channels.or_else(|| WORDS.iter().find(wide_enough)).unwrap_or(&WORDS[WORDS.len() - 1])
    }

    /// Whether no counter can leave its digit, at the end or, in a channel, at any moment.
    #[must_use]
    pub(super) fn hold(&self, largest: Largest) -> bool {
        let holds = |count: u64| count < 1 << self.bits;
        let fall = if self.counters == Counters::Float { u64::from(largest.fall) } else { 0 };
        holds(u64::from(largest.count) + u64::from(self.bias)) && holds(fall)
    }

    /// The draws that count so many samples, and the targets of each; 0 targets for words.
    #[must_use]
    pub(super) fn draws(&self, samples: u32, limits: &Limits) -> (Vec<Packing>, usize) {
        let (per_draw, targets, words) = match self.counters {
            Counters::Words => (samples, 0, samples.div_ceil(self.fields)),
            Counters::Float => {
                let most = limits.color_targets.min(limits.color_bytes / TARGET_BYTES);
                let needed = samples.div_ceil(4 * self.fields);
                let mut allowed = TARGETS.iter().filter(|count| **count <= most);
                let enough = allowed.clone().find(|count| **count >= needed);
                let targets = enough.or_else(|| allowed.next_back()).copied().unwrap_or(1);
                (4 * self.fields * targets, targets as usize, 4 * targets)
            }
        };
        let draw = |first: u32| Packing {
            bits: self.bits,
            fields: self.fields,
            words,
            bias: self.bias,
            first_sample: first,
            sample_count: per_draw.min(samples - first),
            batch: 0,
            reserved: 0,
        };
        ((0..samples).step_by(per_draw as usize).map(draw).collect(), targets)
    }
}

impl Packing {
    /// Words of a receiver.
    #[must_use]
    pub fn words(&self) -> u32 {
        self.words
    }

    /// The same samples, counted in this batch.
    #[must_use]
    pub fn in_batch(self, batch: u32) -> Self {
        Self { batch, ..self }
    }
}

/// Bytes of a pixel of one target.
pub(super) const TARGET_BYTES: u32 = 16;
/// How many targets a draw may have: there is a fragment shader for each.
pub const TARGETS: [u32; 6] = [1, 2, 3, 4, 6, 8];

/// Layers of a texture of counters: an array of one layer would be no array on GL.
#[must_use]
pub(super) fn layers(targets: usize) -> u32 {
    targets.max(2) as u32
}

/// Bytes of a receiver's counters at the widest digits: a word, or a channel, for each sample, of as many as one draw has.
#[must_use]
pub(super) fn most_bytes(counters: Counters, samples: u32) -> u64 {
    match counters {
        Counters::Words => u64::from(samples) * 4,
        Counters::Float => {
            let enough = TARGETS.iter().find(|targets| **targets * 4 >= samples);
            u64::from(layers(*enough.unwrap_or(&TARGETS[TARGETS.len() - 1]) as usize) * TARGET_BYTES)
        }
    }
}

#[cfg(test)]
mod tests;
