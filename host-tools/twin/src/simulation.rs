//! A unit run through a chamber profile, sample by sample.

use core::iter::FusedIterator;
use core::ops::RangeInclusive;

use crate::bias::ThermalBiases;
use crate::chamber::Profile;
use crate::drift::DriftState;
use crate::error::SimulationError;
use crate::events::{Fault, FaultKind, Flags};
use crate::gyro::GyroChannel;
use crate::heat::Heat;
use crate::normal::{NormalSource, Stream};
use crate::output::Quantiser;
use crate::sensor::TemperatureSensor;
use crate::thermal::ThermalState;
use crate::tone::ToneState;
use crate::unit::Unit;

/// Sample rate of a log where none is asked for, Hz.
pub const DEFAULT_RATE_HZ: f64 = 2.0;

/// Sample rates a simulation accepts, Hz.
pub const RATE_RANGE_HZ: RangeInclusive<f64> = 0.01..=10_000.0;

/// What the unit puts out at one time, and the truth behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start of the profile, s; sample `i` is at exactly `i / rate_hz`.
    pub time_s: f64,
    /// Temperature reading, degC; NaN when there is none.
    pub temp_c: f64,
    /// Output of the X, Y and Z gyro for the sample interval that ends at `time_s`: pulses counted
    /// in it, or its mean rate in steps of the output.
    pub counts: [i64; 3],
    /// What a real unit does not show.
    pub truth: Truth,
}

/// True values at the time of a sample, for the X, Y and Z gyro.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Temperature of the cavity, degC.
    pub cavity_c: [f64; 3],
    /// Bias, in the unit's rate unit; drift is part of it.
    pub bias: [f64; 3],
    /// What is not as usual at this sample.
    pub flags: Flags,
}

/// Iterator over the samples of one run.
///
/// The first sample is at time 0, the last at or just before the end of the profile. Temperatures
/// are exact solutions at any rate, and drift is a function of time: runs at two rates have the same
/// truth at the times they share, hysteresis apart, which sees the turning points to within a sample.
#[derive(Debug, Clone)]
pub struct Simulation {
    unit: Unit,
    profile: Profile,
    rate_hz: f64,
    next_index: u64,
    samples: u64,
    rows_lost: bool,
    heat: Heat,
    thermal_bias: ThermalBiases,
    bias: [f64; 3],
    drifts: [DriftState; 3],
    tones: Vec<ToneState>,
    /// Angle of tones and motion at the last sample, rate unit times s.
    disturbance: [f64; 3],
    input_rate: [f64; 3],
    sensor: TemperatureSensor,
    gyros: [GyroChannel; 3],
    losses: NormalSource,
}

impl Simulation {
    /// Starts a run of `unit` through `profile`. Every value of `seed` gives another noise.
    ///
    /// # Errors
    ///
    /// [`SimulationError`] when `rate_hz` is outside [`RATE_RANGE_HZ`] or the unit cannot be.
    pub fn new(
        unit: &Unit,
        profile: &Profile,
        seed: u64,
        rate_hz: f64,
    ) -> Result<Self, SimulationError> {
        if !RATE_RANGE_HZ.contains(&rate_hz) {
            return Err(SimulationError::Rate { rate_hz });
        }
        unit.check()?;
        let interval_s = 1.0 / rate_hz;
        let (heat, mut thermal_bias) = at_time_0(unit, profile, interval_s);
        let mut drifts =
            core::array::from_fn(|axis| DriftState::new(&unit.axes[axis].drift, seed, axis));
        let arcsec = unit.output.arcsec_per_angle(unit.rate_unit);
        let tone = |(index, tone)| ToneState::new(tone, seed, index);
        let mut run = Self {
            bias: bias(&mut thermal_bias, heat.state(), &mut drifts, 0.0),
            unit: unit.clone(),
            profile: profile.clone(),
            rate_hz,
            next_index: 0,
            samples: sample_count(profile.duration_s(), rate_hz),
            rows_lost: false,
            heat,
            thermal_bias,
            drifts,
            tones: unit.tone.iter().enumerate().map(tone).collect(),
            disturbance: [0.0; 3],
            // 1 deg/h is 1 arcsec/s.
            input_rate: profile.parts().input_rate_dph.map(|rate| rate / arcsec),
            sensor: TemperatureSensor::new(&unit.temperature, seed),
            gyros: core::array::from_fn(|axis| {
                let quantiser = Quantiser::new(unit.output, unit.rate_unit, interval_s);
                GyroChannel::new(&unit.axes[axis].noise, quantiser, interval_s, seed, axis)
            }),
            losses: NormalSource::new(seed, Stream::Rows),
        };
        run.disturbance = run.disturbance_at(0.0);
        Ok(run)
    }

