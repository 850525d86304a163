//! A unit run through a chamber programme, sample by sample.

use core::iter::FusedIterator;
use core::ops::RangeInclusive;

use crate::chamber::Profile;
use crate::error::SimulationError;
use crate::noise::{PulseOutput, TemperatureSensor};
use crate::thermal::{Propagator, ThermalState};
use crate::unit::Unit;

/// Sample rate of a log where none is asked for, Hz.
pub const DEFAULT_RATE_HZ: f64 = 2.0;

/// Sample rates a simulation accepts, Hz.
pub const RATE_RANGE_HZ: RangeInclusive<f64> = 0.01..=10_000.0;

/// What the unit puts out at one time, and the truth behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start of the programme, s; sample `i` is at exactly `i / rate_hz`.
    pub time_s: f64,
    /// Temperature reading of the sensor on the case, degC.
    pub temp_c: f64,
    /// Pulses of the X, Y and Z gyro in the sample interval that ends at `time_s`.
    pub pulses: [i64; 3],
    /// What a real unit would not tell.
    pub truth: Truth,
}

/// True values at the time of a sample, for the X, Y and Z gyro.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Temperature of the cavity, degC.
    pub cavity_c: [f64; 3],
    /// Bias, pulses/s.
    pub bias_pulses_per_s: [f64; 3],
}

/// Iterator over the samples of one run.
///
/// The first sample is at time 0, the last at or just before the end of the programme. The
/// temperatures of case and cavities are exact solutions at any rate: runs at two rates have the
/// same truth at the times they share.
#[derive(Debug, Clone)]
pub struct Simulation {
    unit: Unit,
    profile: Profile,
    rate_hz: f64,
    next_index: u64,
    samples: u64,
    /// Time up to which `state` has been moved, s.
    time_s: f64,
    /// Leg of the profile at `time_s`.
    leg: usize,
    state: ThermalState,
    bias_pulses_per_s: [f64; 3],
    whole_interval: Propagator,
    sensor: TemperatureSensor,
    outputs: [PulseOutput; 3],
}

impl Simulation {
    /// Starts a run of `unit` through `profile`. Every value of `seed` gives another noise.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Rate`] when `rate_hz` is outside [`RATE_RANGE_HZ`].
    pub fn new(
        unit: &Unit,
        profile: &Profile,
        seed: u64,
        rate_hz: f64,
    ) -> Result<Self, SimulationError> {
        if !RATE_RANGE_HZ.contains(&rate_hz) {
            return Err(SimulationError::Rate { rate_hz });
        }
        let interval_s = 1.0 / rate_hz;
        let state = ThermalState::uniform(profile.start_c());
        let output = |axis| PulseOutput::new(&unit.noise, interval_s, seed, axis);
        Ok(Self {
            unit: unit.clone(),
            profile: profile.clone(),
            rate_hz,
            next_index: 0,
            samples: sample_count(profile.duration_s(), rate_hz),
            time_s: 0.0,
            leg: 0,
            state,
            bias_pulses_per_s: bias(unit, &state),
            whole_interval: Propagator::new(&unit.thermal, interval_s),
            sensor: TemperatureSensor::new(&unit.noise, seed),
            outputs: core::array::from_fn(output),
        })
    }

    /// Moves the thermal state, split where the programme bends so that each part is exact.
    fn advance_to(&mut self, time_s: f64) {
        let begin_s = self.time_s;
        while self.time_s < time_s {
            let leg = self.profile.legs()[self.leg];
            if leg.end_s <= self.time_s {
                self.leg += 1;
                continue;
            }
            let part_end_s = time_s.min(leg.end_s);
            let air_c = leg.air_c(self.time_s);
            let propagator = if self.time_s == begin_s && part_end_s == time_s {
                self.whole_interval
            } else {
                Propagator::new(&self.unit.thermal, part_end_s - self.time_s)
            };
            propagator.advance(&mut self.state, air_c, leg.slope_c_per_s);
            self.time_s = part_end_s;
        }
    }
}

impl Iterator for Simulation {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next_index == self.samples {
            return None;
        }
        let time_s = self.next_index as f64 / self.rate_hz;
        self.next_index += 1;
        self.advance_to(time_s);

