//! What the figures need of logs, gathered row by row in memory of a fixed size.
//!
//! ```text
//! rows -+-> means over tau -+-> by time, temperature, rate (bins: number, sum, extremes)
//!       +-> extremes by time
//!       +-> Allan sums over the longest stretch without a gap
//!       +-> time spent by temperature and rate
//! ```

mod axis;
mod bins;
mod channel;
mod log_sums;
mod spread;

use tempco_set::CoefficientSet;
use tempco_set::run::Applied;

pub(crate) use axis::{Direction, GatheredAxis};
pub(crate) use channel::{GatheredChannel, Map};
pub(crate) use spread::Spread;

use channel::ChannelSums;
use log_sums::LogSums;

/// Means that a log is to show at least, if its rows allow.
const LEAST_MEANS: f64 = 200.0;

/// The most bins along the time of a log.
const MOST_TIMES: usize = 320;

/// A log, as far as the figures must know it beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogTimes {
    /// Median time between rows \[s\].
    pub interval_s: f64,
    /// Time from the first row to the last \[s\].
    pub duration_s: f64,
}

/// Gathers what the figures show, from the rows of one log after the other.
#[derive(Clone, Debug)]
pub struct Gatherer {
    tau_s: f64,
    logs: Vec<LogSums>,
    times: Vec<LogTimes>,
    channels: Vec<ChannelSums>,
    axes: usize,
}

/// Everything that is drawn.
#[derive(Clone, Debug)]
pub(crate) struct Gathered {
    /// Averaging time of what is shown \[s\].
    pub(crate) tau_s: f64,
    /// Begin of each log on a common axis of time, logs one after the other \[h\].
    pub(crate) starts_h: Vec<f64>,
    pub(crate) channels: Vec<GatheredChannel>,
    /// In the order of the set.
    pub(crate) axes: Vec<GatheredAxis>,
}

impl Gatherer {
    /// For `set` and its logs, in the order in which their rows will come. `tau_s` is the averaging
    /// time, which is shortened where the logs would have fewer than 200 means.
    pub fn new(set: &CoefficientSet, tau_s: f64, logs: &[LogTimes]) -> Self {
        let duration_s: f64 = logs.iter().map(|log| log.duration_s).sum();
        let longest_s = logs.iter().map(|log| log.interval_s).fold(0.0, f64::max);
        let tau_s = tau_s.min(duration_s / LEAST_MEANS).max(longest_s);
        let channels = set.channels.iter();
        Self {
            tau_s,
            logs: Vec::new(),
            times: logs.to_vec(),
            channels: channels.map(|c| ChannelSums::new(c, tau_s)).collect(),
            axes: set.axes().count(),
        }
    }

    /// The rows that follow are of the next log.
    ///
    /// # Panics
    /// If there is no further log.
    pub fn begin_log(&mut self) {
        let times = self.times[self.logs.len()];
        let log = LogSums::new(times, self.tau_s, self.channels.clone(), self.axes);
        self.logs.push(log);
    }

    /// Takes the next rows of a log, with their times \[s\].
    ///
    /// # Panics
    /// If no log was begun.
    pub fn push(&mut self, time_s: &[f64], applied: &Applied) {
        let log = self.logs.last_mut().expect("a log that was begun");
        for (row, &time_s) in time_s.iter().enumerate() {
            log.push(applied, row, time_s);
        }
    }

    /// Puts the logs together.
    pub(crate) fn finish(self) -> Gathered {
        let mut gathered = Gathered {
            tau_s: self.tau_s,
            starts_h: Vec::new(),
            channels: Vec::new(),
            axes: Vec::new(),
        };
        let mut start_h = 0.0;
        for mut log in self.logs {
            log.close_stretch();
            gathered.starts_h.push(start_h);
            let stretch = log.allan.finish();
            let mut curves = stretch.curves.into_iter();
            let mut next = || {
                let mut curve = curves.next().unwrap_or_default();
                // A logarithm has no place for it.
                curve.retain(|point| point.deviation > 0.0);
                curve
            };
            let mut number = 0;
            for (position, channel) in log.channels.into_iter().enumerate() {
                let (shown, axes) = channel.finish(start_h);
                match gathered.channels.get_mut(position) {
                    Some(so_far) => so_far.append(shown),
                    None => gathered.channels.push(shown),
                }
                for axis in axes {
                    let shown = axis.finish(start_h, stretch.rows, [next(), next()]);
                    match gathered.axes.get_mut(number) {
                        Some(so_far) => so_far.append(shown),
                        None => gathered.axes.push(shown),
                    }
                    number += 1;
                }
            }
            start_h += (log.times.duration_s + log.times.interval_s) / 3600.0;
        }
        gathered
    }
}

#[cfg(test)]
mod tests {
    use tempco::{Status, ThermalPoint};
    use tempco_fit::{FitOptions, fit};
    use tempco_log::{Axis, AxisUnit, Channel, Log, SkippedRows};
    use tempco_set::Model;
    use tempco_set::run::AxisOutput;

    use super::*;

    const ROWS: usize = 300_000;
    const SPIKE: usize = 123_456;

