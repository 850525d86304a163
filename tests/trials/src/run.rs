//! A simulated run: the log of a unit, and the bias behind it.

use tempco_log::{Axis, AxisUnit, Channel, Log, Reading, SkippedRows};
use tempco_twin::{AXIS_NAMES, Output, Profile, RateUnit, Simulation, SimulationError, Unit};

/// Rows of a log \[Hz\]. The noise of the twin is a density, so that means do not depend on it.
const ROWS_HZ: f64 = 1.0;

/// A log and the truth.
#[derive(Clone)]
pub(crate) struct Run {
    /// What a calibration sees.
    pub(crate) log: Log,
    /// For each axis, the true bias of each row \[unit of the axis\].
    pub(crate) truth: [Vec<f64>; 3],
    /// For each axis, the true temperature of its cavity in each row \[degC\].
    pub(crate) cavity_c: [Vec<f64>; 3],
}

impl Run {
    /// Runs a unit through a profile. Every seed gives another noise.
    ///
    /// # Errors
    /// A unit that cannot be.
    pub(crate) fn simulate(
        unit: &Unit,
        profile: &Profile,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        Self::at_rate(unit, profile, seed, ROWS_HZ)
    }

    /// As [`simulate`](Self::simulate), with `rate_hz` rows a second.
    ///
    /// # Errors
    /// A unit or rate that cannot be.
    pub(crate) fn at_rate(
        unit: &Unit,
        profile: &Profile,
        seed: u64,
        rate_hz: f64,
    ) -> Result<Self, SimulationError> {
        let (mut time_s, mut temp_c) = (Vec::new(), Vec::new());
        let [mut raw, mut truth, mut cavity_c] = [(); 3].map(|()| [(); 3].map(|()| Vec::new()));
        let per_count = rate_per_count(unit, rate_hz);
        for sample in Simulation::new(unit, profile, seed, rate_hz)? {
            // A row without a temperature is a bad row; readers leave it out where that is asked for.
            if sample.temp_c.is_nan() {
                continue;
            }
            time_s.push(sample.time_s);
            temp_c.push(sample.temp_c as f32);
            for axis in 0..3 {
                raw[axis].push(sample.counts[axis] as f64 * per_count);
                truth[axis].push(sample.truth.bias[axis]);
                cavity_c[axis].push(sample.truth.cavity_c[axis]);
            }
        }
        let axes = AXIS_NAMES.iter().zip(raw).map(|(name, raw)| Axis {
            name: (*name).to_owned(),
            unit: axis_unit(unit.rate_unit),
            raw,
        });
        let channel = Channel {
            column: "temp_c".to_owned(),
            temp_c,
            axes: axes.collect(),
        };
        let log = Log {
            file: format!("{} {} {seed}", unit.name, profile.name()),
            sha256: String::new(),
            time_s,
            channels: vec![channel],
            reading: Reading::default(),
            ignored_columns: Vec::new(),
            skipped_rows: SkippedRows::default(),
            interval_s: 1.0 / rate_hz,
        };
        Ok(Self {
            log,
            truth,
            cavity_c,
        })
    }
}

const fn axis_unit(rate_unit: RateUnit) -> AxisUnit {
    match rate_unit {
        RateUnit::PulsesPerS => AxisUnit::PulsesPerS,
        RateUnit::Dph => AxisUnit::Dph,
        RateUnit::Dps => AxisUnit::Dps,
    }
}

/// The rate that one count of a sample stands for \[rate unit\].
fn rate_per_count(unit: &Unit, rate_hz: f64) -> f64 {
    match (unit.output, unit.rate_unit) {
        (Output::Rate { step, .. }, _) => step,
        (Output::Pulses { .. }, RateUnit::PulsesPerS) => rate_hz,
        // 1 arcsec/s is 1 deg/h.
        (
            Output::Pulses {
                scale_factor_arcsec,
            },
            RateUnit::Dph,
        ) => scale_factor_arcsec * rate_hz,
        (
            Output::Pulses {
                scale_factor_arcsec,
            },
            RateUnit::Dps,
        ) => scale_factor_arcsec * rate_hz / 3600.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::mean;

    /// Whatever a unit puts out, the mean of its rows is the mean of its bias, within their noise.
    #[test]
    fn rows_are_in_the_unit_of_the_truth() {
        let profile = Profile::named("short").unwrap();
        for name in ["paper", "smooth", "mems", "fog"] {
            let run = Run::simulate(&Unit::named(name).unwrap(), &profile, 1).unwrap();
            for (axis, truth) in run.log.channels[0].axes.iter().zip(&run.truth) {
                let count = truth.len() as f64;
                let squares = axis
                    .raw
                    .iter()
                    .zip(truth)
                    .map(|(raw, bias)| (raw - bias).powi(2));
                let noise = (squares.sum::<f64>() / count).sqrt();
                let error = mean(&axis.raw) - mean(truth);
                assert!(error.abs() < 5.0 * noise / count.sqrt(), "{name}: {error}");
                // A wrong unit would be off by far more than the noise.
                let size = truth
                    .iter()
                    .fold(0.0, |most: f64, bias| most.max(bias.abs()));
                assert!(noise < 100.0 * size, "{name}: {noise}, {size}");
            }
        }
    }
}
