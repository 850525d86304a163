//! The difference between heating and cooling.

use std::collections::BTreeMap;

use serde::Serialize;

/// Width of a bin of temperature \[degC\].
const BIN_C: f64 = 2.0;

/// Time that a bin must have been passed for, in each direction \[s\]: the noise of single rows is
/// not to be taken for hysteresis.
const LEAST_TIME_S: f64 = 30.0;

/// Change that tells a direction from the sensor's noise \[degC\], within one time constant of the
/// rate estimator.
const LEAST_CHANGE_C: f64 = 0.05;

/// The up-curve minus the down-curve \[unit of the axis\].
///
/// Rows of which the rate is beyond `least_rate_c_per_min`, either way, are sorted into bins of
/// lag-compensated temperature; the means of heating and cooling rows of each bin are compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hysteresis {
    /// Width of the bins \[degC\].
    pub bin_c: f64,
    /// Rate that makes a row one of heating or cooling \[degC/min\].
    pub least_rate_c_per_min: f64,
    /// Bins with 30 s or more of both.
    pub bins: usize,
    /// Largest difference without compensation.
    pub max_raw: f64,
    /// Largest difference with compensation.
    pub max_compensated: f64,
    /// Root mean square of the differences without compensation, each bin counting the same.
    pub rms_raw: f64,
    /// Root mean square of the differences with compensation.
    pub rms_compensated: f64,
}

/// Rows of a channel sorted into bins; the same for all its axes.
pub(super) struct Bins {
    least_rate: f64,
    /// For each row, its bin and whether it is one of heating.
    rows: Vec<Option<(i32, bool)>>,
    /// The bins that both directions passed for long enough.
    both: Vec<i32>,
}

impl Bins {
    /// Sorts lag-compensated temperatures \[degC\] and rates \[degC/min\] of an estimator of time
    /// constant `tau_s`.
    pub(super) fn new(points: &[(f32, f32)], interval_s: f64, tau_s: f64) -> Self {
        let least_rate = LEAST_CHANGE_C / (tau_s / 60.0);
        let rows: Vec<Option<(i32, bool)>> = points
            .iter()
            .map(|&(effective_c, rate)| {
                let bin = (f64::from(effective_c) / BIN_C).floor() as i32;
                (f64::from(rate).abs() >= least_rate).then_some((bin, rate > 0.0))
            })
            .collect();
        let mut counts: BTreeMap<i32, [f64; 2]> = BTreeMap::new();
        for (bin, heating) in rows.iter().flatten() {
            counts.entry(*bin).or_default()[usize::from(*heating)] += interval_s;
        }
        let both = counts
            .into_iter()
            .filter(|(_, times_s)| times_s.iter().all(|&time_s| time_s >= LEAST_TIME_S))
            .map(|(bin, _)| bin)
            .collect();
        Self {
            least_rate,
            rows,
            both,
        }
    }

    /// Compares the two directions; `None` where no bin was passed in both.
    pub(super) fn compare(&self, raw: &[f32], compensated: &[f32]) -> Option<Hysteresis> {
        let raw = self.differences(raw);
        let compensated = self.differences(compensated);
        let max = |values: &[f64]| values.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let rms = |values: &[f64]| {
            (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
        };
        (!raw.is_empty()).then(|| Hysteresis {
            bin_c: BIN_C,
            least_rate_c_per_min: self.least_rate,
            bins: raw.len(),
            max_raw: max(&raw),
            max_compensated: max(&compensated),
            rms_raw: rms(&raw),
            rms_compensated: rms(&compensated),
        })
    }

    /// Heating minus cooling in each of the bins passed both ways.
    fn differences(&self, values: &[f32]) -> Vec<f64> {
        let mut sums: BTreeMap<i32, [(f64, f64); 2]> = BTreeMap::new();
        for (row, &value) in self.rows.iter().zip(values) {
            if let Some((bin, heating)) = row {
                let (sum, count) = &mut sums.entry(*bin).or_default()[usize::from(*heating)];
                *sum += f64::from(value);
                *count += 1.0;
            }
        }
        self.both
            .iter()
            .map(|bin| {
                let [down, up] = sums[bin].map(|(sum, count)| sum / count);
                up - down
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up from 0 to 20 degC and down again at 1 degC/min, 1 Hz, with a loop of 0.1.
    fn cycle() -> (Vec<(f32, f32)>, Vec<f32>) {
        let up = (0..1200_u16).map(|i| (f32::from(i) / 60.0, 1.0));
        let down = (0..1200_u16).map(|i| (20.0 - f32::from(i + 1) / 60.0, -1.0));
        let points: Vec<(f32, f32)> = up.chain(down).collect();
        let values = points.iter().map(|&(_, rate)| 3.0 + 0.05 * rate);
        let values = values.collect();
        (points, values)
    }

    #[test]
    fn a_loop_of_known_width_is_found() {
        let (points, values) = cycle();
        let found = Bins::new(&points, 1.0, 60.0)
            .compare(&values, &vec![0.0; values.len()])
            .unwrap();
        assert_eq!(found.bins, 10);
        assert!((found.least_rate_c_per_min - 0.05).abs() < 1e-15);
        assert!((found.max_raw - 0.1).abs() < 1e-6 && (found.rms_raw - 0.1).abs() < 1e-6);
        assert_eq!((found.max_compensated, found.rms_compensated), (0.0, 0.0));
    }

    #[test]
    fn bins_passed_one_way_or_in_a_hurry_do_not_count() {
        let (points, values) = cycle();
        // Each bin has 120 rows either way: 2 min at 1 Hz, 24 s at 5 Hz.
        assert!(
            Bins::new(&points, 0.2, 60.0)
                .compare(&values, &values)
                .is_none()
        );
        let up = &points[..1200];
        assert!(Bins::new(up, 1.0, 60.0).compare(&values, &values).is_none());
        let still: Vec<(f32, f32)> = points.iter().map(|&(t, rate)| (t, 0.04 * rate)).collect();
        assert!(
            Bins::new(&still, 1.0, 60.0)
                .compare(&values, &values)
                .is_none()
        );
    }
}