    fn set() -> CoefficientSet {
        let temp_c: Vec<f32> = (0..5000).map(|i| 20.0 + 0.004 * i as f32).collect();
        let raw = temp_c.iter().map(|&t| 0.01 * f64::from(t)).collect();
        let log = Log {
            file: "log.csv".to_owned(),
            sha256: String::new(),
            time_s: (0..5000).map(f64::from).collect(),
            channels: vec![Channel {
                column: "temp_c".to_owned(),
                temp_c,
                axes: vec![Axis {
                    name: "x".to_owned(),
                    unit: AxisUnit::Dph,
                    raw,
                }],
            }],
            reading: tempco_log::Reading::default(),
            ignored_columns: Vec::new(),
            skipped_rows: SkippedRows::default(),
            interval_s: 1.0,
        };
        fit(&[log], &FitOptions::new("S1", Model::Static))
            .unwrap()
            .set
    }

    /// Rows of a ramp, 0.1 s apart: a bias of 1, of which 0.25 remains; once 9 remains.
    fn applied(rows: std::ops::Range<usize>) -> Applied {
        let of = |bias: f32| {
            rows.clone()
                .map(|row| {
                    if row == SPIKE {
                        bias + 9.0
                    } else {
                        bias + 0.25
                    }
                })
                .collect()
        };
        let points = rows.clone().map(|row| ThermalPoint {
            effective_c: 20.0 + 1e-4 * row as f32,
            rate_c_per_min: 0.06,
            ..ThermalPoint::default()
        });
        Applied {
            status: vec![Status::OK; rows.len()],
            points: vec![points.collect()],
            axes: vec![AxisOutput {
                raw: of(1.0),
                bias: vec![1.0; rows.len()],
                compensated: of(0.0),
            }],
        }
    }

    fn gathered(logs: usize, chunk: usize) -> Gathered {
        let duration_s = 0.1 * (ROWS - 1) as f64;
        let times = LogTimes {
            interval_s: 0.1,
            duration_s,
        };
        let mut gatherer = Gatherer::new(&set(), 100.0, &vec![times; logs]);
        for _ in 0..logs {
            gatherer.begin_log();
            for start in (0..ROWS).step_by(chunk) {
                let rows = start..(start + chunk).min(ROWS);
                let time_s: Vec<f64> = rows.clone().map(|row| 5.0 + 0.1 * row as f64).collect();
                gatherer.push(&time_s, &applied(rows));
            }
        }
        gatherer.finish()
    }

    #[test]
    fn a_single_row_is_not_lost_and_constants_are() {
        let gathered = gathered(1, 1 << 14);
        let axis = &gathered.axes[0];
        assert!(axis.rows.len() <= MOST_TIMES && axis.means.len() <= MOST_TIMES);
        let (at_h, extreme) = axis
            .rows
            .iter()
            .max_by(|a, b| a.1.max.total_cmp(&b.1.max))
            .unwrap();
        assert!((extreme.max - 8.75).abs() < 1e-3, "{extreme:?}");
        assert!((at_h - 0.1 * SPIKE as f64 / 3600.0).abs() < 0.02);
        let means = axis.means.iter().map(|(_, [_, after])| after.max);
        assert!((means.fold(0.0, f64::max) - 8.75 / 1000.0).abs() < 1e-4);
        for (_, places) in axis.by_temp.iter() {
            let place = places[Direction::Heating as usize];
            assert!((place.bias.mean().unwrap() - 1.0).abs() < 1e-12);
            assert!(place.residual.mean().unwrap().abs() < 1e-3);
            assert_eq!(places[Direction::Cooling as usize].bias.n, 0.0);
        }
    }

    #[test]
    fn all_time_is_on_the_map_and_logs_follow_each_other() {
        let gathered = gathered(2, 50_000);
        let whole_s: f64 = gathered.channels[0].map.time_s.values().sum();
        assert!((whole_s - 0.2 * ROWS as f64).abs() < 1e-3, "{whole_s}");
        let start_h = 0.1 * ROWS as f64 / 3600.0;
        assert_eq!(gathered.starts_h.len(), 2);
        assert!((gathered.starts_h[1] - start_h).abs() < 1e-9);
        let axis = &gathered.axes[0];
        let last_h = axis.means.last().unwrap().0;
        assert!((1.9 * start_h..2.0 * start_h).contains(&last_h), "{last_h}");
        let n: f64 = axis.by_temp.iter().map(|(_, p)| p[2].bias.n).sum();
        assert_eq!(n, 2.0 * ROWS as f64 / 1000.0);
        assert_eq!(axis.allan_rows, ROWS);
    }

    #[test]
    fn the_size_of_chunks_does_not_matter() {
        let (a, b) = (gathered(1, 999), gathered(1, 77_777));
        assert_eq!(a.axes[0].means, b.axes[0].means);
        assert_eq!(a.axes[0].rows, b.axes[0].rows);
        assert_eq!(a.axes[0].allan, b.axes[0].allan);
        assert_eq!(a.channels[0].temps_c, b.channels[0].temps_c);
    }
}
