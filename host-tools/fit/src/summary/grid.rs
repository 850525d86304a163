//! The blocks and samples of a channel on a grid of time that widens as the log goes on.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::summary::block::{Moments, Rows};

/// Samples in a block.
pub(crate) const SAMPLES_PER_BLOCK: u32 = 10;

/// With more blocks than this, neighbours merge.
pub(crate) const MOST_BLOCKS: usize = 1 << 14;

/// The kept rows of a stretch of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Block {
    /// Position on the grid.
    number: u64,
    /// Time of the first and the last row, kept or not \[s\].
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    pub(crate) moments: Moments,
    /// Its samples.
    pub(crate) samples: Range<usize>,
}

/// The mean temperature of a tenth of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    number: u64,
    /// Mean time of its rows \[s\].
    pub(crate) time_s: f64,
    /// Mean temperature of the rows that the core accepted, of all rows if it accepted none
    /// \[degC\].
    pub(crate) temp_c: f32,
    /// Rows of that mean.
    pub(crate) rows: u32,
    /// Rows that may enter a fit.
    pub(crate) kept: u32,
}

/// Takes in rows in the order of time.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Where the grid begins: half an interval before the first row, so that the rounding of the
    /// times moves no row between blocks \[s\].
    origin_s: f64,
    spacing_s: f64,
    most_blocks: usize,
    axes: usize,
    blocks: Vec<Block>,
    samples: Vec<Sample>,
}

impl Grid {
    pub(crate) fn new(axes: usize, origin_s: f64, block_s: f64, most_blocks: usize) -> Self {
        Self {
            origin_s,
            spacing_s: block_s / f64::from(SAMPLES_PER_BLOCK),
            most_blocks,
            axes,
            blocks: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// Takes in the next rows.
    pub(crate) fn take(&mut self, rows: &Rows) {
        let mut start = 0;
        while start < rows.len() {
            let number = ((rows.time_s[start] - self.origin_s) / self.spacing_s) as u64;
            let end_s = self.origin_s + (number as f64 + 1.0) * self.spacing_s;
            // One row always, whatever rounding made of its place.
            let others = &rows.time_s[start + 1..];
            let end = start + 1 + others.partition_point(|&time_s| time_s < end_s);
            self.add(number, rows, start..end);
            start = end;
        }
    }

    fn add(&mut self, number: u64, rows: &Rows, range: Range<usize>) {
        let sample = Sample::of(number, rows, range.clone());
        match self.samples.last_mut() {
            Some(last) if last.number == number => *last = last.merged(&sample),
            _ => self.samples.push(sample),
        }
        let number = number / u64::from(SAMPLES_PER_BLOCK);
        let is_new = self.blocks.last().is_none_or(|last| last.number != number);
        if is_new {
            self.blocks.push(Block {
                number,
                from_s: rows.time_s[range.start],
                to_s: 0.0,
                moments: Moments::none(self.axes),
                samples: 0..0,
            });
        }
        let block = self.blocks.last_mut().expect("just made");
        block.to_s = rows.time_s[range.end - 1];
        block.moments.merge(&rows.moments(range));
        if self.blocks.len() > self.most_blocks {
            self.widen();
        }
    }

    /// Makes blocks and samples twice as long.
    fn widen(&mut self) {
        self.spacing_s *= 2.0;
        for sample in &mut self.samples {
            sample.number /= 2;
        }
        self.samples.dedup_by(|next, sample| {
            let same = next.number == sample.number;
            if same {
                *sample = sample.merged(next);
            }
            same
        });
        for block in &mut self.blocks {
            block.number /= 2;
        }
        self.blocks.dedup_by(|next, block| {
            let same = next.number == block.number;
            if same {
                block.moments.merge(&next.moments);
                block.to_s = next.to_s;
            }
            same
        });
    }

    /// The blocks, the samples and the length of a block \[s\].
    pub(crate) fn finish(mut self) -> (Vec<Block>, Vec<Sample>, f64) {
        let mut at = 0;
        for block in &mut self.blocks {
            let of_block =
                |sample: &Sample| sample.number / u64::from(SAMPLES_PER_BLOCK) == block.number;
            let count = self.samples[at..]
                .iter()
                .take_while(|s| of_block(s))
                .count();
            block.samples = at..at + count;
            at += count;
        }
        let block_s = self.spacing_s * f64::from(SAMPLES_PER_BLOCK);
        (self.blocks, self.samples, block_s)
    }
}

impl Sample {
    fn of(number: u64, rows: &Rows, range: Range<usize>) -> Self {
        let accepted = &rows.accepted[range.clone()];
        let (times_s, temps_c) = (&rows.time_s[range.clone()], &rows.temp_c[range.clone()]);
        let count = accepted.iter().filter(|&&accepted| accepted).count();
        let (all, count) = match count {
            0 => (true, range.len()),
            _ => (count == range.len(), count),
        };
        let (mut temp_c, mut time_s) = (0.0, 0.0);
        for ((row_s, row_c), accepted) in times_s.iter().zip(temps_c).zip(accepted) {
            if all || *accepted {
                temp_c += f64::from(*row_c);
                time_s += row_s - times_s[0];
            }
        }
        Self {
            number,
            time_s: times_s[0] + time_s / count as f64,
            temp_c: (temp_c / count as f64) as f32,
            rows: count as u32,
            kept: rows.keep[range].iter().filter(|&&keep| keep).count() as u32,
        }
    }

    fn merged(&self, other: &Self) -> Self {
        let rows = self.rows + other.rows;
        let share = f64::from(other.rows) / f64::from(rows);
        let mean = |a: f64, b: f64| a + share * (b - a);
        Self {
            number: self.number,
            time_s: mean(self.time_s, other.time_s),
            temp_c: mean(self.temp_c.into(), other.temp_c.into()) as f32,
            rows,
            kept: self.kept + other.kept,
        }
    }
}
