//! What is gathered of one log.

use tempco_evaluate::allan::LongestStretch;
use tempco_set::run::{Applied, AxisOutput};

use super::LogTimes;
use super::channel::ChannelSums;

/// Where a stretch of `tau` has less than this share of its rows, its mean is left out.
const LEAST_COVERAGE: f64 = 0.25;

/// One log, as far as its rows have come.
#[derive(Clone, Debug)]
pub(super) struct LogSums {
    pub(super) times: LogTimes,
    tau_s: f64,
    first_s: f64,
    /// Number of the stretch of `tau` that is summed up.
    stretch: f64,
    rows: f64,
    pub(super) channels: Vec<ChannelSums>,
    /// Raw and compensated of every axis.
    pub(super) allan: LongestStretch,
}

impl LogSums {
    /// Nothing yet of a log with `axes` axes, whose means are over `tau_s`.
    pub(super) fn new(
        times: LogTimes,
        tau_s: f64,
        channels: Vec<ChannelSums>,
        axes: usize,
    ) -> Self {
        Self {
            times,
            tau_s,
            first_s: f64::NAN,
            stretch: 0.0,
            rows: 0.0,
            channels,
            allan: LongestStretch::new(times.interval_s, 2 * axes),
        }
    }

    pub(super) fn push(&mut self, applied: &Applied, row: usize, time_s: f64) {
        if self.first_s.is_nan() {
            self.first_s = time_s;
        }
        let since_s = time_s - self.first_s;
        // Half an interval later, so that the rounding of the times moves no row between stretches.
        let number = ((since_s + 0.5 * self.times.interval_s) / self.tau_s).floor();
        if number != self.stretch {
            self.close_stretch();
            self.stretch = number;
        }
        self.rows += 1.0;
        let both = |output: &AxisOutput| [output.raw[row], output.compensated[row]].map(f64::from);
        self.allan.push(time_s, applied.axes.iter().flat_map(both));
        let mut outputs = applied.axes.iter();
        for (channel, points) in self.channels.iter_mut().zip(&applied.points) {
            channel.push(&points[row], self.times.interval_s, since_s);
            for (axis, output) in channel.axes.iter_mut().zip(outputs.by_ref()) {
                let [raw, compensated] = both(output);
                axis.push(raw, compensated, since_s);
            }
        }
    }

    pub(super) fn close_stretch(&mut self) {
        let enough = self.rows >= (LEAST_COVERAGE * self.tau_s / self.times.interval_s).max(1.0);
        let middle_s = (self.stretch + 0.5) * self.tau_s;
        for channel in &mut self.channels {
            channel.close_stretch(enough.then_some(middle_s), self.rows);
        }
        self.rows = 0.0;
    }
}
