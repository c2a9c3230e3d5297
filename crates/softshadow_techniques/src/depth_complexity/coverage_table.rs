//! Which of 64 samples lie left of a direction or a line, looked up instead of tested one by one (Forest et al., section 4.3, with a
//! table of angles in place of a cube map).
//!
//! Directions and lines fall into cells. A cell knows the samples that lie left of whatever is in it, and those that may: these are tested
//! where the table is exact. As published, the middle of a cell speaks for all of it.

use super::settings::Coverage;

/// Cells of directions from the reference point.
pub(super) const DIRECTIONS: usize = 512;
/// Cells of a line's direction.
pub(super) const LINE_DIRECTIONS: usize = 64;
/// Cells of a line's distance.
pub(super) const LINE_DISTANCES: usize = 56;
/// Distance of the last cells, which reach to infinity: samples lie within about 1.
const FARTHEST: f64 = 1.1;
/// Bytes of a table: the largest uniform that core WebGPU has.
pub(super) const TABLE_BYTES: u64 = 16 * (DIRECTIONS + LINE_DIRECTIONS * LINE_DISTANCES) as u64;

/// By how much a cell is widened, and how far off zero a sign is sure: both far above the rounding of float32.
const SLACK: f64 = 1e-5;

/// Two words of samples that lie left, and two of those that may.
type Entry = [u32; 4];

/// The table of up to 64 samples.
pub(super) fn coverage_table(samples: &[[f32; 2]], coverage: Coverage) -> Vec<Entry> {
    let samples: Vec<[f64; 2]> = samples.iter().map(|s| s.map(f64::from)).collect();
    let mut table = Vec::with_capacity(DIRECTIONS + LINE_DIRECTIONS * LINE_DISTANCES);
    let over = |turns: [f64; 4], height: fn([f64; 2], [f64; 2]) -> f64| -> Vec<[f64; 2]> {
        let ways = turns.map(direction);
        samples.iter().map(|s| bounds(ways.map(|way| height(way, *s)))).collect()
    };
    for cell in 0..DIRECTIONS {
        table
            .push(entry(&over(turns_of(cell, DIRECTIONS, coverage), |way, s| way[0] * s[1] - way[1] * s[0]), [0.0; 2]));
    }
    for cell in 0..LINE_DIRECTIONS {
        let along = over(turns_of(cell, LINE_DIRECTIONS, coverage), |way, s| way[0] * s[0] + way[1] * s[1]);
        table.extend((0..LINE_DISTANCES).map(|distance| entry(&along, distances_of(distance, coverage))));
    }
    table
}

/// The entry of a cell over which samples have heights within bounds, and these move by others.
fn entry(heights: &[[f64; 2]], [near, far]: [f64; 2]) -> Entry {
    let mut entry = [0; 4];
    for (at, [low, high]) in heights.iter().enumerate() {
        let (low, high) = (low + near, high + far);
        let (word, bit) = (at / 32, 1 << (at % 32));
        if low == high {
            // A cell of one point: it speaks for all.
            entry[word] |= if low >= 0.0 { bit } else { 0 };
        } else if low > SLACK {
            entry[word] |= bit;
        } else if high >= -SLACK {
            entry[word + 2] |= bit;
        }
    }
    entry
}

/// The ends of a cell of directions, within it and a little beyond: directions change linearly in between.
fn turns_of(cell: usize, cells: usize, coverage: Coverage) -> [f64; 4] {
    let [first, last] = [cell, cell + 1].map(|end| 4.0 * end as f64 / cells as f64);
    match coverage {
        Coverage::Exact => [first - SLACK, first, last, last + SLACK],
        Coverage::Table => [(first + last) * 0.5; 4],
    }
}

fn distances_of(cell: usize, coverage: Coverage) -> [f64; 2] {
    let at = |end: usize| (2.0 * end as f64 / LINE_DISTANCES as f64 - 1.0) * FARTHEST;
    let ends = [
        if cell == 0 { f64::NEG_INFINITY } else { at(cell) - SLACK },
        if cell + 1 == LINE_DISTANCES { f64::INFINITY } else { at(cell + 1) + SLACK },
    ];
    match coverage {
        Coverage::Exact => ends,
        Coverage::Table => [(at(cell) + at(cell + 1)) * 0.5; 2],
    }
}

