//! Sets of light samples: one for all receivers, or several, of which every receiver takes one by its place in the call.
//!
//! Forest et al. 2008, section 5. One set shows its pattern in penumbrae; a set of its own for each receiver turns the pattern into noise;
//! pixels side by side whose sets make up one larger set can be averaged (Keller and Heidrich 2001). The paper turns one pattern by an
//! angle per pixel; a turned rectangle is no rectangle, so sets are prepared instead: each is stratified, and within any shape of light.

use crate::error::SceneError;
use crate::light_samples::{Cells, SamplePattern, hash2, progressive_order, sobol, splitmix, unit_square};

/// The most samples of all sets that interleave: as long as the Sobol sequence is.
pub const MAX_INTERLEAVED: u32 = 1 << 16;

/// Samples of all decorrelated sets, as far as the bounds on their number allow: they fit one uniform buffer, two a row.
const DECORRELATED_SAMPLES: u32 = 8192;
/// Fewer sets would come back so often that a receiver shares its set with a neighbour.
const FEWEST_SETS: u32 = 16;
/// More would be made for each pass without being told apart.
const MOST_SETS: u32 = 256;

/// Which receivers share a set of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SampleSpread {
    /// All of them.
    #[default]
    Correlated,
    /// Each takes one of many sets, drawn by its index.
    Decorrelated,
    /// Each pixel of a square has a set of its own; together they are one stratified set.
    Interleaved,
}

/// How a light is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LightSampling {
    /// Pattern in the unit square.
    pub pattern: SamplePattern,
    /// Samples of one set.
    pub count: u32,
    /// Which sets.
    pub seed: u32,
    /// Who shares them.
    pub spread: SampleSpread,
    /// Side of the square of pixels that interleaves, where anything does.
    pub tile: u32,
}

impl LightSampling {
    /// One set for all receivers.
    #[must_use]
    pub fn correlated(pattern: SamplePattern, count: u32, seed: u32) -> Self {
        Self { pattern, count, seed, spread: SampleSpread::Correlated, tile: 1 }
    }

    /// How many sets there are.
    #[must_use]
    pub fn sets(&self) -> u32 {
        match self.spread {
            SampleSpread::Correlated => 1,
            SampleSpread::Decorrelated => (DECORRELATED_SAMPLES / self.count.max(1)).clamp(FEWEST_SETS, MOST_SETS),
            SampleSpread::Interleaved => self.tile.saturating_mul(self.tile),
        }
    }

    /// Samples of all sets.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.sets().saturating_mul(self.count)
    }

    /// The set of the receiver with this index in the call. `row` is the width of the image whose pixels they are.
    ///
    /// The twin of `first_sample` in `shaders_wgsl/shared/samples.wgsl`.
    #[must_use]
    pub fn set_of(&self, index: u32, row: u32) -> u32 {
        match self.spread {
            SampleSpread::Correlated => 0,
            SampleSpread::Decorrelated => mixed(index) % self.sets(),
            SampleSpread::Interleaved => {
                let row = row.max(1);
                index % row % self.tile + self.tile * (index / row % self.tile)
            }
        }
    }

    /// The points of all sets in the unit square, set after set, each in progressive order.
    ///
    /// # Errors
    /// As [`unit_square`], and for more than [`MAX_INTERLEAVED`] samples that interleave.
    pub fn squares(&self) -> Result<Vec<[f64; 2]>, SceneError> {
        match self.spread {
            SampleSpread::Correlated => unit_square(self.pattern, self.count, self.seed),
            SampleSpread::Decorrelated => {
                // Nothing is set aside for a count that the first set refuses.
                let mut all = Vec::new();
                for set in 0..self.sets() {
                    all.extend(unit_square(self.pattern, self.count, set_seed(self.seed, set))?);
                }
                Ok(all)
            }
            SampleSpread::Interleaved => {
                if self.count == 0 || self.total() > MAX_INTERLEAVED || self.tile == 0 {
                    let reason = format!("of all sets must lie between 1 and {MAX_INTERLEAVED}, got {}", self.total());
                    return Err(SceneError::invalid("interleaved samples", reason));
                }
                Ok(match self.pattern {
                    SamplePattern::Stratified => self.interleaved_cells(),
                    // Consecutive runs of the sequence are spread out each, and all of them are one longer run.
                    SamplePattern::LowDiscrepancy => (0..self.total()).map(|at| sobol(at, self.seed)).collect(),
                })
            }
        }
    }

    /// Each of a set's cells is cut into as many parts as there are sets, which are dealt out anew in every cell: a set alone is jittered,
    /// and all sets together hold one sample in each part.
    fn interleaved_cells(&self) -> Vec<[f64; 2]> {
        let (cells, sets, side) = (Cells::new(self.count), self.sets(), f64::from(self.tile));
        let order = progressive_order(&cells, self.count);
        let dealt: Vec<Vec<u32>> = (0..self.count).map(|cell| shuffled(sets, self.seed, cell)).collect();
        let place = |set: u32, cell: u32| {
            let part = dealt[cell as usize][set as usize];
            let jitter = hash2(cell * sets + part, self.seed);
            let within = [f64::from(part % self.tile) + jitter[0], f64::from(part / self.tile) + jitter[1]];
            cells.jittered(cell, within.map(|x| x / side))
        };
        let place = &place;
        (0..sets).flat_map(|set| order.iter().map(move |cell| place(set, *cell))).collect()
    }
}

