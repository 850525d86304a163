//! The part of a log that has rows at a constant interval.

use super::{AllanPoint, AllanSums};

/// Allan deviations of several series over the longest run of rows without a gap, row after row.
///
/// An interval of less than half of the usual one or more than one and a half times as much ends a
/// run.
#[derive(Clone, Debug)]
pub struct LongestStretch {
    /// The usual interval \[s\].
    interval_s: f64,
    rows: usize,
    first_s: f64,
    last_s: f64,
    series: Vec<AllanSums>,
    longest: Stretch,
}

/// A run of rows without a gap.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Rows.
    pub rows: usize,
    /// Mean interval between them \[s\].
    pub interval_s: f64,
    /// The deviations of each series.
    pub curves: Vec<Vec<AllanPoint>>,
}

impl LongestStretch {
    /// Of a log whose rows are `interval_s` apart, with so many series.
    pub fn new(interval_s: f64, series: usize) -> Self {
        Self {
            interval_s,
            rows: 0,
            first_s: 0.0,
            last_s: 0.0,
            series: vec![AllanSums::default(); series],
            longest: Stretch {
                rows: 0,
                interval_s,
                curves: vec![Vec::new(); series],
            },
        }
    }

    /// Takes the next row: its time \[s\], and the value of each series.
    pub fn push(&mut self, time_s: f64, values: impl Iterator<Item = f64>) {
        let regular = (0.5 * self.interval_s)..=(1.5 * self.interval_s);
        if self.rows > 0 && !regular.contains(&(time_s - self.last_s)) {
            self.close();
        }
        if self.rows == 0 {
            self.first_s = time_s;
        }
        self.rows += 1;
        self.last_s = time_s;
        for (series, value) in self.series.iter_mut().zip(values) {
            series.add(value);
        }
    }

    /// Ends the run of rows.
    fn close(&mut self) {
        let none = vec![AllanSums::default(); self.series.len()];
        let series = std::mem::replace(&mut self.series, none);
        let rows = std::mem::take(&mut self.rows);
        if rows <= self.longest.rows {
            return;
        }
        let interval_s = match rows {
            1 => self.interval_s,
            _ => (self.last_s - self.first_s) / (rows - 1) as f64,
        };
        let curves = series.into_iter().map(|sums| sums.finish(interval_s));
        self.longest = Stretch {
            rows,
            interval_s,
            curves: curves.collect(),
        };
    }

    /// The longest run, the first of equally long ones.
    pub fn finish(mut self) -> Stretch {
        self.close();
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allan::overlapping;

    #[test]
    fn gaps_end_a_stretch_and_jitter_does_not() {
        let times_s = [
            0.0, 1.0, 2.4, 3.0, 5.0, 6.0, 6.2, 7.0, 8.0, 9.0, 9.9, 11.0, 20.0, 21.0,
        ];
        let mut stretches = LongestStretch::new(1.0, 2);
        for time_s in times_s {
            stretches.push(time_s, [time_s * time_s, 1.0].into_iter());
        }
        let longest = stretches.finish();
        assert_eq!((longest.rows, longest.interval_s), (6, 4.8 / 5.0));
        let values = times_s[6..12].iter().map(|time_s| time_s * time_s);
        assert_eq!(longest.curves[0], overlapping(values, 4.8 / 5.0));
        assert!(longest.curves[1].iter().all(|point| point.deviation == 0.0));
    }

    #[test]
    fn a_log_without_rows_has_no_deviations() {
        let longest = LongestStretch::new(1.0, 1).finish();
        assert_eq!((longest.rows, longest.curves[0].len()), (0, 0));
        let mut single = LongestStretch::new(2.0, 1);
        single.push(3.0, [1.0].into_iter());
        let longest = single.finish();
        assert_eq!((longest.rows, longest.interval_s), (1, 2.0));
    }
}
