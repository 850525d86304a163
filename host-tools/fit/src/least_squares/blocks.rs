//! The kept blocks of a channel: the rows of every least squares.

use std::ops::Range;

use tempco::{TableError, Thermal, ThermalPoint, ThermalSettings};
use tempco_log::median::median;
use tempco_set::run::{is_usable, with_every_rate};

use crate::summary::{ChannelData, SamplePoint};

/// Time before and after, between which the slow rate is \[s\].
const BESIDE_S: f64 = 300.0;

/// Block means of a channel. Constants per log and axis are taken out, so that sums of squares
/// keep their digits.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    pub(crate) blocks: Vec<Block>,
    /// Temperature \[degC\].
    pub(crate) temp_c: Vec<f64>,
    /// For each axis, the mean of its rows less the steps in the log and the mean over it.
    pub(crate) raw: Vec<Vec<f64>>,
    /// For each log and axis, the mean that was taken out.
    pub(crate) log_means: Vec<Vec<f64>>,
    /// For each log and axis, how far its constant bias is from the mean of the logs.
    constants: Vec<Vec<f64>>,
    /// The usual time from block to block \[s\].
    step_s: f64,
}

/// A stretch of a log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) log: usize,
    /// Time of the block's middle \[s\].
    pub(crate) time_s: f64,
    /// Position in the summary of the log.
    pub(crate) position: usize,
    /// Number of rows that are kept, at least 1.
    pub(crate) weight: f64,
}