/// The numbers below `count` in an order drawn for this cell.
fn shuffled(count: u32, seed: u32, cell: u32) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count).collect();
    for last in (1..count).rev() {
        // Not the numbers that jitter.
        let drawn = splitmix(splitmix(u64::from(seed) << 32 | u64::from(cell)) ^ u64::from(last) << 48);
        order.swap(last as usize, (drawn % u64::from(last + 1)) as usize);
    }
    order
}

/// The seed of a decorrelated set: the first has the pass's own, and none that of another pass.
fn set_seed(seed: u32, set: u32) -> u32 {
    if set == 0 {
        return seed;
    }
    (splitmix(!(u64::from(seed) << 32 | u64::from(set))) >> 32) as u32
}

/// A number whose every bit depends on every bit of the index (Wellons' lowbias32).
fn mixed(index: u32) -> u32 {
    let mut x = index;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn sampling(spread: SampleSpread, pattern: SamplePattern, count: u32, tile: u32) -> LightSampling {
        LightSampling { pattern, count, seed: 3, spread, tile }
    }

    /// Cells of a grid that hold exactly one point.
    fn singly_held(points: &[[f64; 2]], [columns, rows]: [u32; 2]) -> usize {
        let mut held = vec![0; (columns * rows) as usize];
        for p in points {
            held[(p[1] * f64::from(rows)) as usize * columns as usize + (p[0] * f64::from(columns)) as usize] += 1;
        }
        held.iter().filter(|n| **n == 1).count()
    }

    #[test]
    fn interleaved_sets_are_stratified_alone_and_together() {
        for (count, [columns, rows]) in [(16, [4, 4]), (32, [8, 4]), (64, [8, 8]), (128, [16, 8]), (256, [16, 16])] {
            for pattern in [SamplePattern::Stratified, SamplePattern::LowDiscrepancy] {
                for tile in [2, 4, 8] {
                    let sampling = sampling(SampleSpread::Interleaved, pattern, count, tile);
                    let all = sampling.squares().unwrap();
                    assert_eq!(all.len() as u32, sampling.total());
                    for set in all.chunks_exact(count as usize) {
                        assert_eq!(singly_held(set, [columns, rows]) as u32, count, "{pattern:?} {count} {tile}");
                    }
                    assert_eq!(singly_held(&all, [tile * columns, tile * rows]) as u32, count * tile * tile);
                }
            }
        }
        // A side that is no power of two, and a count without a grid.
        let odd = sampling(SampleSpread::Interleaved, SamplePattern::Stratified, 64, 5).squares().unwrap();
        assert_eq!(singly_held(&odd, [40, 40]), 1600);
        let ragged = sampling(SampleSpread::Interleaved, SamplePattern::Stratified, 37, 3).squares().unwrap();
        assert!(ragged.len() == 37 * 9 && ragged.iter().flatten().all(|x| (0.0..1.0).contains(x)));
        // The measure sees sets that are not made for each other.
        let apart = sampling(SampleSpread::Decorrelated, SamplePattern::Stratified, 64, 4).squares().unwrap();
        assert!(singly_held(&apart[..64 * 16], [32, 32]) < 500);
    }

    #[test]
    fn decorrelated_sets_are_stratified_and_their_own() {
        for pattern in [SamplePattern::Stratified, SamplePattern::LowDiscrepancy] {
            for (count, sets) in [(1, 256), (16, 256), (64, 128), (256, 32), (32_768, 16)] {
                let sampling = sampling(SampleSpread::Decorrelated, pattern, count, 4);
                assert_eq!(sampling.sets(), sets);
                let all = sampling.squares().unwrap();
                let firsts: BTreeSet<[u64; 2]> =
                    all.iter().step_by(count as usize).map(|p| p.map(f64::to_bits)).collect();
                assert_eq!(firsts.len() as u32, sets, "no set comes twice");
                if count == 64 {
                    assert!(all.chunks_exact(64).all(|set| singly_held(set, [8, 8]) == 64));
                    assert_eq!(all[..64], unit_square(pattern, 64, 3).unwrap(), "the first is the correlated one");
                }
            }
        }
    }

    #[test]
    fn receivers_take_sets_evenly_and_neighbours_different_ones() {
        let drawn = sampling(SampleSpread::Decorrelated, SamplePattern::Stratified, 64, 4);
        let mut taken = vec![0; drawn.sets() as usize];
        (0..128_000).for_each(|index| taken[drawn.set_of(index, 512) as usize] += 1);
        // Of 1000 expected, six standard deviations are 190.
        assert!(taken.iter().all(|n| (810..1190).contains(n)), "{taken:?}");
        let same = (0..128_000).filter(|n| drawn.set_of(*n, 512) == drawn.set_of(n + 1, 512)).count();
        assert!((810..1190).contains(&same), "neighbours are as strange to each other as any two: {same}");

        let square = sampling(SampleSpread::Interleaved, SamplePattern::Stratified, 16, 4);
        for (left, top) in [(0, 0), (3, 1), (9, 6)] {
            let sets: BTreeSet<u32> = (0..16).map(|n| square.set_of(13 * (top + n / 4) + left + n % 4, 13)).collect();
            assert_eq!(sets, (0..16).collect(), "any square of pixels has each set once");
        }
        assert!((0..99).all(|n| LightSampling::correlated(SamplePattern::Stratified, 4, 0).set_of(n, 9) == 0));
    }

    #[test]
    fn more_than_interleave_are_refused() {
        let of =
            |count, tile| sampling(SampleSpread::Interleaved, SamplePattern::LowDiscrepancy, count, tile).squares();
        assert!(of(1024, 8).is_ok() && of(1025, 8).is_err() && of(0, 4).is_err() && of(4, 0).is_err());
        assert!(of(u32::MAX, u32::MAX).is_err());
    }
}
