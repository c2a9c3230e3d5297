//! Samples that stand still, the same for all receivers: looked up, and those near a border tested.

use fearless_simd::{Simd, prelude::*};

use super::super::coverage::Crossing;
use super::super::coverage_table::{CoverageTable, cells_of_direction, cells_of_line};
use super::super::lists::{lanes_of, samples_of};
use super::{GROUP, Samples, is_below};
use crate::kernels::lanes::Vec3x8;

pub(super) struct Standing {
    samples: [[f32; 2]; GROUP as usize],
    table: CoverageTable,
}

impl Standing {
    /// From the words of `GroupSamples` and `CoverageTable`.
    pub(super) fn new(group_samples: &[u32], coverage_table: &[u32]) -> Self {
        let sample = |k: usize| [0, 1].map(|axis| f32::from_bits(group_samples[4 * k + axis]));
        Self { samples: std::array::from_fn(sample), table: CoverageTable::new(coverage_table) }
    }
}

impl<S: Simd> Samples<S> for Standing {
    #[inline(always)]
    fn crossed(&self, simd: S, crossing: &Crossing<S>, lanes: u32, mut found: impl FnMut(usize, u64)) {
        let begins = cells_of_direction(simd, crossing.from);
        let ends = cells_of_direction(simd, crossing.to);
        let lines = cells_of_line(simd, crossing.line);
        for k in lanes_of(lanes) {
            let begin = self.table.direction(begins[k]);
            let end = self.table.direction(ends[k]);
            let possible = (begin.surely | begin.maybe) & !end.surely;
            if possible == 0 {
                found(k, 0);
                continue;
            }
            let line = self.table.line(lines[k]);
            let line_possible = line.surely | line.maybe;
            let (beyond, beyond_possible) = if crossing.beyond_left.test(k) {
                (!line_possible, !line.surely)
            } else {
                (line.surely, line_possible)
            };
            let mut mask = begin.surely & !(end.surely | end.maybe) & beyond;
            let open = possible & beyond_possible & !mask;
            if open != 0 {
                let one = crossing.lane(k);
                for sample in samples_of(open) {
                    mask |= u64::from(one.crosses(self.samples[sample])) << sample;
                }
            }
            found(k, mask);
        }
    }

    #[inline(always)]
    fn below(&self, simd: S, slope: Vec3x8<S>, lane: usize) -> u64 {
        let above = self.table.line(cells_of_line(simd, slope)[lane]);
        let of_lane = slope.lane(lane);
        let below = |sample: &usize| is_below(of_lane, self.samples[*sample]);
        let near: u64 = samples_of(above.maybe).filter(below).map(|sample| 1 << sample).sum();
        !(above.surely | above.maybe) | near
    }
}
