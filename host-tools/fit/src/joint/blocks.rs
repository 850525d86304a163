//! Means over blocks of ten seconds: the rows of the search for a model.

use std::ops::Range;

use tempco::{TableError, ThermalSettings};

use crate::regress::{ChannelData, points_of, with_every_rate};

/// Length of a block \[s\]: short against every time constant of a thermal model, long enough to
/// make a day a matter of some thousand rows.
const BLOCK_S: f64 = 10.0;

/// Block means of a channel. Constants per log and axis are taken out, so that sums of squares
/// keep their digits.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    pub(crate) blocks: Vec<Block>,
    /// Temperature \[degC\].
    pub(crate) temp_c: Vec<f64>,
    /// For each axis, the mean of its rows less the mean over the log.
    pub(crate) raw: Vec<Vec<f64>>,
    /// For each log and axis, the mean that was taken out.
    pub(crate) log_means: Vec<Vec<f64>>,
    /// For each log and axis, how far its constant bias is from the mean of the logs.
    constants: Vec<Vec<f64>>,
}

/// A stretch of a log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) log: usize,
    /// Time of the block's middle \[s\].
    pub(crate) time_s: f64,
    /// Rows, kept or not.
    pub(crate) rows: Range<usize>,
    /// Number of rows that are kept, at least 1.
    pub(crate) weight: f64,
}

/// The rows of each block of one log; consecutive, not empty.
pub(crate) fn block_rows(time_s: &[f64], interval_s: f64) -> Vec<Range<usize>> {
    let number = |row: usize| ((time_s[row] - time_s[0] + 0.5 * interval_s) / BLOCK_S).floor();
    let mut blocks = Vec::new();
    let mut start = 0;
    for row in 1..=time_s.len() {
        if row == time_s.len() || number(row) != number(start) {
            blocks.push(start..row);
            start = row;
        }
    }
    blocks
}

impl Blocks {
    /// Means of the kept rows; a block without any is left out.
    pub(crate) fn new(data: &ChannelData) -> Self {
        let mut blocks = Vec::new();
        for (number, log) in data.logs.iter().enumerate() {
            for rows in block_rows(&log.time_s, log.interval_s) {
                let kept = data.keep[number][rows.clone()].iter().filter(|&&k| k);
                let weight = kept.count() as f64;
                if weight > 0.0 {
                    blocks.push(Block {
                        log: number,
                        time_s: 0.5 * (log.time_s[rows.start] + log.time_s[rows.end - 1]),
                        rows,
                        weight,
                    });
                }
            }
        }
        let temps_c = mean_of_kept(data, &blocks, |log, row| {
            f64::from(data.logs[log].channels[data.channel].temp_c[row])
        });
        let mut raw: Vec<Vec<f64>> = (0..data.axes())
            .map(|axis| {
                mean_of_kept(data, &blocks, |log, row| {
                    data.logs[log].channels[data.channel].axes[axis].raw[row]
                })
            })
            .collect();
        let mut log_means = vec![vec![0.0; data.axes()]; data.logs.len()];
        for (axis, raw) in raw.iter_mut().enumerate() {
            for (log, means) in log_means.iter_mut().enumerate() {
                let of_log = || blocks.iter().enumerate().filter(|(_, b)| b.log == log);
                let weight: f64 = of_log().map(|(_, b)| b.weight).sum();
                let total: f64 = of_log().map(|(i, b)| b.weight * raw[i]).sum();
                means[axis] = if weight > 0.0 { total / weight } else { 0.0 };
            }
            for (value, block) in raw.iter_mut().zip(&blocks) {
                *value -= log_means[block.log][axis];
            }
        }
        Self {
            blocks,
            temp_c: temps_c,
            raw,
            log_means,
            constants: data.constants.clone(),
        }
    }

    /// Value of an axis in a block, less only the constant bias of its log.
    pub(crate) fn levelled(&self, axis: usize, block: usize) -> f64 {
        let log = self.blocks[block].log;
        self.raw[axis][block] + self.log_means[log][axis] - self.constants[log][axis]
    }

    /// From the first to the last block of the longest log \[s\].
    pub(crate) fn longest_log_s(&self) -> f64 {
        let logs = self.blocks.chunk_by(|a, b| a.log == b.log);
        let lengths = logs.map(|log| log[log.len() - 1].time_s - log[0].time_s);
        lengths.fold(0.0, f64::max)
    }

    pub(crate) fn axes(&self) -> usize {
        self.raw.len()
    }

    pub(crate) fn logs(&self) -> usize {
        self.log_means.len()
    }

    /// The core's rate of temperature for a time constant \[degC/min\].
    ///
    /// # Errors
    /// Settings that the core refuses.
    pub(crate) fn rates(
        &self,
        data: &ChannelData,
        settings: &ThermalSettings,
        tau_s: f64,
    ) -> Result<Vec<f64>, TableError> {
        let thermal = with_every_rate(ThermalSettings {
            tau_s: tau_s as f32,
            kappa: 0.0,
            ..*settings
        })?;
        let points: Vec<_> = data
            .logs
            .iter()
            .map(|log| points_of(log, &log.channels[data.channel].temp_c, &thermal))
            .collect();
        Ok(mean_of_kept(data, &self.blocks, |log, row| {
            f64::from(points[log][row].rate_c_per_min)
        }))
    }

    /// Values of all axes in a block.
    pub(crate) fn observations(&self, block: usize) -> impl Iterator<Item = f64> {
        self.raw.iter().map(move |axis| axis[block])
    }

    /// Lowest and highest of a figure of the blocks.
    pub(crate) fn range(figures: &[f64]) -> (f64, f64) {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let wider = |(low, high): (f64, f64), &value: &f64| (low.min(value), high.max(value));
        figures.iter().fold(ends, wider)
    }
}

fn mean_of_kept(
    data: &ChannelData,
    blocks: &[Block],
    value: impl Fn(usize, usize) -> f64,
) -> Vec<f64> {
    let means = blocks.iter().map(|block| {
        let kept = &data.keep[block.log];
        let rows = block.rows.clone().filter(|&row| kept[row]);
        rows.map(|row| value(block.log, row)).sum::<f64>() / block.weight
    });
    means.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_ten_seconds_whatever_the_interval() {
        let time_s: Vec<f64> = (0..101).map(|i| 3.0 + 0.5 * f64::from(i)).collect();
        let blocks = block_rows(&time_s, 0.5);
        assert_eq!(blocks[0], 0..20);
        assert_eq!(blocks.len(), 6);
        assert_eq!(blocks[5], 100..101);
        let slow: Vec<f64> = (0..5).map(|i| 30.0 * f64::from(i)).collect();
        assert_eq!(block_rows(&slow, 30.0).len(), 5);
    }
}
