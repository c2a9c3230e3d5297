//! The twin of `depth_complexity/coverage_table.wgsl`: which of 64 samples lie left of a direction or a line, looked up.

use fearless_simd::{Simd, f32x8, i32x8, prelude::*};

use super::edge::Vec2x8;
use crate::kernels::lanes::{LANES, Vec3x8};

const DIRECTIONS: usize = 512;
const LINE_DIRECTIONS: usize = 64;
const LINE_DISTANCES: usize = 56;
const FARTHEST: f32 = 1.1;

/// What is smaller has no direction.
const TINY: f32 = 1e-30;

/// Which samples lie left of something: surely, or by a closer look.
#[derive(Clone, Copy)]
pub(super) struct Left {
    pub(super) surely: u64,
    pub(super) maybe: u64,
}

/// The cells, and behind them one for what has no direction: all samples need a closer look.
pub(super) struct CoverageTable {
    directions: Vec<Left>,
    lines: Vec<Left>,
}

impl CoverageTable {
    pub(super) fn new(words: &[u32]) -> Self {
        let pair = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        let left = |cell: &[u32]| Left { surely: pair(cell[0], cell[1]), maybe: pair(cell[2], cell[3]) };
        let cells = |words: &[u32]| -> Vec<Left> {
            let unsure = Left { surely: 0, maybe: !0 };
            words.chunks_exact(4).map(left).chain([unsure]).collect()
        };
        let (directions, lines) = words.split_at(4 * DIRECTIONS);
        Self { directions: cells(directions), lines: cells(lines) }
    }

    #[inline(always)]
    pub(super) fn direction(&self, cell: i32) -> Left {
        self.directions[cell as usize]
    }

    #[inline(always)]
    pub(super) fn line(&self, cell: i32) -> Left {
        self.lines[cell as usize]
    }
}

/// A number from 0 to 4 that grows with the angle of a vector; `size` is the sum of its sizes along the axes.
#[inline(always)]
fn turn_of<S: Simd>(simd: S, v: Vec2x8<S>, size: f32x8<S>) -> f32x8<S> {
    let q = v[1] / size.max(f32x8::splat(simd, 1e-37));
    v[0].simd_ge(0.0).select(1.0 + q, 3.0 - q)
}

/// A share of so many cells as one of them. Bounded before it becomes an integer: lanes that do not take part hold anything.
#[inline(always)]
fn cell<S: Simd>(simd: S, at: f32x8<S>, count: usize) -> i32x8<S> {
    at.max(f32x8::splat(simd, 0.0)).min(f32x8::splat(simd, (count - 1) as f32)).to_int()
}

#[inline(always)]
pub(super) fn cells_of_direction<S: Simd>(simd: S, v: Vec2x8<S>) -> [i32; LANES] {
    let size = v[0].abs() + v[1].abs();
    let found = cell(simd, turn_of(simd, v, size) * (DIRECTIONS as f32 / 4.0), DIRECTIONS);
    size.simd_gt(TINY).select(found, i32x8::splat(simd, DIRECTIONS as i32)).to_array()
}

#[inline(always)]
pub(super) fn cells_of_line<S: Simd>(simd: S, line: Vec3x8<S>) -> [i32; LANES] {
    let size = line.x.abs() + line.y.abs();
    let turn = turn_of(simd, [line.x, line.y], size);
    let direction = cell(simd, turn * (LINE_DIRECTIONS as f32 / 4.0), LINE_DIRECTIONS);
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let away = line.z / size.max(f32x8::splat(simd, 1e-37)) / (2.0 * FARTHEST);
    let share = (away + 0.5).max(zero).min(one);
    let distance = cell(simd, share * LINE_DISTANCES as f32, LINE_DISTANCES);
    let found = direction * i32x8::splat(simd, LINE_DISTANCES as i32) + distance;
    size.simd_gt(TINY).select(found, i32x8::splat(simd, (LINE_DIRECTIONS * LINE_DISTANCES) as i32)).to_array()
}
