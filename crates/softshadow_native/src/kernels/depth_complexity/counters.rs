//! The twin of `depth_complexity/counters.wgsl`: one counter a sample, 64 samples at a time. Bit k of all counters stands in one word.

/// Values from 0 to this are told apart; who folds must see that no more can come.
pub(super) const LARGEST_COUNT: u32 = 4095;

const PLANES: usize = 12;

/// What a counter of 0 holds. Changes come in any order, and from 0 down to −1 a borrow would run through all planes: from here a few
/// steps either way run through two or three.
const ZERO: u32 = 6;

/// The counters of one receiver.
#[derive(Clone, Copy)]
pub(super) struct Counters {
    planes: [u64; PLANES],
}

/// A bit of a number, in all samples.
#[inline(always)]
pub(super) fn plane_of(value: u32, bit: usize) -> u64 {
    0u64.wrapping_sub(u64::from(value >> bit & 1))
}

impl Counters {
    /// All samples at one value.
    #[inline(always)]
    pub(super) fn at(value: i32) -> Self {
        Self { planes: std::array::from_fn(|bit| plane_of((value as u32).wrapping_add(ZERO), bit)) }
    }

    /// Adds the lowest three digits of `size` to the samples of a mask, or takes them away.
    #[inline(always)]
    pub(super) fn change(&mut self, mask: u64, size: u32, takes_away: bool) {
        let borrow = if takes_away { !0 } else { 0 };
        for bit in 0..3 {
            if size >> bit & 1 != 0 {
                self.ripple(mask, bit, borrow);
            }
        }
    }

    #[inline(always)]
    fn ripple(&mut self, mask: u64, first: usize, borrow: u64) {
        let mut carry = mask;
        for plane in &mut self.planes[first..] {
            if carry == 0 {
                break;
            }
            let digit = *plane ^ borrow;
            *plane ^= carry;
            carry &= digit;
        }
    }

    /// Samples whose counter is not 0.
    #[inline(always)]
    pub(super) fn nonzero(&self) -> u64 {
        self.planes.iter().enumerate().fold(0, |any, (bit, plane)| any | (plane ^ plane_of(ZERO, bit)))
    }

    /// The one value of all counters in `any`, which must not be empty.
    #[inline(always)]
    pub(super) fn single_value(&self, any: u64) -> Option<u32> {
        let mut value = 0u32;
        for (bit, plane) in self.planes.iter().enumerate() {
            let here = plane & any;
            if here == any {
                value |= 1 << bit;
            } else if here != 0 {
                return None;
            }
        }
        Some(value.wrapping_sub(ZERO) & LARGEST_COUNT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_count_like_integers() {
        let mut state = 7u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state ^ (state >> 29)).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        };
        for _ in 0..300 {
            let start = (next() % 9) as i32;
            let (mut counters, mut plain) = (Counters::at(start), [start; 64]);
            for _ in 0..next() % 200 {
                let (mask, size, down) = (next() & next(), (next() % 8) as u32, next() % 2 == 0);
                counters.change(mask, size, down);
                for (_, value) in plain.iter_mut().enumerate().filter(|(sample, _)| mask >> sample & 1 == 1) {
                    *value += if down { -(size as i32) } else { size as i32 };
                }
            }
            let modular = plain.map(|value| value as u32 & LARGEST_COUNT);
            for (sample, value) in modular.iter().enumerate() {
                assert_eq!(counters.nonzero() >> sample & 1 == 1, *value != 0);
                assert_eq!(counters.single_value(1 << sample), Some(*value));
            }
            let equal = modular.iter().all(|value| *value == modular[0]);
            assert_eq!(counters.single_value(!0), equal.then_some(modular[0]));
        }
    }
}
