//! Which rows of a stream belong together: without a gap, or to one averaging time.

use super::allan::AllanSums;

/// The longest run of rows without a gap, with the Allan sums of several series over it.
#[derive(Clone, Debug)]
pub(crate) struct LongestStretch {
    interval_s: f64,
    now: Stretch,
    longest: Stretch,
}

/// A run of rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stretch {
    pub(crate) rows: u64,
    first_s: f64,
    last_s: f64,
    pub(crate) series: Vec<AllanSums>,
}

impl LongestStretch {
    /// Rows `interval_s` apart, of `series` series.
    pub(crate) fn new(interval_s: f64, series: usize) -> Self {
        let empty = Stretch {
            series: vec![AllanSums::default(); series],
            ..Stretch::default()
        };
        Self {
            interval_s,
            now: empty.clone(),
            longest: empty,
        }
    }

    /// The stretch to which a row at `time_s` belongs. An interval of less than half of the usual
    /// one or more than one and a half times as much ends a stretch, as in
    /// [`longest_stretch`](tempco_evaluate::allan::longest_stretch).
    #[inline]
    pub(crate) fn at(&mut self, time_s: f64) -> &mut Stretch {
        let regular = (0.5 * self.interval_s)..=(1.5 * self.interval_s);
        if self.now.rows > 0 && !regular.contains(&(time_s - self.now.last_s)) {
            self.close();
        }
        let now = &mut self.now;
        if now.rows == 0 {
            now.first_s = time_s;
        }
        now.rows += 1;
        now.last_s = time_s;
        now
    }

    fn close(&mut self) {
        let empty = Stretch {
            series: vec![AllanSums::default(); self.now.series.len()],
            ..Stretch::default()
        };
        let ended = std::mem::replace(&mut self.now, empty);
        if ended.rows > self.longest.rows {
            self.longest = ended;
        }
    }

    /// The longest stretch, the first of equally long ones.
    pub(crate) fn longest(mut self) -> Stretch {
        self.close();
        self.longest
    }
}

impl Stretch {
    /// Mean interval between rows \[s\].
    pub(crate) fn interval_s(&self) -> f64 {
        (self.last_s - self.first_s) / self.rows.saturating_sub(1).max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_end_a_stretch_and_jitter_does_not() {
        let mut stretches = LongestStretch::new(1.0, 1);
        for time_s in [
            0.0, 1.0, 2.4, 3.0, 5.0, 6.0, 6.2, 7.0, 8.0, 9.0, 9.9, 11.0, 20.0, 21.0,
        ] {
            stretches.at(time_s).series[0].add(time_s);
        }
        let longest = stretches.longest();
        assert_eq!(
            (longest.rows, longest.first_s, longest.last_s),
            (6, 6.2, 11.0)
        );
        assert_eq!(longest.interval_s(), 4.8 / 5.0);
    }
}
