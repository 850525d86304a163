//! Figures of merit of a compensated log; each is of means over a stated time `tau`.

use serde::Serialize;

use crate::apply::Applied;
use crate::set::CoefficientSet;

/// A stretch of `tau` counts where at least this share of its rows is there; loggers drop rows.
const LEAST_COVERAGE: f64 = 0.25;

/// Figures of a log before and after compensation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Averaging time \[s\].
    pub tau_s: f64,
    /// The axes in the order of the set.
    pub axes: Vec<AxisEvaluation>,
    /// Largest jump of each axis's bias between neighbouring cells of its table, at zero, lowest
    /// and highest rate \[unit of the axis\].
    pub max_boundary_jump: Vec<f64>,
    /// For each flag that occurred, the number of rows with it.
    pub status_rows: Vec<(&'static str, usize)>,
}

/// Figures of one axis \[unit of the axis\].
///
/// `sigma` is the sample standard deviation of the non-overlapping `tau`-means, the bias
/// stability at `tau`; `rmse` is their root mean square about the axis's mean over the log, since
/// a constant turn-on bias is not thermal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisEvaluation {
    /// Name.
    pub axis: String,
    /// Unit.
    pub unit: &'static str,
    /// Number of `tau`-means.
    pub n: usize,
    /// Bias stability without compensation.
    pub sigma_raw: f64,
    /// Bias stability with compensation.
    pub sigma_compensated: f64,
    /// `1 - sigma_compensated / sigma_raw`; negative where compensation does harm.
    pub improvement: f64,
    /// RMS without compensation.
    pub rmse_raw: f64,
    /// RMS with compensation.
    pub rmse_compensated: f64,
    /// Largest deviation of a `tau`-mean with compensation.
    pub max_abs_compensated: f64,
}

impl AxisEvaluation {
    /// Whether the compensation is better than none.
    pub fn is_acceptable(&self) -> bool {
        self.sigma_compensated < self.sigma_raw
    }
}

/// Evaluates a compensated log.
///
/// # Errors
/// Fewer than two full stretches of `tau_s`.
pub fn evaluate(
    set: &CoefficientSet,
    time_s: &[f64],
    interval_s: f64,
    applied: &Applied,
    tau_s: f64,
) -> Result<Evaluation, String> {
    let mut axes = Vec::new();
    let mut max_boundary_jump = Vec::new();
    let mut of_channel = 0;
    let mut channel_before = 0;
    for ((channel, axis), output) in set.axes().zip(&applied.axes) {
        if channel != channel_before {
            (channel_before, of_channel) = (channel, 0);
        }
        let [raw, compensated] = [&output.raw, &output.compensated].map(|values| {
            let values = values.iter().map(|&value| f64::from(value));
            Means::new(time_s, interval_s, values, tau_s)
        });
        if raw.means.len() < 2 {
            return Err(format!(
                "{} full stretches of {tau_s} s in the log: expected 2 or more, or a smaller --tau",
                raw.means.len()
            ));
        }
        axes.push(AxisEvaluation {
            axis: axis.name.clone(),
            unit: axis.unit.name(),
            n: raw.means.len(),
            sigma_raw: raw.sigma(),
            sigma_compensated: compensated.sigma(),
            improvement: 1.0 - compensated.sigma() / raw.sigma(),
            rmse_raw: raw.rmse(),
            rmse_compensated: compensated.rmse(),
            max_abs_compensated: compensated.max_abs(),
        });
        let table = &set.channels[channel].table;
        max_boundary_jump.push(f64::from(table.max_jump(of_channel)));
        of_channel += 1;
    }
    let status_rows = tempco::Status::NAMES
        .iter()
        .map(|&(flag, name)| {
            let rows = applied.status.iter().filter(|status| status.contains(flag));
            (name, rows.count())
        })
        .filter(|&(_, rows)| rows > 0)
        .collect();
    Ok(Evaluation {
        tau_s,
        axes,
        max_boundary_jump,
        status_rows,
    })
}

/// Means over stretches of `tau`, and the mean over the log.
pub(crate) struct Means {
    pub(crate) means: Vec<f64>,
    pub(crate) mean: f64,
}

impl Means {
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

    fn sigma(&self) -> f64 {
        let n = self.means.len() as f64;
        let mean = self.means.iter().sum::<f64>() / n;
        let squares: f64 = self.means.iter().map(|v| (v - mean).powi(2)).sum();
        (squares / (n - 1.0)).sqrt()
    }

    fn rmse(&self) -> f64 {
        let squares: f64 = self.means.iter().map(|v| (v - self.mean).powi(2)).sum();
        (squares / self.means.len() as f64).sqrt()
    }

    fn max_abs(&self) -> f64 {
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
