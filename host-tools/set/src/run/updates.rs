//! Which rows of a log are thermal updates.

use tempco_log::Log;

/// A unit samples its temperature ten times a second at most \[s\].
const LEAST_PERIOD_S: f64 = 0.1;

/// The time between two temperatures that a log is fitted with \[s\]: its row interval, or as many of
/// them as make 0.1 s.
pub fn thermal_period_s(interval_s: f64) -> f64 {
    rows_per_update(interval_s, LEAST_PERIOD_S) * interval_s
}

/// Rows from one update to the next, for a period that is not much shorter.
fn rows_per_update(interval_s: f64, period_s: f64) -> f64 {
    (period_s / interval_s - 0.01).ceil().max(1.0)
}

/// The rows at which the core takes a temperature: the last one of each thermal period, as a unit
/// samples it; every row of a log whose interval is no shorter. At the rows between, the bias is
/// the one of the row before.
#[derive(Clone, Copy, Debug)]
pub struct Updates {
    /// A row is an update if so much time has passed since the one before \[s\].
    least_s: f64,
    /// Time of the last update \[s\].
    last_s: f64,
}

impl Updates {
    /// Before the first row of a log, at `first_s`, whose rows are `interval_s` apart. The first row is
    /// an update.
    pub fn new(first_s: f64, interval_s: f64, period_s: f64) -> Self {
        let rows = rows_per_update(interval_s, period_s);
        Self {
            // Half a row earlier, so that neither jitter nor rounding skips one.
            least_s: if rows > 1.0 {
                (rows - 0.5) * interval_s
            } else {
                f64::NEG_INFINITY
            },
            last_s: first_s - rows * interval_s,
        }
    }

    /// Before the first row of a log in memory.
    pub fn of_log(log: &Log, period_s: f64) -> Self {
        let first_s = log.time_s.first().copied().unwrap_or(0.0);
        Self::new(first_s, log.interval_s, period_s)
    }

    /// For each of the next rows, what [`due`](Self::due) says of it.
    pub(super) fn of_rows(&mut self, time_s: &[f64]) -> Vec<Option<f32>> {
        time_s.iter().map(|&time_s| self.due(time_s)).collect()
    }

    /// The time since the last update \[s\], if the row at `time_s` is one.
    #[inline]
    pub fn due(&mut self, time_s: f64) -> Option<f32> {
        let since_s = time_s - self.last_s;
        if since_s < self.least_s {
            return None;
        }
        self.last_s = time_s;
        Some(since_s as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn updates(rate_hz: f64, period_s: f64, seconds: f64) -> Vec<(u32, f32)> {
        let interval_s = 1.0 / rate_hz;
        let mut updates = Updates::new(0.0, interval_s, period_s);
        let rows = (seconds * rate_hz) as u32;
        let due =
            (0..rows).filter_map(|row| Some((row, updates.due(f64::from(row) * interval_s)?)));
        due.collect()
    }

    #[test]
    fn a_fast_log_has_ten_updates_a_second_at_most() {
        for (rate_hz, rows) in [(11.0, 2), (20.0, 2), (50.0, 5), (100.0, 10), (2000.0, 200)] {
            let period_s = thermal_period_s(1.0 / rate_hz);
            let found = updates(rate_hz, period_s, 100.0);
            for ((row, dt_s), number) in found.iter().zip(0..) {
                assert_eq!(*row, rows * number, "{rate_hz} Hz");
                assert!((f64::from(*dt_s) - period_s).abs() < 1e-6, "{rate_hz} Hz");
            }
        }
    }

    #[test]
    fn every_row_of_a_slow_log_is_an_update() {
        for rate_hz in [0.1, 1.0, 2.0, 10.0] {
            let found = updates(rate_hz, thermal_period_s(1.0 / rate_hz), 100.0);
            assert_eq!(found.len(), (100.0 * rate_hz) as usize);
            assert_eq!(found[0].1, (1.0 / rate_hz) as f32);
        }
        // A set of a slow log: a fast log is thinned out.
        assert_eq!(updates(10.0, 1.0, 100.0).len(), 100);
    }
}
