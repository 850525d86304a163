//! Logs reduced to a fixed size in one pass: all that a fit needs of them.
//!
//! ```text
//! rows -> core -> outliers (excluded, unusable, spikes) -+-> blocks of 10 s: moments of regressors and axes
//!                                                      +-> samples of 1 s: mean temperatures
//! ```
//!
//! A summary holds 16,384 blocks at most, 45 h of 10 s each. With a
//! longer log, neighbours merge whenever there are more, and blocks and samples get twice as long:
//! memory does not depend on the length of the log.
//!
//! The blocks hold the regressors that the core computed row by row. For the settings that a fit
//! tries later, the core runs over the samples (`ChannelSummary::points`).

mod block;
mod channel;
mod channel_data;
mod file;
mod grid;
mod log;
mod signals;
#[cfg(test)]
mod tests;

pub(crate) use block::{Extremes, Moments, Rows};
pub(crate) use channel_data::{ChannelData, Offset};
pub use file::{SummaryError, is_summary, read_summary};
pub(crate) use grid::Block;
use grid::Sample;
pub use log::{summarise_file, summarise_log};

use serde::{Deserialize, Serialize};
use tempco::{Interval, Thermal, ThermalPoint, ThermalState};
use tempco_log::signals::Finding;
use tempco_log::{AxisUnit, Reading, SkippedRows};
use tempco_set::run::IntervalCache;

use crate::options::Plan;

/// A summarised log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSummary {
    pub(crate) plan: Plan,
    pub(crate) file: String,
    pub(crate) sha256: String,
    pub(crate) rows: usize,
    pub(crate) skipped_rows: SkippedRows,
    pub(crate) interval_s: f64,
    pub(crate) duration_s: f64,
    pub(crate) reading: Reading,
    pub(crate) ignored_columns: Vec<String>,
    /// What is wrong with its signals.
    pub(crate) findings: Vec<Finding>,
    pub(crate) channels: Vec<ChannelSummary>,
}

impl LogSummary {
    /// Name of the file, without its folders.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// By what it was summarised.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// SHA-256 of the log's bytes, in hexadecimal.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Median time between rows \[s\].
    pub fn interval_s(&self) -> f64 {
        self.interval_s
    }

    /// Time from the first row to the last \[s\].
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// How it was read.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Columns that were neither mapped nor recognised.
    pub fn ignored_columns(&self) -> &[String] {
        &self.ignored_columns
    }

    /// Rows left out on reading because skipping bad rows was asked for.
    pub fn skipped_rows(&self) -> SkippedRows {
        self.skipped_rows
    }
}

/// A summarised temperature with its axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChannelSummary {
    /// Name of the temperature column.
    pub(crate) column: String,
    pub(crate) axes: Vec<AxisName>,
    pub(crate) blocks: Vec<Block>,
    samples: Vec<Sample>,
    /// Length of a block \[s\].
    pub(crate) block_s: f64,
    /// For each axis the standard deviation of its rows' white noise \[unit of the axis\]; 0 if
    /// spikes were not looked for.
    pub(crate) white_sigmas: Vec<f64>,
    /// Rows whose temperature or interval was not accepted.
    pub(crate) unusable_rows: usize,
    /// Rows in excluded stretches.
    pub(crate) excluded_rows: usize,
    pub(crate) spike_rows: usize,
    /// By axis; empty if spikes were not looked for.
    pub(crate) spiked: Vec<Spiked>,
}

/// The spikes of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spiked {
    pub(crate) rows: usize,
    /// Time of the first and the last one \[s\].
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
}

/// An axis as it is called in the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AxisName {
    pub(crate) name: String,
    pub(crate) unit: AxisUnit,
}

/// The core's point at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SamplePoint {
    /// Since the sample before.
    pub(crate) interval: Interval,
    pub(crate) point: ThermalPoint,
    /// Rows that may enter a fit.
    pub(crate) kept: f64,
}

impl ChannelSummary {
    /// Runs the core over the samples, as if each were a row: the channel's lag-compensated
    /// temperature and rate under settings that are not the plan's.
    ///
    /// The delay of the core's rate is its time constant, whatever the interval, so that samples
    /// of many rows give the rates of these. Where a sample is one row, they are exactly the core's.
    pub(crate) fn points(&self, thermal: &Thermal) -> Vec<SamplePoint> {
        let Some(first) = self.samples.first() else {
            return Vec::new();
        };
        let mut state = ThermalState::new(thermal);
        state.start(thermal, first.temp_c);
        let mut intervals = IntervalCache::new(thermal, self.sample_s() as f32);
        let mut last_s = first.time_s - self.sample_s();
        let point = |sample: &Sample| {
            let interval = intervals.of(thermal, (sample.time_s - last_s) as f32);
            last_s = sample.time_s;
            state.drop_tiny();
            SamplePoint {
                interval,
                point: state.update(thermal, &interval, sample.temp_c),
                kept: sample.kept.into(),
            }
        };
        self.samples.iter().map(point).collect()
    }

    /// Temperatures of the samples of a block that hold rows to fit \[degC\].
    pub(crate) fn temps_c(&self, block: &Block) -> impl Iterator<Item = f32> {
        let samples = self.samples[block.samples.clone()].iter();
        samples
            .filter(|sample| sample.kept > 0)
            .map(|sample| sample.temp_c)
    }

    /// Mean of all temperatures of a block, accepted or not \[degC\].
    pub(crate) fn mean_c(&self, block: &Block) -> f64 {
        let samples = &self.samples[block.samples.clone()];
        let sum: f64 = samples.iter().map(|sample| f64::from(sample.temp_c)).sum();
        sum / samples.len() as f64
    }

    /// Length of a sample \[s\].
    fn sample_s(&self) -> f64 {
        self.block_s / f64::from(grid::SAMPLES_PER_BLOCK)
    }
}
