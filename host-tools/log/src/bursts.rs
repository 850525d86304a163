//! Loggers that read a buffer of rows and stamp them all at once.
//!
//! The rows were sampled at equal intervals before the stamp, and that is where they are put.

/// Stamps that the decision needs.
pub(super) const AHEAD: usize = 256;

/// Stamps closer than this share of the mean interval belong to one burst.
const TOGETHER: f64 = 0.2;

/// At least this share of all intervals is so short.
const SHARE: f64 = 0.5;

/// At least so many whole bursts are needed to know them.
const LEAST_BURSTS: usize = 8;

/// Periods and sizes of bursts lie within this share of their medians, from quarter to quarter.
const REGULAR: f64 = 0.3;

/// Bursts further apart than this many periods have a gap between them.
const GAP: f64 = 3.0;

/// Spreads the rows of each burst over the time since the burst before.
#[derive(Clone, Debug)]
pub(super) struct Bursts {
    /// Stamps that are this close belong to one burst \[s\].
    together_s: f64,
    /// Time from burst to burst \[s\].
    pub(super) period_s: f64,
    /// Stamp of the burst before \[s\].
    before_s: Option<f64>,
    pub(super) rows: usize,
}

impl Bursts {
    /// Whether stamps, the first of a log, come in bursts.
    pub(super) fn find(stamps_s: &[f64]) -> Option<Self> {
        let (first, last) = (stamps_s.first()?, stamps_s.last()?);
        let together_s = TOGETHER * (last - first) / (stamps_s.len() - 1) as f64;
        let is_short = |pair: &[f64]| (0.0..together_s).contains(&(pair[1] - pair[0]));
        let short = stamps_s.windows(2).filter(|pair| is_short(pair)).count();
        if (short as f64) < SHARE * (stamps_s.len() - 1) as f64 {
            return None;
        }
        // The first and the last burst may be cut.
        let starts: Vec<usize> = (1..stamps_s.len())
            .filter(|&row| !is_short(&stamps_s[row - 1..=row]))
            .collect();
        let pairs = || starts.windows(2);
        let sizes = pairs().map(|pair| (pair[1] - pair[0]) as f64).collect();
        let periods = pairs()
            .map(|pair| stamps_s[pair[1]] - stamps_s[pair[0]])
            .collect();
        if starts.len() <= LEAST_BURSTS {
            return None;
        }
        Some(Self {
            together_s,
            period_s: regular(periods)?,
            before_s: None,
            rows: regular(sizes)? as usize,
        })
    }

    /// Rows at the end whose burst may go on.
    pub(super) fn open_rows(&self, times_s: &[f64]) -> usize {
        self.burst(times_s.iter().rev().copied())
    }

    /// Length of the burst that a series of stamps begins with, forwards or backwards.
    fn burst(&self, mut times_s: impl Iterator<Item = f64>) -> usize {
        let Some(mut last) = times_s.next() else {
            return 0;
        };
        let mut is_one = |time_s: &f64| {
            let step = (time_s - last).abs();
            last = *time_s;
            step < self.together_s
        };
        1 + times_s.take_while(|time_s| is_one(time_s)).count()
    }

    /// Spreads whole bursts.
    pub(super) fn spread(&mut self, times_s: &mut [f64]) {
        let mut rest = times_s;
        while !rest.is_empty() {
            let rows = self.burst(rest.iter().copied());
            let (burst, others) = rest.split_at_mut(rows);
            let stamp_s = burst[rows - 1];
            let usual_s = stamp_s - self.period_s;
            let before_s = match self.before_s {
                Some(before_s) if stamp_s - before_s < GAP * self.period_s => before_s,
                _ => usual_s,
            };
            for (row, time_s) in burst.iter_mut().enumerate() {
                let share = (row + 1) as f64 / rows as f64;
                *time_s = before_s + share * (stamp_s - before_s);
            }
            self.before_s = Some(stamp_s);
            rest = others;
        }
    }
}

/// The median of values that are nearly the same.
fn regular(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
    let median = at(0.5);
    (at(0.25) >= (1.0 - REGULAR) * median && at(0.75) <= (1.0 + REGULAR) * median).then_some(median)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn bursts_become_rows_at_equal_intervals(
            rows in 2_usize..40, period_s in 0.01_f64..10.0, apart in 0.0_f64..0.01,
        ) {
            let count = 256.max(12 * rows);
            let stamp = |i: usize| {
                let (burst, row) = (i / rows, i % rows);
                burst as f64 * period_s + row as f64 * apart * period_s / rows as f64
            };
            let mut times: Vec<f64> = (0..count).map(stamp).collect();
            let mut bursts = Bursts::find(&times).unwrap();
            prop_assert_eq!(bursts.rows, rows);
            bursts.spread(&mut times);
            let whole = count / rows * rows;
            for pair in times[..whole].windows(2) {
                let step = (pair[1] - pair[0]) * rows as f64 / period_s;
                prop_assert!((step - 1.0).abs() < 0.05, "{}", step);
            }
        }

        /// Rows at their own times, with jitter, and with rows or whole stretches missing.
        #[test]
        fn other_logs_have_no_bursts(
            jitter in 0.0_f64..0.7, lost in 0.0_f64..0.5, gaps in 0_u32..4, seed in any::<u32>(),
        ) {
            let mut state = seed | 1;
            let mut random = || {
                state ^= state << 13;
                state ^= state >> 17;
                state ^= state << 5;
                f64::from(state) / f64::from(u32::MAX)
            };
            let mut times = Vec::new();
            for row in 0_u32..600 {
                let gap = if row % 150 == 149 && row / 150 < gaps { 1e4 } else { 0.0 };
                let offset = times.last().map_or(0.0, |_| gap);
                let time_s = f64::from(row) + jitter * random() + offset;
                if random() >= lost {
                    times.push(time_s);
                }
            }
            times.sort_by(f64::total_cmp);
            prop_assert!(Bursts::find(&times[..AHEAD.min(times.len())]).is_none());
        }
    }
}
