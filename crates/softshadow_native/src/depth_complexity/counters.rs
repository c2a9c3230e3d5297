//! One counter a sample, 64 samples at a time: bit k of all counters stands in one word, and adding to a set of samples is a ripple of
//! carries through a few words.
//!
//! Counters are 32-bit two's complement. Sums in between may leave that range or be negative, in any order of the edges: only the
//! final value has to fit, and no scene has 2^31 faces.

/// Bits of a counter.
const BITS: usize = 32;

/// Counters of `64·W` samples.
#[derive(Debug, Clone)]
pub struct Counters<const W: usize> {
    planes: [[u64; W]; BITS],
    /// Planes from here on equal the one below: sign bits that were not written out.
    used: usize,
}

impl<const W: usize> Counters<W> {
    /// All samples at one value.
    #[must_use]
    pub fn filled(value: i32) -> Self {
        let planes = std::array::from_fn(|bit| [if value >> bit & 1 == 1 { !0 } else { 0 }; W]);
        let equal_to_sign = if value < 0 { value.leading_ones() } else { value.leading_zeros() } as usize;
        Self { planes, used: BITS + 1 - equal_to_sign }
    }

    /// Adds to the samples of a mask.
    pub fn add(&mut self, mask: &[u64; W], amount: i32) {
        let magnitude = amount.unsigned_abs();
        for bit in 0..BITS {
            if magnitude >> bit & 1 == 1 {
                self.ripple(mask, bit, if amount < 0 { !0 } else { 0 });
            }
        }
    }

    /// Adds 2^bit, or takes it away when `borrow` is all ones: to take 1 from d is to add 1 to !d and to turn it round again.
    fn ripple(&mut self, mask: &[u64; W], bit: usize, borrow: u64) {
        self.grow(bit + 1);
        let mut carry = *mask;
        let mut plane = bit;
        while plane < self.used && carry != [0; W] {
            let is_sign = plane + 1 == self.used;
            if is_sign && (0..W).any(|w| carry[w] & !(self.planes[plane][w] ^ borrow) != 0) {
                // The sign is about to become a digit.
                self.grow(self.used + 1);
            }
            for (word, carried) in self.planes[plane].iter_mut().zip(&mut carry) {
                let digit = *word ^ borrow;
                *word = (digit ^ *carried) ^ borrow;
                *carried &= digit;
            }
            plane += 1;
        }
    }

    /// Writes the sign out into further planes.
    fn grow(&mut self, used: usize) {
        let used = used.min(BITS);
        for plane in self.used..used {
            self.planes[plane] = self.planes[plane - 1];
        }
        self.used = self.used.max(used);
    }

    /// Samples whose counter is not zero.
    #[must_use]
    pub fn nonzero(&self) -> [u64; W] {
        let mut any = [0; W];
        for plane in &self.planes[..self.used] {
            for (sum, word) in any.iter_mut().zip(plane) {
                *sum |= word;
            }
        }
        any
    }

    /// The one value that all nonzero counters of a mask have; `None` if they differ or if there is none.
    #[must_use]
    pub fn single_value(&self, mask: &[u64; W]) -> Option<i32> {
        let mut any = self.nonzero();
        any.iter_mut().zip(mask).for_each(|(word, m)| *word &= m);
        let mut value = 0u32;
        for (bit, plane) in self.planes[..self.used].iter().enumerate() {
            let here: [u64; W] = std::array::from_fn(|w| plane[w] & any[w]);
            if here == any {
                // The last plane stands for all above it.
                value |= if bit + 1 == self.used { u32::MAX << bit } else { 1 << bit };
            } else if here != [0; W] {
                return None;
            }
        }
        (any != [0; W]).then_some(value as i32)
    }

    /// One counter.
    #[must_use]
    pub fn value(&self, sample: usize) -> i32 {
        let digit = |plane: usize| (self.planes[plane.min(self.used - 1)][sample / 64] >> (sample % 64) & 1) as u32;
        (0..BITS).fold(0, |sum, plane| sum | digit(plane) << plane) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(seed: u64) -> impl FnMut() -> u64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state ^ (state >> 29)).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        }
    }

    #[test]
    fn counters_count_like_integers() {
        let mut next = numbers(7);
        for round in 0..400 {
            let start = (next() % 9) as i32 - 4;
            let mut counters = Counters::<2>::filled(start);
            let mut plain = [start; 128];
            for _ in 0..next() % 60 {
                let mask = [next() & next(), next() | next()];
                let size = if round % 5 == 0 { 100_000 } else { 5 };
                let amount = (next() % (2 * size)) as i32 - size as i32;
                counters.add(&mask, amount);
                for (sample, value) in plain.iter_mut().enumerate() {
                    *value += if mask[sample / 64] >> (sample % 64) & 1 == 1 { amount } else { 0 };
                }
            }
            let nonzero = counters.nonzero();
            for (sample, value) in plain.iter().enumerate() {
                assert_eq!(counters.value(sample), *value);
                assert_eq!(nonzero[sample / 64] >> (sample % 64) & 1 == 1, *value != 0);
            }
            let mut different: Vec<i32> = plain.iter().copied().filter(|v| *v != 0).collect();
            different.dedup();
            assert_eq!(counters.single_value(&[!0; 2]), (different.len() == 1).then(|| different[0]), "{different:?}");
        }
    }

    #[test]
    fn any_order_through_any_sign_ends_at_the_same_value() {
        let mask = [!0u64];
        for amounts in [[2, -1, -300, 299], [-300, 299, 2, -1], [299, 2, -1, -300]] {
            let mut counters = Counters::<1>::filled(0);
            amounts.iter().for_each(|a| counters.add(&mask, *a));
            assert_eq!(counters.nonzero(), [0]);
            assert_eq!(counters.single_value(&[!0; 1]), None);
        }
    }

    #[test]
    fn one_value_is_told_from_two() {
        let mut counters = Counters::<1>::filled(0);
        counters.add(&[0b0111], 2);
        assert_eq!(counters.single_value(&[!0; 1]), Some(2));
        counters.add(&[0b0100], 2);
        assert_eq!(counters.single_value(&[!0; 1]), None);
        let mut counters = Counters::<1>::filled(0);
        counters.add(&[0b1], -3);
        assert_eq!(counters.single_value(&[!0; 1]), Some(-3));
        assert_eq!(counters.single_value(&[0b10]), None, "none of these is hidden");
    }
}