    /// The unit that is run.
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Angle of tones and motion, rate unit times s.
    fn disturbance_at(&mut self, time_s: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for tone in &mut self.tones {
            add(&mut sum, tone.angle_at(time_s));
        }
        let motions = &self.profile.parts().motion;
        if !motions.is_empty() {
            let arcsec = self.unit.output.arcsec_per_angle(self.unit.rate_unit);
            for motion in motions {
                add(
                    &mut sum,
                    motion.angle_arcsec(time_s).map(|angle| angle / arcsec),
                );
            }
        }
        sum
    }

    /// Angle that each axis turns in the interval, rate unit times s; noise apart.
    fn angles(&mut self, time_s: f64) -> [f64; 3] {
        let before = self.bias;
        self.bias = bias(
            &mut self.thermal_bias,
            self.heat.state(),
            &mut self.drifts,
            time_s,
        );
        let disturbance = self.disturbance_at(time_s);
        let earlier = core::mem::replace(&mut self.disturbance, disturbance);
        core::array::from_fn(|axis| {
            let mean = 0.5 * (before[axis] + self.bias[axis]) + self.input_rate[axis];
            mean / self.rate_hz + (disturbance[axis] - earlier[axis])
        })
    }

    /// The sample at `time_s`, or nothing where its row is lost.
    fn sample(&mut self, time_s: f64, interval_begin_s: f64) -> Option<Sample> {
        self.heat.advance_to(self.profile.air(), time_s);
        let angles = self.angles(time_s);
        let mut counts = core::array::from_fn(|axis| self.gyros[axis].count(angles[axis]));
        let parts = self.profile.parts();
        let faults = parts
            .fault
            .iter()
            .filter(|fault| fault.is_there(interval_begin_s, time_s));
        let temp_c = self
            .sensor
            .read(self.heat.state().sensor_c(), faults.clone());
        let mut flags = flags(faults.clone());
        for fault in faults {
            if let FaultKind::GyroDead { axis } = fault.what {
                counts[axis as usize] = 0;
            }
        }
        if parts
            .motion
            .iter()
            .any(|motion| motion.is_there(interval_begin_s, time_s))
        {
            flags.set(Flags::MOTION);
        }
        let lost = self.unit.lost_rows > 0.0
            && 0.5 * (self.losses.symmetric() + 1.0) < self.unit.lost_rows;
        if lost || flags.contains(Flags::ROWS_LOST) {
            self.rows_lost = true;
            return None;
        }
        if core::mem::take(&mut self.rows_lost) {
            flags.set(Flags::ROWS_LOST);
        }
        Some(Sample {
            time_s,
            temp_c,
            counts,
            truth: Truth {
                cavity_c: self.heat.state().cavity_c(),
                bias: self.bias,
                flags,
            },
        })
    }
}

impl Iterator for Simulation {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        while self.next_index < self.samples {
            let index = self.next_index as f64;
            self.next_index += 1;
            let interval_begin_s = (index - 1.0) / self.rate_hz;
            if let Some(sample) = self.sample(index / self.rate_hz, interval_begin_s) {
                return Some(sample);
            }
        }
        None
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        // Any of the rows may be lost.
        (0, usize::try_from(self.samples - self.next_index).ok())
    }
}

impl FusedIterator for Simulation {}

/// Heat and history at time 0, after what the air did before.
///
/// The unit follows the air in steps of one second whatever the sample rate is. Without power it does
/// not warm itself; what its glass remembers it remembers all the same.
fn at_time_0(unit: &Unit, profile: &Profile, interval_s: f64) -> (Heat, ThermalBiases) {
    let cold = profile.parts().cold_start;
    let network = if cold {
        unit.thermal.unpowered()
    } else {
        unit.thermal
    };
    let mut heat = Heat::new(network, network.at_rest(profile.start_c()), 1.0);
    let mut thermal_bias = ThermalBiases::new(unit, heat.state());
    let before = profile.before();
    let mut time_s: f64 = 0.0;
    while time_s < before.duration_s {
        time_s = (time_s + 1.0).min(before.duration_s);
        heat.advance_to(before, time_s);
        thermal_bias.follow(heat.state());
    }
    if cold {
        thermal_bias.power_on(heat.state());
    }
    let heat = Heat::new(unit.thermal, *heat.state(), interval_s);
    (heat, thermal_bias)
}

