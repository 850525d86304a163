//! Means over consecutive stretches of time, and their spread.

use tempco_log::Log;

/// A stretch of `tau` counts where at least this share of its rows is there; loggers drop rows.
const LEAST_COVERAGE: f64 = 0.25;

/// Means over stretches of `tau`, and the mean over the log.
pub(crate) struct Means {
    pub(crate) means: Vec<f64>,
    pub(crate) mean: f64,
}

impl Means {
    /// Means of a column of a compensated log.
    pub(crate) fn of_f32(log: &Log, values: &[f32], tau_s: f64) -> Self {
        let values = values.iter().map(|&value| f64::from(value));
        Self::new(&log.time_s, log.interval_s, values, tau_s)
    }

    /// Stretches begin at the first row and follow each other in time; one with too few rows is
    /// left out.
    pub(crate) fn new(
        time_s: &[f64],
        interval_s: f64,
        values: impl Iterator<Item = f64>,
        tau_s: f64,
    ) -> Self {
        let least_rows = (LEAST_COVERAGE * tau_s / interval_s).max(1.0);
        let first_s = time_s.first().copied().unwrap_or_default();
        let mut means = Vec::new();
        let (mut stretch, mut sum, mut rows) = (0.0, 0.0, 0_u32);
        let mut total = 0.0;
        let mut close = |sum: &mut f64, rows: &mut u32| {
            if f64::from(*rows) >= least_rows {
                means.push(*sum / f64::from(*rows));
            }
            (*sum, *rows) = (0.0, 0);
        };
        for (&time_s, value) in time_s.iter().zip(values) {
            // Half an interval later, so that the rounding of the times moves no row between
            // stretches.
            let number = ((time_s - first_s + 0.5 * interval_s) / tau_s).floor();
            if number != stretch {
                close(&mut sum, &mut rows);
                stretch = number;
            }
            sum += value;
            total += value;
            rows += 1;
        }
        close(&mut sum, &mut rows);
        Self {
            means,
            mean: total / time_s.len() as f64,
        }
    }

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

    #[test]
    fn means_and_their_figures_are_those_of_the_definition() {
        let time_s: Vec<f64> = (0..12).map(|i| 5.0 + 0.1 * f64::from(i)).collect();
        let values = [1, 1, 1, 1, 3, 3, 3, 3, 8, 8, 8, 8].map(f64::from);
        let means = Means::new(&time_s, 0.1, values.into_iter(), 0.4);
        assert_eq!(means.means, [1.0, 3.0, 8.0]);
        assert_eq!(means.mean, 4.0);
        assert!((means.sigma() - 13.0_f64.sqrt()).abs() < 1e-12);
        assert!((means.rmse() - (26.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(means.max_abs(), 4.0);
    }

    #[test]
    fn a_stretch_with_few_rows_does_not_count() {
        let time_s = [0.0, 1.0, 2.0, 3.0, 4.0, 9.0, 11.0, 12.0, 13.0, 14.0, 15.0];
        let values = [1.0, 1.0, 1.0, 1.0, 9.0, 4.0, 6.0, 2.0, 2.0, 2.0, 2.0];
        let means = Means::new(&time_s, 1.0, values.into_iter(), 8.0);
        assert_eq!(means.means, [13.0 / 5.0, 18.0 / 6.0]);
        let means = Means::new(&time_s, 1.0, values.into_iter(), 5.0);
        assert_eq!(means.means, [13.0 / 5.0, 12.0 / 4.0]);
        let means = Means::new(&time_s, 0.2, values.into_iter(), 5.0);
        assert_eq!(means.means, [] as [f64; 0]);
    }
}
