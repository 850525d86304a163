//! The same faults to both cores: the same flags, the same counters.
//!
//! Both see the same temperatures (multiples of 2^-10 degC, which both represent). What is decided
//! about a reading must agree without exception. Flags that compare what was computed (still
//! ramping, rate or temperature at the end of the calibrated range) may differ where f32 and the
//! integers round to either side of the limit, so there the value must lie at the limit.

mod common;

use common::*;
use tempco::{Compensator, Interval, Output, Status, ThermalSettings};
use tempco_fixed::{FixedCompensator, FixedInterval, FixedOutput, INVALID, from_f32, to_f32};

/// How far beyond a limit the cores may differ about it \[degC or degC/min\].
const AT_LIMIT: f32 = 2e-4;

struct Both {
    settings: ThermalSettings,
    samples: usize,
    at_limits: usize,
    seen: Status,
}

impl Both {
    /// Runs both cores over a stream of intervals \[s\] and temperatures \[degC, or NaN\].
    fn run(&mut self, stream: impl Iterator<Item = (f32, f32)>) {
        let thermal = thermal(self.settings);
        let f32_table = table(thermal);
        let fixed_table = fixed(&f32_table);
        let mut f32_unit = Compensator::new(&f32_table);
        let mut unit = FixedCompensator::new(&fixed_table);
        for (dt_s, temp_c) in stream {
            let expected = f32_unit.step(&Interval::new(&thermal, dt_s), temp_c, [0.0; 2]);
            let interval = FixedInterval::new(fixed_table.thermal(), dt_s);
            let out = unit.step(&interval, from_f32(temp_c), [0; 2]);
            self.compare(
                &out,
                &expected,
                &format!("{temp_c} degC, {dt_s} s, {:?}", self.settings),
            );
            let counters = (
                unit.thermal_state().rejected(),
                unit.thermal_state().restarts(),
            );
            let f32_state = f32_unit.thermal_state();
            assert_eq!(counters, (f32_state.rejected(), f32_state.restarts()));
            self.samples += 1;
            self.seen |= out.status;
        }
    }

    fn compare(&mut self, out: &FixedOutput<2>, expected: &Output<2>, at: &str) {
        let computed = Status::SETTLING | Status::RATE_CLAMPED | Status::TEMPERATURE_CLAMPED;
        let differing = out.status.bits() ^ expected.status.bits();
        assert_eq!(
            differing & !computed.bits(),
            0,
            "{:?}, {:?}: {at}",
            out.status,
            expected.status
        );
        let (u, rate) = (to_f32(out.point.effective), to_f32(out.point.rate));
        let allowed = AT_LIMIT * (1.0 + expected.point.rate_c_per_min.abs());
        assert!(
            (rate - expected.point.rate_c_per_min).abs() < allowed,
            "{rate}: {at}"
        );
        assert!((u - expected.point.effective_c).abs() < 0.05, "{u}: {at}");
        if differing == 0 {
            return;
        }
        self.at_limits += 1;
        let near = |value: f32, limit: f32| (value - limit).abs() < allowed;
        if differing & Status::RATE_CLAMPED.bits() != 0 {
            let s = &self.settings;
            assert!(
                near(rate, s.rate_min_c_per_min) || near(rate, s.rate_max_c_per_min),
                "{at}"
            );
        }
        if differing & Status::TEMPERATURE_CLAMPED.bits() != 0 {
            assert!(near(u, -40.0) || near(u, 80.0), "{u}: {at}");
        }
    }
}

/// A walk with stretches of ramps and steps; `faults` of 16 readings or intervals are broken.
fn stream(noise: &mut Noise, length: usize, faults: u32) -> Vec<(f32, f32)> {
    let (mut temp, mut speed) = (noise.between(-30.0, 70.0), 0.0);
    let exact = |temp: f32| (temp * 1024.0).round() / 1024.0;
    (0..length)
        .map(|i| {
            if i % 100 == 0 {
                speed = noise.between(-0.6, 0.6);
            }
            if noise.bits().is_multiple_of(150) {
                temp = noise.between(-58.0, 148.0);
            }
            temp = (temp + speed).clamp(-60.0, 150.0);
            let hit = noise.bits() % 16 < faults;
            let reading = match noise.bits() % 5 {
                0 if hit => f32::NAN,
                1 if hit => f32::INFINITY,
                2 if hit => exact(noise.between(-100.0, 200.0)),
                3 if hit => {
                    [-60.0, 150.0, 150.0 + 1.0 / 1024.0, -500.0][(noise.bits() % 4) as usize]
                }
                _ => exact(temp),
            };
            let dt_s = match noise.bits() % 40 {
                0 if faults > 0 => {
                    [0.0, -1.0, f32::NAN, 400.0, 40.0, 1e9][(noise.bits() % 6) as usize]
                }
                1 => noise.between(0.001, 5.0),
                _ => 1.0,
            };
            (dt_s, reading)
        })
        .collect()
}