        let before = self.bias_pulses_per_s;
        let now = bias(&self.unit, &self.state);
        self.bias_pulses_per_s = now;
        let pulses = core::array::from_fn(|axis| {
            let mean_pulses_per_s = 0.5 * (before[axis] + now[axis]);
            self.outputs[axis].count(mean_pulses_per_s / self.rate_hz)
        });
        Some(Sample {
            time_s,
            temp_c: self.sensor.read(self.state.case_c),
            pulses,
            truth: Truth {
                cavity_c: self.state.cavity_c,
                bias_pulses_per_s: now,
            },
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::try_from(self.samples - self.next_index);
        (left.unwrap_or(usize::MAX), left.ok())
    }
}

impl FusedIterator for Simulation {}

/// Samples from time 0 up to and including the end of the programme.
fn sample_count(duration_s: f64, rate_hz: f64) -> u64 {
    // The end of a programme is a sum of rounded durations; a sample that would fall on it is
    // not to be lost to an error of the last bit.
    const TOLERANCE: f64 = 1e-6;
    (duration_s * rate_hz + TOLERANCE).floor() as u64 + 1
}

/// True bias of each axis, pulses/s.
fn bias(unit: &Unit, state: &ThermalState) -> [f64; 3] {
    let rate_c_per_min = unit.thermal.cavity_rate_c_per_min(state);
    core::array::from_fn(|axis| {
        unit.bias[axis].pulses_per_s(state.cavity_c[axis], rate_c_per_min[axis])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chamber::Step;
    use crate::noise::NoiseLevels;

    fn quiet_unit() -> Unit {
        Unit {
            noise: NoiseLevels::NONE,
            ..Unit::named("paper").unwrap()
        }
    }

    fn short() -> Profile {
        Profile::named("short").unwrap()
    }

    #[test]
    fn times_are_exact_multiples() {
        let run = Simulation::new(&quiet_unit(), &short(), 1, 10.0).unwrap();
        assert_eq!(run.size_hint(), (54_001, Some(54_001)));
        let samples: Vec<Sample> = run.collect();
        assert_eq!(samples.len(), 54_001);
        for (i, sample) in samples.iter().enumerate() {
            assert_eq!(sample.time_s, i as f64 / 10.0);
        }
    }

    #[test]
    fn truth_does_not_depend_on_the_rate() {
        // Ramps that end between samples: 17 degC at 0.7 degC/min take 1457.14 s.
        let steps = [
            Step::Ramp {
                to_c: 42.0,
                rate_c_per_min: 0.7,
            },
            Step::Ramp {
                to_c: 20.0,
                rate_c_per_min: 1.3,
            },
        ];
        let profile = Profile::new("test", 25.0, &steps).unwrap();
        let run = |rate_hz| Simulation::new(&quiet_unit(), &profile, 1, rate_hz).unwrap();
        let mut compared = 0;
        for (coarse, fine) in run(0.25).zip(run(8.0).step_by(32)) {
            assert_eq!(coarse.time_s, fine.time_s);
            assert!((coarse.temp_c - fine.temp_c).abs() < 1e-9);
            for axis in 0..3 {
                let (a, b) = (coarse.truth, fine.truth);
                assert!((a.cavity_c[axis] - b.cavity_c[axis]).abs() < 1e-9);
                assert!((a.bias_pulses_per_s[axis] - b.bias_pulses_per_s[axis]).abs() < 1e-9);
            }
            compared += 1;
        }
        assert!(compared > 600);
    }

    #[test]
    fn starts_at_rest_and_ends_where_the_programme_ends() {
        let samples: Vec<Sample> = Simulation::new(&quiet_unit(), &short(), 1, 2.0)
            .unwrap()
            .collect();
        assert_eq!(samples[0].temp_c, 25.0);
        assert_eq!(samples[0].truth.cavity_c, [25.0; 3]);
        assert_eq!(samples[1199].truth.cavity_c, [25.0; 3]);
        assert_ne!(samples[1300].truth.cavity_c, [25.0; 3]);
        assert_eq!(samples.last().unwrap().time_s, 5400.0);
    }

    #[test]
    fn rates_outside_the_range_are_refused() {
        for rate_hz in [0.0, -2.0, 0.001, 20_000.0, f64::NAN, f64::INFINITY] {
            let error = Simulation::new(&quiet_unit(), &short(), 1, rate_hz).unwrap_err();
            assert!(error.to_string().ends_with("outside 0.01..10000 Hz"));
        }
    }

    #[test]
    fn a_run_that_ends_between_samples_stops_before_the_end() {
        assert_eq!(sample_count(10.0, 2.0), 21);
        assert_eq!(sample_count(10.4, 2.0), 21);
        assert_eq!(sample_count(0.3 - 1e-12, 10.0), 4);
    }
}