impl Blocks {
    /// Means of the kept rows; a block without any is left out.
    pub(crate) fn new(data: &ChannelData) -> Self {
        let mut blocks = Vec::new();
        let mut temp_c = Vec::new();
        let mut raw = vec![Vec::new(); data.axes()];
        for (log, position, block) in data.blocks() {
            blocks.push(Block {
                log,
                time_s: 0.5 * (block.from_s + block.to_s),
                position,
                weight: block.moments.rows as f64,
            });
            temp_c.push(block.moments.temp_c);
            for (axis, (raw, spread)) in raw.iter_mut().zip(&block.moments.axes).enumerate() {
                raw.push(spread.mean - data.offset(log, position, axis));
            }
        }
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
            step_s: usual_step_s(&blocks),
            blocks,
            temp_c,
            raw,
            log_means,
            constants: data.constants.clone(),
        }
    }

    /// Blocks of values that are about the means of their logs already.
    #[cfg(test)]
    pub(crate) fn of_values(blocks: Vec<Block>, temp_c: Vec<f64>, raw: Vec<Vec<f64>>) -> Self {
        let logs = 1 + blocks.iter().map(|block| block.log).max().unwrap_or(0);
        let zeros = vec![vec![0.0; raw.len()]; logs];
        Self {
            step_s: usual_step_s(&blocks),
            blocks,
            temp_c,
            raw,
            log_means: zeros.clone(),
            constants: zeros,
        }
    }

    /// Value of an axis in a block, less only the steps in its log and the constant bias of it.
    pub(crate) fn levelled(&self, axis: usize, block: usize) -> f64 {
        let log = self.blocks[block].log;
        self.raw[axis][block] + self.log_means[log][axis] - self.constants[log][axis]
    }

    /// Mean of an axis: of the means of the logs \[unit of the axis\].
    pub(crate) fn mean(&self, axis: usize) -> f64 {
        let means = self.log_means.iter().map(|means| means[axis]);
        means.sum::<f64>() / self.logs() as f64
    }

    /// From the first to the last block of the longest log \[s\].
    pub(crate) fn longest_log_s(&self) -> f64 {
        let logs = self.blocks.chunk_by(|a, b| a.log == b.log);
        let lengths = logs.map(|log| log[log.len() - 1].time_s - log[0].time_s);
        lengths.fold(0.0, f64::max)
    }

    /// Some stretches of the blocks, as if each were a log of its own.
    pub(crate) fn stretches(&self, of: &[Range<usize>]) -> Self {
        let numbers = of.iter().cloned().enumerate();
        let blocks = numbers.flat_map(|(log, range)| {
            let block = move |block: &Block| Block {
                log,
                ..block.clone()
            };
            self.blocks[range].iter().map(block)
        });
        let only = |values: &Vec<f64>| -> Vec<f64> {
            let parts = of.iter().map(|range| &values[range.clone()]);
            parts.flatten().copied().collect()
        };
        Self {
            blocks: blocks.collect(),
            temp_c: only(&self.temp_c),
            raw: self.raw.iter().map(only).collect(),
            log_means: vec![vec![0.0; self.axes()]; of.len()],
            constants: vec![vec![0.0; self.axes()]; of.len()],
            step_s: self.step_s,
        }
    }

    /// The usual time from block to block \[s\].
    pub(crate) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Blocks in some time, one at least.
    pub(crate) fn steps_in(&self, time_s: f64) -> usize {
        ((time_s / self.step_s).round() as usize).max(1)
    }

    /// Mean number of rows of a block.
    pub(crate) fn usual_weight(&self) -> f64 {
        let total: f64 = self.blocks.iter().map(|block| block.weight).sum();
        total / self.blocks.len() as f64
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
        let points = SamplePoints::new(
            data,
            &with_every_rate(ThermalSettings {
                tau_s: tau_s as f32,
                kappa: 0.0,
                ..*settings
            })?,
        );
        let mean = |block: &Block| {
            let (mut sum, mut rows) = (0.0, 0.0);
            for kept in points.of_block(block) {
                sum += kept.rows * f64::from(kept.point.rate_c_per_min);
                rows += kept.rows;
            }
            sum / rows
        };
        Ok(self.blocks.iter().map(mean).collect())
    }

    /// The rate of temperature over some minutes, between the means before and after each block:
    /// by it a coarse sensor too tells soaks from ramps \[degC/min\].
    pub(crate) fn slow_rates(&self) -> Vec<f64> {
        let mean = |range: Range<usize>, of: &dyn Fn(usize) -> f64| {
            let count = range.len() as f64;
            range.map(of).sum::<f64>() / count
        };
        let beside = self.steps_in(BESIDE_S);
        let mut rates = Vec::with_capacity(self.blocks.len());
        for log in self.blocks.chunk_by(|a, b| a.log == b.log) {
            let first = rates.len();
            for at in first..first + log.len() {
                let before = at.saturating_sub(beside).max(first)..at + 1;
                let after = at..(at + 1 + beside).min(first + log.len());
                let between =
                    |of: &dyn Fn(usize) -> f64| mean(after.clone(), of) - mean(before.clone(), of);
                let apart_s = between(&|i| self.blocks[i].time_s);
                let moved_c = between(&|i| self.temp_c[i]);
                rates.push(if apart_s > 0.0 {
                    60.0 * moved_c / apart_s
                } else {
                    0.0
                });
            }
        }
        rates
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

fn usual_step_s(blocks: &[Block]) -> f64 {
    let pairs = blocks.windows(2).filter(|pair| pair[0].log == pair[1].log);
    let mut steps_s: Vec<f64> = pairs.map(|pair| pair[1].time_s - pair[0].time_s).collect();
    if steps_s.is_empty() {
        1.0
    } else {
        median(&mut steps_s)
    }
}

/// A sample that enters a fit.
pub(crate) struct Kept {
    /// Its number in the log.
    pub(crate) sample: usize,
    pub(crate) point: ThermalPoint,
    /// How many rows of it are kept.
    pub(crate) rows: f64,
}

/// The core's points at the samples of all logs.
pub(crate) struct SamplePoints<'a> {
    data: &'a ChannelData<'a>,
    of_log: Vec<Vec<SamplePoint>>,
}

impl<'a> SamplePoints<'a> {
    pub(crate) fn new(data: &'a ChannelData, thermal: &Thermal) -> Self {
        let logs = 0..data.logs.len();
        Self {
            data,
            of_log: logs.map(|log| data.of(log).points(thermal)).collect(),
        }
    }

    /// The points of a log, sample by sample.
    pub(crate) fn of_log(&self, log: usize) -> &[SamplePoint] {
        &self.of_log[log]
    }

    pub(crate) fn logs(&self) -> usize {
        self.of_log.len()
    }

    /// The samples of a block that are kept: not those that the settings make unusable, unless
    /// that leaves none.
    pub(crate) fn of_block(&self, block: &Block) -> impl Iterator<Item = Kept> {
        let samples = &self.data.of(block.log).blocks[block.position].samples;
        let points = &self.of_log[block.log][samples.clone()];
        let is_kept = |point: &SamplePoint| point.kept > 0.0 && is_usable(&point.point);
        let any = points.iter().any(is_kept);
        let kept = samples
            .clone()
            .zip(points)
            .filter(move |(_, p)| p.kept > 0.0 && (!any || is_kept(p)));
        kept.map(|(sample, point)| Kept {
            sample,
            point: point.point,
            rows: point.kept,
        })
    }
}