#[test]
fn flags_and_counters_are_those_of_the_f32_core() {
    let mut noise = Noise(0x7465_6d70_636f);
    let mut both = Both {
        settings: SETTINGS,
        samples: 0,
        at_limits: 0,
        seen: Status::OK,
    };
    for round in 0..400 {
        both.settings = ThermalSettings {
            spike_gate_c: noise.between(0.2, 20.0),
            max_slew_c_per_min: noise.between(1.0, 100.0),
            hold_s: noise.between(0.0, 100.0).floor(),
            heal_s: noise.between(0.0, 60.0).floor(),
            tau_s: noise.between(4.0, 300.0),
            kappa: [0.0, noise.between(0.0, 2.0)][round % 2],
            rate_min_c_per_min: noise.between(-40.0, -1.0),
            rate_max_c_per_min: noise.between(1.0, 40.0),
            ..SETTINGS
        };
        both.run(stream(&mut noise, 500, [0, 1, 4, 12][round % 4]).into_iter());
    }
    println!("{} of {} samples at a limit", both.at_limits, both.samples);
    assert!(
        both.at_limits * 2000 < both.samples,
        "{} of {}",
        both.at_limits,
        both.samples
    );
    for (flag, name) in Status::NAMES {
        let raw = flag == Status::RAW_INVALID;
        assert!(raw || both.seen.contains(flag), "{name} is never raised");
    }
}

/// At the edges of the gate both decide alike, one last place apart.
#[test]
fn the_gate_is_where_the_settings_say() {
    for (step, believed) in [
        (2.5, true),
        (2.5 + 2e-6, false),
        (-2.5, true),
        (-2.5 - 2e-6, false),
    ] {
        let mut unit = settled(40.0);
        let temp = (40 << 20) + (step * 1_048_576.0_f64).round() as i32;
        let out = unit.step(&SECOND, temp, RAW);
        assert_eq!(
            out.status.contains(Status::TEMPERATURE_SPIKE),
            !believed,
            "{step}"
        );
    }
}

#[test]
fn no_number_at_all_stops_it() {
    let mut noise = Noise(3);
    let mut unit = FixedCompensator::new(&TABLE);
    let special = [
        INVALID,
        INVALID + 1,
        -1,
        0,
        1,
        i32::MAX,
        -(60 << 20),
        150 << 20,
    ];
    for i in 0..300_000 {
        let any = |noise: &mut Noise| match noise.bits() % 3 {
            0 => special[(noise.bits() % 8) as usize],
            1 => noise.bits() as i32,
            _ => noise.bits() as i32 >> 5,
        };
        let dt_us =
            (i64::from(any(&mut noise)) << 32 | i64::from(any(&mut noise))) >> (noise.bits() % 64);
        let before = unit.clone();
        let interval = FixedInterval::from_micros(TABLE.thermal(), dt_us);
        let raw = [any(&mut noise), any(&mut noise)];
        let temp = any(&mut noise);
        let out = unit.step(&interval, temp, raw);
        for ((raw, bias), compensated) in raw.into_iter().zip(out.bias).zip(out.compensated) {
            assert!(bias.unsigned_abs() <= 1 << 30, "sample {i}");
            let invalid = raw == INVALID;
            let expected = [raw.saturating_sub(bias), INVALID][usize::from(invalid)];
            assert_eq!(compensated, expected);
        }
        let wrong = raw
            .iter()
            .zip(out.bias)
            .any(|(raw, bias)| *raw == INVALID || raw.checked_sub(bias).is_none());
        assert_eq!(out.status.contains(Status::RAW_INVALID), wrong);
        // The gyro reaches neither the bias nor the state.
        let mut twin = before;
        let other = twin.step(&interval, temp, [0; 2]);
        assert_eq!((other.bias, other.point), (out.bias, out.point));
        assert_eq!(twin.thermal_state(), unit.thermal_state());
    }
    // Whatever happened, a good temperature heals everything.
    let last = *feed(&mut unit, [33.0; 1500]).last().unwrap();
    assert_eq!((last.status, last.point.effective), (Status::OK, 33 << 20));
}