/// The vector of a turn from 0 to 4: the twin of `turn_of`. Its sizes along the axes add up to 1.
fn direction(turn: f64) -> [f64; 2] {
    let turn = turn.rem_euclid(4.0);
    let (q, sign) = if turn <= 2.0 { (turn - 1.0, 1.0) } else { (3.0 - turn, -1.0) };
    [sign * (1.0 - q.abs()), q]
}

fn bounds(values: [f64; 4]) -> [f64; 2] {
    [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: [[f32; 2]; 3] = [[0.5, 0.1], [-0.9, 0.8], [0.0, -1.0]];

    fn turn(v: [f64; 2]) -> f64 {
        let q = v[1] / (v[0].abs() + v[1].abs());
        if v[0] >= 0.0 { 1.0 + q } else { 3.0 - q }
    }

    /// What an entry says of each sample: left, right, or not.
    fn words(entry: Entry) -> [Option<bool>; 3] {
        [0, 1, 2].map(|k| (entry[2] >> k & 1 == 0).then_some(entry[0] >> k & 1 == 1))
    }

    #[test]
    fn what_is_sure_is_true_everywhere_in_a_cell() {
        let exact = coverage_table(&SAMPLES, Coverage::Exact);
        let mut sure = 0;
        for step in 0..4000 {
            let angle = std::f64::consts::TAU * f64::from(step) / 4000.0;
            let v = [angle.cos(), angle.sin()];
            let found = words(exact[((turn(v) * DIRECTIONS as f64 / 4.0) as usize).min(DIRECTIONS - 1)]);
            for (said, s) in found.iter().zip(SAMPLES.map(|s| s.map(f64::from))) {
                assert!(said.is_none_or(|left| left == (v[0] * s[1] - v[1] * s[0] >= 0.0)), "{angle} {s:?}");
                sure += usize::from(said.is_some());
            }
            for away in 0..40 {
                let d = f64::from(away) * 0.1 - 2.0;
                let size = v[0].abs() + v[1].abs();
                let share = (d / size / (2.0 * FARTHEST) + 0.5).clamp(0.0, 1.0);
                let cell = ((turn(v) * LINE_DIRECTIONS as f64 / 4.0) as usize).min(LINE_DIRECTIONS - 1);
                let at = cell * LINE_DISTANCES + ((share * LINE_DISTANCES as f64) as usize).min(LINE_DISTANCES - 1);
                for (said, s) in words(exact[DIRECTIONS + at]).iter().zip(SAMPLES.map(|s| s.map(f64::from))) {
                    assert!(
                        said.is_none_or(|left| left == (v[0] * s[0] + v[1] * s[1] + d >= 0.0)),
                        "{angle} {d} {s:?}"
                    );
                    sure += usize::from(said.is_some());
                }
            }
        }
        assert!(sure * 10 > 9 * 4000 * 41 * 3, "{sure} answers are sure");
    }

    #[test]
    fn as_published_every_cell_has_one_answer() {
        let table = coverage_table(&SAMPLES, Coverage::Table);
        assert!(table.iter().all(|entry| entry[2..] == [0, 0]));
        let exact = coverage_table(&SAMPLES, Coverage::Exact);
        for (published, exact) in table.iter().zip(&exact) {
            assert_eq!(published[0] & !exact[2], exact[0] & !exact[2], "where the cell is sure they agree");
        }
    }

    #[test]
    fn a_turn_is_undone_by_its_direction() {
        for step in 0..400 {
            let at = f64::from(step) * 0.01;
            let [x, y] = direction(at);
            assert!((turn([x, y]) - at).abs() < 1e-12 && (x.abs() + y.abs() - 1.0).abs() < 1e-12, "{at}");
        }
    }
}
