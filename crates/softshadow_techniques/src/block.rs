//! Blocks of receivers: whole rows of an image or runs of points that fit a memory limit together.

/// A run of receivers, with the rows around it that its results depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// First receiver that is computed.
    pub first: usize,
    /// How many are computed.
    pub count: usize,
    /// How many of them stand before the first one that is kept.
    pub skip: usize,
    /// How many are kept.
    pub keep: usize,
}

/// Cuts `count` receivers in rows of `row` into blocks of at most `most` receivers, but at least one row, each with
/// `halo` rows around it. Results do not depend on `most`.
#[must_use]
pub fn blocks(count: usize, row: usize, halo: usize, most: usize) -> Vec<Block> {
    let (row, rows) = (row.max(1), count / row.max(1));
    let kept_rows = (most / row).saturating_sub(2 * halo).max(1);
    (0..rows)
        .step_by(kept_rows)
        .map(|start| {
            let end = (start + kept_rows).min(rows);
            let (low, high) = (start.saturating_sub(halo), (end + halo).min(rows));
            Block { first: low * row, count: (high - low) * row, skip: (start - low) * row, keep: (end - start) * row }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_keep_every_receiver_once_and_stay_within_the_limit() {
        for (count, row, halo, most) in [(64 * 48, 64, 1, 640), (1000, 1, 0, 77), (64 * 48, 64, 0, 10), (0, 1, 0, 5)] {
            let mut next = 0;
            for block in blocks(count, row, halo, most) {
                assert_eq!(block.first + block.skip, next);
                assert!(block.count <= most.max((1 + 2 * halo) * row));
                assert!(block.first + block.count <= count && block.skip + block.keep <= block.count);
                let has_halo_above = block.first == 0 || block.skip == halo * row;
                assert!(has_halo_above);
                next += block.keep;
            }
            assert_eq!(next, count);
        }
    }
}
