//! The difference between heating and cooling.

use std::collections::BTreeMap;

use serde::Serialize;
use tempco::ThermalPoint;
use tempco_set::run::AxisOutput;

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

/// Rows of a channel sorted into bins of temperature, as they come.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    least_rate: f64,
    interval_s: f64,
    axes: usize,
    /// By number: cooling, then heating.
    bins: BTreeMap<i32, [Rows; 2]>,
}

/// The rows of a bin in one direction.
#[derive(Clone, Debug, Default)]
struct Rows {
    count: f64,
    time_s: f64,
    /// For each axis, the sums without and with compensation.
    sums: Vec<[f64; 2]>,
}

impl Bins {
    /// For so many axes, rows `interval_s` apart, and an estimator of time constant `tau_s`.
    pub(super) fn new(axes: usize, interval_s: f64, tau_s: f64) -> Self {
        Self {
            least_rate: LEAST_CHANGE_C / (tau_s / 60.0),
            interval_s,
            axes,
            bins: BTreeMap::new(),
        }
    }

    /// Number of axes.
    pub(super) fn axes(&self) -> usize {
        self.axes
    }

    /// Sorts the next rows: their lag-compensated temperatures \[degC\] and rates \[degC/min\], and
    /// what came of the axes.
    pub(super) fn push(&mut self, points: &[ThermalPoint], axes: &[AxisOutput]) {
        for (row, point) in points.iter().enumerate() {
            let rate = f64::from(point.rate_c_per_min);
            if rate.abs() < self.least_rate {
                continue;
            }
            let number = (f64::from(point.effective_c) / BIN_C).floor() as i32;
            let rows = &mut self.bins.entry(number).or_default()[usize::from(rate > 0.0)];
            rows.count += 1.0;
            rows.time_s += self.interval_s;
            rows.sums.resize(self.axes, [0.0; 2]);
            for ([raw, compensated], axis) in rows.sums.iter_mut().zip(axes) {
                *raw += f64::from(axis.raw[row]);
                *compensated += f64::from(axis.compensated[row]);
            }
        }
    }

    /// Compares the two directions of an axis; `None` where no bin was passed in both.
    pub(super) fn compare(&self, axis: usize) -> Option<Hysteresis> {
        let both = self.bins.values();
        let both = both.filter(|of| of.iter().all(|rows| rows.time_s >= LEAST_TIME_S));
        // Heating minus cooling, without and with compensation.
        let differences: Vec<[f64; 2]> = both
            .map(|of| {
                let [down, up] = of
                    .each_ref()
                    .map(|rows| rows.sums[axis].map(|sum| sum / rows.count));
                [up[0] - down[0], up[1] - down[1]]
            })
            .collect();
        let of = |which: usize| differences.iter().map(move |of| of[which]);
        let max = |which| of(which).map(f64::abs).fold(0.0, f64::max);
        let rms = |which| (of(which).map(|v| v * v).sum::<f64>() / differences.len() as f64).sqrt();
        (!differences.is_empty()).then(|| Hysteresis {
            bin_c: BIN_C,
            least_rate_c_per_min: self.least_rate,
            bins: differences.len(),
            max_raw: max(0),
            max_compensated: max(1),
            rms_raw: rms(0),
            rms_compensated: rms(1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up from 0 to 20 degC and down again at 1 degC/min, 1 Hz, with a loop of 0.1 that is taken out.
    fn cycle() -> (Vec<ThermalPoint>, AxisOutput) {
        let up = (0..1200_u16).map(|i| (f32::from(i) / 60.0, 1.0));
        let down = (0..1200_u16).map(|i| (20.0 - f32::from(i + 1) / 60.0, -1.0));
        let point = |(effective_c, rate_c_per_min)| ThermalPoint {
            effective_c,
            rate_c_per_min,
            ..ThermalPoint::default()
        };
        let points: Vec<ThermalPoint> = up.chain(down).map(point).collect();
        let raw = points.iter().map(|point| 3.0 + 0.05 * point.rate_c_per_min);
        let output = AxisOutput {
            raw: raw.collect(),
            bias: Vec::new(),
            compensated: vec![0.0; points.len()],
        };
        (points, output)
    }

    fn hysteresis(points: &[ThermalPoint], interval_s: f64) -> Option<Hysteresis> {
        let mut bins = Bins::new(1, interval_s, 60.0);
        bins.push(points, &[cycle().1]);
        bins.compare(0)
    }

    #[test]
    fn a_loop_of_known_width_is_found() {
        let found = hysteresis(&cycle().0, 1.0).unwrap();
        assert_eq!(found.bins, 10);
        assert!((found.least_rate_c_per_min - 0.05).abs() < 1e-15);
        assert!((found.max_raw - 0.1).abs() < 1e-6 && (found.rms_raw - 0.1).abs() < 1e-6);
        assert_eq!((found.max_compensated, found.rms_compensated), (0.0, 0.0));
    }

    #[test]
    fn bins_passed_one_way_or_in_a_hurry_do_not_count() {
        let (points, _) = cycle();
        // Each bin has 120 rows either way: 2 min at 1 Hz, 24 s at 5 Hz.
        assert!(hysteresis(&points, 0.2).is_none());
        assert!(hysteresis(&points[..1200], 1.0).is_none());
        let mut still = points;
        still
            .iter_mut()
            .for_each(|point| point.rate_c_per_min *= 0.04);
        assert!(hysteresis(&still, 1.0).is_none());
    }
}