/// Samples from time 0 up to and including the end of the profile.
fn sample_count(duration_s: f64, rate_hz: f64) -> u64 {
    // The end of a profile is a sum of rounded durations; a sample that would fall on it is
    // not to be lost to an error of the last bit.
    const TOLERANCE: f64 = 1e-6;
    (duration_s * rate_hz + TOLERANCE).floor() as u64 + 1
}

/// True bias of each axis, rate unit.
fn bias(
    thermal: &mut ThermalBiases,
    state: &ThermalState,
    drifts: &mut [DriftState; 3],
    time_s: f64,
) -> [f64; 3] {
    let mut bias = thermal.follow(state);
    for (bias, drift) in bias.iter_mut().zip(drifts) {
        *bias += drift.at(time_s);
    }
    bias
}

fn add(sum: &mut [f64; 3], part: [f64; 3]) {
    for (sum, part) in sum.iter_mut().zip(part) {
        *sum += part;
    }
}

/// Flags of a sample that faults set.
fn flags<'a>(faults: impl Iterator<Item = &'a Fault>) -> Flags {
    let mut flags = Flags::default();
    for fault in faults {
        flags.set(match fault.what {
            FaultKind::GyroDead { .. } => Flags::GYRO_FAULT,
            FaultKind::RowsLost => Flags::ROWS_LOST,
            _ => Flags::TEMPERATURE_FAULT,
        });
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chamber::ProfileParts;
    use crate::drift::Drift;
    use crate::gyro::GyroNoise;
    use crate::sensor::TemperatureReading;
    use crate::step::Step;

    fn quiet_unit() -> Unit {
        let mut unit = Unit::named("paper").unwrap();
        unit.temperature = TemperatureReading::EXACT;
        for axis in &mut unit.axes {
            axis.noise = GyroNoise::NONE;
        }
        unit
    }

    fn short() -> Profile {
        Profile::named("short").unwrap()
    }

    #[test]
    fn times_are_exact_multiples() {
        let run = Simulation::new(&quiet_unit(), &short(), 1, 10.0).unwrap();
        assert_eq!(run.size_hint(), (0, Some(54_001)));
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
                assert!((a.bias[axis] - b.bias[axis]).abs() < 1e-9);
            }
            compared += 1;
        }
        assert!(compared > 600);
    }

    #[test]
    fn starts_at_rest_and_ends_where_the_profile_ends() {
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
    fn a_unit_that_is_switched_on_in_mid_ramp_has_followed_the_air() {
        let ramp = |to_c| Step::Ramp {
            to_c,
            rate_c_per_min: 1.0,
        };
        let run = |name: &str, cold_start, before: &[f64], step: &[f64]| -> Vec<Sample> {
            let mut unit = Unit::named(name).unwrap();
            unit.temperature = TemperatureReading::EXACT;
            for axis in &mut unit.axes {
                axis.drift = Drift::default();
            }
            let parts = ProfileParts {
                start_c: -15.0,
                cold_start,
                before: before.iter().map(|to_c| ramp(*to_c)).collect(),
                step: step.iter().map(|to_c| ramp(*to_c)).collect(),
                ..ProfileParts::default()
            };
            let profile = Profile::from_parts("test", parts).unwrap();
            Simulation::new(&unit, &profile, 1, 0.5).unwrap().collect()
        };
        // Powered all the time, the run is the later part of one that began two hours before.
        let later = run("loop", false, &[60.0, 15.0], &[60.0]);
        let whole = run("loop", false, &[], &[60.0, 15.0, 60.0]);
        for (later, whole) in later.iter().zip(&whole[3600..]) {
            assert!((later.temp_c - whole.temp_c).abs() < 1e-9);
            for axis in 0..3 {
                let (a, b) = (later.truth.cavity_c[axis], whole.truth.cavity_c[axis]);
                assert!((a - b).abs() < 1e-9);
                // The plays have been dragged along.
                let difference = later.truth.bias[axis] - whole.truth.bias[axis];
                assert!(difference.abs() < 1e-6, "{difference}");
            }
        }
        // Without power all of it is colder by the rises, which are missing from the first moment.
        let cold = run("loop", true, &[60.0, 15.0], &[60.0]);
        let missing_c = later[0].truth.cavity_c[0] - cold[0].truth.cavity_c[0];
        assert!((missing_c - 4.0).abs() < 1e-9, "{missing_c}");
        let missing_c = later[1000].truth.cavity_c[0] - cold[1000].truth.cavity_c[0];
        assert!((0.1..4.0).contains(&missing_c), "{missing_c}");
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
