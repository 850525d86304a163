//! Logs in parts that have a constant each: what leaps, and a gap, may change it.

use crate::least_squares::Blocks;
use crate::outliers::leaps::Leaps;

/// The blocks of a log.
pub(super) fn of_log(blocks: &Blocks, log: usize) -> std::ops::Range<usize> {
    let first = blocks.blocks.partition_point(|block| block.log < log);
    first..blocks.blocks.partition_point(|block| block.log <= log)
}

/// Parts of logs with a constant each. A log without steps is one part.
pub(super) struct Parts {
    /// Of each block, numbered through all logs.
    pub(super) of_block: Vec<usize>,
    /// Of each log, the part with most rows: its constant is the constant of the log.
    pub(super) of_log: Vec<usize>,
    pub(super) count: usize,
}

impl Parts {
    /// Of what leaps found in each log; without that, a part for each log.
    pub(super) fn new(blocks: &Blocks, leaps: &[Leaps]) -> Self {
        let mut of_block: Vec<usize> = Vec::with_capacity(blocks.blocks.len());
        for log in 0..blocks.logs() {
            let first = of_block.iter().max().map_or(0, |last| last + 1);
            match leaps.get(log) {
                Some(leaps) => of_block.extend(leaps.parts.iter().map(|part| first + part)),
                None => of_block.extend(of_log(blocks, log).map(|_| first)),
            }
        }
        Self::of(blocks, of_block)
    }

    pub(super) fn of(blocks: &Blocks, of_block: Vec<usize>) -> Self {
        let count = of_block.iter().max().map_or(0, |last| last + 1);
        let mut rows = vec![0.0; count];
        for (part, block) in of_block.iter().zip(&blocks.blocks) {
            rows[*part] += block.weight;
        }
        let home = |log: usize| {
            let parts = of_block[of_log(blocks, log)].iter().copied();
            parts
                .max_by(|&a, &b| rows[a].total_cmp(&rows[b]))
                .unwrap_or(0)
        };
        Self {
            of_log: (0..blocks.logs()).map(home).collect(),
            of_block,
            count,
        }
    }
}
