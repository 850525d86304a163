//! Means over consecutive stretches of time, and their spread.

/// A stretch of `tau` counts where at least this share of its rows is there; loggers drop rows.
const LEAST_COVERAGE: f64 = 0.25;

/// Means of several series over stretches of `tau`, as the rows of a log come.
///
/// Stretches begin at the first row and follow each other in time; one with too few rows is left
/// out.
#[derive(Clone, Debug)]
pub(crate) struct Stretches {
    tau_s: f64,
    interval_s: f64,
    least_rows: f64,
    /// Time of the first row \[s\].
    first_s: Option<f64>,
    /// Number of the stretch that is summed up, and its rows so far.
    number: f64,
    rows: u32,
    rows_of_log: f64,
    series: Vec<Series>,
}

#[derive(Clone, Debug, Default)]
struct Series {
    sum: f64,
    total: f64,
    means: Vec<f64>,
}

impl Stretches {
    /// Of so many series, in a log whose rows are `interval_s` apart.
    pub(crate) fn new(series: usize, interval_s: f64, tau_s: f64) -> Self {
        Self {
            tau_s,
            interval_s,
            least_rows: (LEAST_COVERAGE * tau_s / interval_s).max(1.0),
            first_s: None,
            number: 0.0,
            rows: 0,
            rows_of_log: 0.0,
            series: vec![Series::default(); series],
        }
    }

    /// Takes the next rows: their times \[s\], and the value of a series in a row.
    pub(crate) fn push(&mut self, time_s: &[f64], value: impl Fn(usize, usize) -> f64) {
        let Some(&first_s) = time_s.first() else {
            return;
        };
        let first_s = *self.first_s.get_or_insert(first_s);
        // Half an interval later, so that the rounding of the times moves no row between stretches.
        let (tau_s, half_s) = (self.tau_s, 0.5 * self.interval_s);
        let number = |row: usize| ((time_s[row] - first_s + half_s) / tau_s).floor();
        let mut start = 0;
        while start < time_s.len() {
            let of_start = number(start);
            let rows = (start..time_s.len()).take_while(|&row| number(row) == of_start);
            let end = start + rows.count();
            if of_start != self.number {
                self.close();
                self.number = of_start;
            }
            for (position, series) in self.series.iter_mut().enumerate() {
                for row in start..end {
                    let value = value(position, row);
                    series.sum += value;
                    series.total += value;
                }
            }
            self.rows += (end - start) as u32;
            self.rows_of_log += (end - start) as f64;
            start = end;
        }
    }

    /// Ends a stretch.
    fn close(&mut self) {
        let rows = f64::from(std::mem::take(&mut self.rows));
        for series in &mut self.series {
            let sum = std::mem::take(&mut series.sum);
            if rows >= self.least_rows {
                series.means.push(sum / rows);
            }
        }
    }

    /// The means of each series.
    pub(crate) fn finish(mut self) -> Vec<Means> {
        self.close();
        let means = |series: Series| Means {
            means: series.means,
            mean: series.total / self.rows_of_log,
        };
        self.series.into_iter().map(means).collect()
    }
}

/// Means over stretches of `tau`, and the mean over the log.
#[derive(Clone, Debug)]
pub(crate) struct Means {
    pub(crate) means: Vec<f64>,
    pub(crate) mean: f64,
}

impl Means {
    /// Sample standard deviation of the means.
    pub(crate) fn sigma(&self) -> f64 {
        let n = self.means.len() as f64;
        let mean = self.means.iter().sum::<f64>() / n;
        let squares: f64 = self.means.iter().map(|v| (v - mean).powi(2)).sum();
        (squares / (n - 1.0)).sqrt()
    }

    /// Root mean square of the means about the mean of the log.
    pub(crate) fn rmse(&self) -> f64 {
        let squares: f64 = self.means.iter().map(|v| (v - self.mean).powi(2)).sum();
        (squares / self.means.len() as f64).sqrt()
    }

    /// Largest deviation of a mean from the mean of the log.
    pub(crate) fn max_abs(&self) -> f64 {
        let deviations = self.means.iter().map(|v| (v - self.mean).abs());
        deviations.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a log that comes in parts of so many rows.
    fn means(time_s: &[f64], interval_s: f64, values: &[f64], tau_s: f64, rows: usize) -> Means {
        let mut stretches = Stretches::new(1, interval_s, tau_s);
        for (time_s, values) in time_s.chunks(rows).zip(values.chunks(rows)) {
            stretches.push(time_s, |_, row| values[row]);
        }
        stretches.finish().remove(0)
    }

    #[test]
    fn means_and_their_figures_are_those_of_the_definition() {
        let time_s: Vec<f64> = (0..12).map(|i| 5.0 + 0.1 * f64::from(i)).collect();
        let values = [1, 1, 1, 1, 3, 3, 3, 3, 8, 8, 8, 8].map(f64::from);
        for rows in [1, 5, 12] {
            let means = means(&time_s, 0.1, &values, 0.4, rows);
            assert_eq!(means.means, [1.0, 3.0, 8.0]);
            assert_eq!(means.mean, 4.0);
            assert!((means.sigma() - 13.0_f64.sqrt()).abs() < 1e-12);
            assert!((means.rmse() - (26.0_f64 / 3.0).sqrt()).abs() < 1e-12);
            assert_eq!(means.max_abs(), 4.0);
        }
    }

    #[test]
    fn a_stretch_with_few_rows_does_not_count() {
        let time_s = [0.0, 1.0, 2.0, 3.0, 4.0, 9.0, 11.0, 12.0, 13.0, 14.0, 15.0];
        let values = [1.0, 1.0, 1.0, 1.0, 9.0, 4.0, 6.0, 2.0, 2.0, 2.0, 2.0];
        for rows in [1, 3, 11] {
            let means = |interval_s, tau_s| means(&time_s, interval_s, &values, tau_s, rows).means;
            assert_eq!(means(1.0, 8.0), [13.0 / 5.0, 18.0 / 6.0]);
            assert_eq!(means(1.0, 5.0), [13.0 / 5.0, 12.0 / 4.0]);
            assert_eq!(means(0.2, 5.0), [] as [f64; 0]);
        }
    }
}
