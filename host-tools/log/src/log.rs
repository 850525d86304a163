//! A log in memory.

use crate::reading::Reading;
use crate::skipped::SkippedRows;
use crate::unit::AxisUnit;

/// A log whose every value was checked on reading.
#[derive(Clone, Debug)]
pub struct Log {
    /// Name of the file, without its folders.
    pub file: String,
    /// SHA-256 of the file's bytes, in hexadecimal.
    pub sha256: String,
    /// Time of each row \[s\], strictly increasing.
    pub time_s: Vec<f64>,
    /// The temperature channels: one for all axes, or one per group of axes.
    pub channels: Vec<Channel>,
    /// How it was read, where it is not a plain log.
    pub reading: Reading,
    /// Columns that were neither mapped nor recognised.
    pub ignored_columns: Vec<String>,
    /// Rows left out because skipping bad rows was asked for.
    pub skipped_rows: SkippedRows,
    /// Median time between rows \[s\].
    pub interval_s: f64,
}

/// A temperature and the axes it belongs to.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Name of the temperature column.
    pub column: String,
    /// Temperature of each row \[degC\], as the core sees it.
    pub temp_c: Vec<f32>,
    /// The axes.
    pub axes: Vec<Axis>,
}

/// One gyro or accelerometer axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name, such as `x` or `gx`.
    pub name: String,
    /// Unit of `raw`.
    pub unit: AxisUnit,
    /// Measured value of each row.
    pub raw: Vec<f64>,
}

impl Log {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// Time since the row before, for each row \[s\]; the first row gets the median interval.
    pub fn intervals_s(&self) -> impl Iterator<Item = f32> {
        let first = self.interval_s as f32;
        let others = self.time_s.windows(2).map(|t| (t[1] - t[0]) as f32);
        std::iter::once(first).chain(others)
    }

    /// Lowest and highest temperature of a channel \[degC\].
    pub fn temp_range_c(&self, channel: usize) -> (f32, f32) {
        let temps = &self.channels[channel].temp_c;
        temps
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &t| {
                (low.min(t), high.max(t))
            })
    }
}
