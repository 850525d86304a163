//! Temperatures that no chamber runs in degC: degF, or codes that nobody scaled.

use super::Place;

/// Temperatures are counted in bins of 1 degC from here \[degC\] ...
const LOWEST_C: i32 = -100;

/// ... to here, which is all that a log may hold \[degC\].
const HIGHEST_C: i32 = 200;

/// Every so many rows one is counted.
const STEP: usize = 8;

/// Share of the rows that is left out at each end, for a sensor that was open or short for a time.
const LEFT_OUT: f64 = 0.05;

/// Parts run up to 85 degC, and heat themselves. Beyond this \[degC\] it is a military range ...
const HOT_C: f64 = 105.0;

/// ... which is run from -40 or -55 degC; so is a range from below this, ends left out \[degC\].
const COLD_C: f64 = -25.0;

/// A hot range that spans no more than this is an oven \[degC\].
const SPAN_C: f64 = 70.0;

/// No usual range ends above this \[degC\] ...
const HOTTEST_C: f64 = 135.0;

/// ... or begins below this \[degC\].
const COLDEST_C: f64 = -65.0;

/// Counts the temperatures.
#[derive(Clone, Debug)]
pub(super) struct Fahrenheit {
    bins: [u32; (HIGHEST_C - LOWEST_C + 1) as usize],
    rows: usize,
    from_s: f64,
    to_s: f64,
}

impl Fahrenheit {
    pub(super) const fn new(_axes: usize) -> Self {
        Self {
            bins: [0; (HIGHEST_C - LOWEST_C + 1) as usize],
            rows: 0,
            from_s: 0.0,
            to_s: 0.0,
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], _axes: &[&[f64]]) {
        let (Some(&first_s), Some(&last_s)) = (time_s.first(), time_s.last()) else {
            return;
        };
        if self.rows == 0 {
            self.from_s = first_s;
        }
        self.to_s = last_s;
        let to_pass = self.rows.next_multiple_of(STEP) - self.rows;
        self.rows += temp_c.len();
        let last = self.bins.len() - 1;
        for &temp_c in temp_c.iter().skip(to_pass).step_by(STEP) {
            // Below the lowest it saturates at 0.
            let bin = (temp_c - LOWEST_C as f32 + 0.5) as usize;
            self.bins[bin.min(last)] += 1;
        }
    }

    /// The temperature that a share of the rows does not exceed \[degC\].
    fn quantile_c(&self, share: f64) -> f64 {
        let wanted = share * self.rows.div_ceil(STEP) as f64;
        let mut rows = 0.0;
        let reached = self.bins.iter().position(|&count| {
            rows += f64::from(count);
            rows > wanted
        });
        f64::from(LOWEST_C) + reached.unwrap_or(0) as f64
    }

    pub(super) fn finish(self) -> Vec<Place> {
        let low_c = self.quantile_c(LEFT_OUT);
        let high_c = self.quantile_c(1.0 - LEFT_OUT);
        let is_military = low_c < COLD_C;
        let is_hot = high_c > HOT_C && high_c - low_c > SPAN_C && !is_military;
        let is_impossible = high_c > HOTTEST_C || low_c < COLDEST_C;
        if self.rows == 0 || !(is_hot || is_impossible) {
            return Vec::new();
        }
        let in_c = |temp_f: f64| (temp_f - 32.0) / 1.8;
        vec![Place {
            axis: None,
            rows: self.rows,
            from_s: self.from_s,
            to_s: self.to_s,
            detail: format!(
                "from {low_c:.0} to {high_c:.0}; if in degF, from {:.0} to {:.0} degC",
                in_c(low_c),
                in_c(high_c)
            ),
        }]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::made::{Made, Noise, rounded, up_and_down};

    fn found(log: &Made) -> Vec<Place> {
        let mut detector = Fahrenheit::new(0);
        log.parts(|time_s, temp_c, axes| detector.take(time_s, temp_c, axes));
        detector.finish()
    }

    fn chamber(range_c: (f64, f64), step_c: f64, scale: impl Fn(f64) -> f64) -> Made {
        let mut noise = Noise::new(1);
        Made::new(5000, 1.0, |share| {
            let temp_c = up_and_down(share, range_c.0, range_c.1) + 0.05 * noise.next();
            rounded(scale(temp_c), step_c)
        })
    }

    proptest! {
        #[test]
        fn degrees_fahrenheit_are_found(
            low_c in -25.0..5.0_f64,
            span_c in 50.0..100.0_f64,
            step_c in prop::sample::select(vec![0.0, 0.1, 1.0]),
        ) {
            let range_c = (low_c, (low_c + span_c).max(46.0));
            let found = found(&chamber(range_c, step_c, |t| 1.8 * t + 32.0));
            prop_assert_eq!(found.len(), 1);
            prop_assert_eq!((found[0].rows, found[0].from_s, found[0].to_s), (5000, 0.0, 4999.0));
        }

        #[test]
        fn usual_ranges_are_silent(
            low_c in -65.0..25.0_f64,
            high_c in 30.0..=100.0_f64,
            step_c in prop::sample::select(vec![0.0, 0.0625, 1.0]),
            open_rows in 0_usize..200,
        ) {
            let mut log = chamber((low_c, high_c), step_c, |t| t);
            prop_assert_eq!(found(&log), []);
            // A sensor that is open, then short.
            log.temp_c[2000..2000 + open_rows].fill(199.0);
            log.temp_c[3000..3000 + open_rows].fill(-99.0);
            prop_assert_eq!(found(&log), []);
        }
    }

    #[test]
    fn military_ranges_and_ovens_are_silent() {
        for range_c in [(-55.0, 125.0), (-40.0, 125.0), (60.0, 125.0)] {
            assert_eq!(found(&chamber(range_c, 0.0, |t| t)), []);
        }
    }

    #[test]
    fn codes_are_found() {
        // Half degrees, and a sensor without its offset.
        for (scale, offset) in [(2.0, 0.0), (1.0, -60.0)] {
            let codes = chamber((-20.0, 80.0), 0.0, |t| scale * t + offset);
            assert_eq!(found(&codes).len(), 1);
        }
    }

    #[test]
    fn a_log_without_rows_is_silent() {
        assert_eq!(Fahrenheit::new(0).finish(), []);
    }
}
