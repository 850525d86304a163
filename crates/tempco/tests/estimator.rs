//! The rate of temperature as a user of the thermal path sees it: delay, noise, exactness.

mod common;

use common::*;
use tempco::{Interval, Thermal, ThermalSettings, ThermalState};

fn with_tau(tau_s: f32) -> Thermal {
    thermal(ThermalSettings { tau_s, ..SETTINGS })
}

/// A fixed sequence of numbers in -1..1, the same on every machine.
fn noise() -> impl Iterator<Item = f64> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    })
}

/// The rates of a stream of temperatures at a fixed interval.
fn rates(thermal: &Thermal, dt_s: f32, temps: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let interval = Interval::new(thermal, dt_s);
    let mut temps = temps.into_iter().map(|temp| temp as f32);
    let mut state = ThermalState::new(thermal);
    state.start(thermal, temps.next().unwrap());
    temps
        .map(|temp| f64::from(state.update(thermal, &interval, temp).rate_c_per_min))
        .collect()
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .into_iter()
        .fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    f64::sqrt(sum / count)
}

/// The delay is the area between the true rate and the estimate, over the rate.
#[test]
fn the_delay_after_the_onset_of_a_ramp_is_the_time_constant() {
    for &tau_s in first(&[20.0, 60.0, 600.0], 1) {
        for (dt_s, change_per_tau) in [(0.1, 1.0), (1.0, -5.0), (4.0, 0.5)] {
            let ramp = 60.0 / tau_s * change_per_tau;
            let count = (12.0 * tau_s / dt_s) as usize;
            // A soak before it, as long, fills the filter's memory.
            let ramp_steps = (0..2 * count).map(|i| i.saturating_sub(count - 1));
            let temps = ramp_steps.map(|i| 25.0 + ramp / 60.0 * dt_s * i as f64);
            let missing = |rate: f64| 1.0 - rate / ramp;
            // The first half step belongs to the moment of the onset, where all is missing.
            let sum: f64 = rates(&with_tau(tau_s as f32), dt_s as f32, temps)
                .into_iter()
                .skip(count - 1)
                .map(missing)
                .sum();
            let delay_s = (sum + 0.5) * dt_s;
            assert!(
                (delay_s / tau_s - 1.0).abs() < 0.01,
                "delay {delay_s} s at tau {tau_s} s, dt {dt_s} s"
            );
        }
    }
}

#[test]
fn the_rate_approaches_a_new_ramp_as_an_exponential() {
    let temps = (0..=300).map(|s| 25.0 + 2.0 / 60.0 * f64::from(s));
    for (s, rate) in (1..).zip(rates(&THERMAL, 1.0, temps)) {
        let expected = 2.0 * -(-f64::from(s) / 60.0).exp_m1();
        assert!((rate - expected).abs() < 1e-3, "{rate} after {s} s");
    }
}

/// Switched on in the middle of a ramp, a slow estimator knows it after a minute, not after three
/// time constants, and the rate fades in until then.
#[test]
fn a_ramp_since_before_power_on_is_known_after_a_minute() {
    for &(tau_s, dt_s) in first(
        &[(600.0, 1.0), (2400.0, 1.0), (6000.0, 1.0), (61.0, 0.05)],
        1,
    ) {
        let temps = (0..).map(|i| 25.0 - 2.0 / 60.0 * f64::from(dt_s) * f64::from(i));
        let rates = rates(&with_tau(tau_s), dt_s, temps.take((600.0 / dt_s) as usize));
        for (i, rate) in (1..).zip(rates) {
            let tau_s = f64::from(tau_s);
            let memory = -(-f64::from(dt_s) * f64::from(i) / tau_s).exp_m1();
            let expected = -2.0 * (memory * tau_s / 60.0).min(1.0);
            let error = (rate - expected).abs();
            assert!(
                error < 0.002,
                "{rate} at step {i} of {dt_s} s, tau {tau_s} s"
            );
        }
    }
}

/// The least divisor bounds the rate that a slow estimator derives from the first minutes.
#[test]
fn the_divisor_of_the_rate_has_a_floor() {
    for &(tau_s, least_divisor) in first(
        &[(2400.0, 0.25), (2400.0, 1.0), (2400.0, 0.0), (60.0, 0.5)],
        1,
    ) {
        let thermal = thermal(ThermalSettings {
            tau_s,
            least_divisor,
            ..SETTINGS
        });
        let temps = (0..1200).map(|s| 25.0 + 2.0 / 60.0 * f64::from(s));
        for (s, rate) in (1..).zip(rates(&thermal, 1.0, temps)) {
            let memory = -(-f64::from(s) / f64::from(tau_s)).exp_m1();
            let floor = f64::max(f64::from(least_divisor), (60.0 / f64::from(tau_s)).min(1.0));
            let expected = 2.0 * memory / f64::max(memory, floor);
            let error = (rate - expected).abs();
            assert!(
                error < 0.002,
                "{rate}, {expected} after {s} s, {least_divisor}"
            );
        }
    }
}

#[test]
fn a_steady_ramp_is_exact_at_every_interval() {
    for &tau_s in first(&[60.0, 6.0, 600.0], 1) {
        let thermal = with_tau(tau_s);
        for &part in first(&[0.5, 0.4, 0.25, 0.1, 0.01, 1e-3], 4) {
            let dt_s = part * tau_s;
            for change_per_tau in [-2.0, 0.1, 2.5] {
                let ramp = 60.0 / f64::from(tau_s) * change_per_tau;
                let step = ramp / 60.0 * f64::from(dt_s);
                let count = (15.0 / part) as usize;
                let temps = (0..count).map(|i| 30.0 + step * i as f64);
                let rate = *rates(&thermal, dt_s, temps).last().unwrap();
                // One last place of the temperature, differentiated, is the floor.
                let floor = 60.0 * 1e-5 / f64::from(tau_s);
                let error = (rate - ramp).abs();
                assert!(error < 1e-4 * ramp.abs() + floor, "{rate} for {ramp}");
            }
        }
    }
}

/// Each interval weighs by its own length, so the error is half its difference from the mean
/// over the time constant: 0.4 % for 1 s +- 50 %, and well within a percent with its memory.
#[test]
fn jittered_intervals_give_the_rate_of_regular_ones_within_a_percent() {
    for &(mean_s, jitter) in first(&[(1.0, 0.5), (0.1, 1.0), (2.0, 0.25)], 1) {
        let mut state = ThermalState::new(&THERMAL);
        let mut temp = -10.0;
        state.start(&THERMAL, temp as f32);
        let (mut worst, mut time_s) = (0.0, 0.0);
        for part in noise().take((1000.0 / mean_s) as usize) {
            let dt_s = mean_s * (1.0 + jitter * part);
            let interval = Interval::new(&THERMAL, dt_s as f32);
            temp += 4.0 / 60.0 * dt_s;
            time_s += dt_s;
            let rate = f64::from(
                state
                    .update(&THERMAL, &interval, temp as f32)
                    .rate_c_per_min,
            );
            let regular = 4.0 * -f64::exp_m1(-time_s / 60.0);
            worst = f64::max(worst, (rate - regular).abs() / 4.0);
        }
        assert!(worst < 0.01, "{worst} at {mean_s} s +- {jitter}");
    }
}

/// A quantised slow ramp is a staircase; what it does to the rate is what the docs of the
/// estimator say white noise of the same size does: s / tau, 0.018 degC/min for 0.0625 degC.
#[test]
fn a_quantised_slow_ramp_makes_no_more_noise_than_documented() {
    let step: f64 = 0.0625;
    for &ramp in first(&[0.01, 0.05, 0.2, 1.0], 1) {
        for &dt_s in first(&[1.0, 0.1], 1) {
            let temps = (0..(4000.0 / dt_s) as usize)
                .map(|i| ((20.0 + ramp / 60.0 * dt_s * i as f64) / step).round() * step);
            let rates = rates(&THERMAL, dt_s as f32, temps);
            let settled = &rates[(600.0 / dt_s) as usize..];
            let noise = rms(settled.iter().map(|rate| rate - ramp));
            assert!(noise < 0.0181, "{noise} at {ramp} degC/min, {dt_s} s");
            // Never more than the whole step at once.
            assert!(settled.iter().all(|rate| (rate - ramp).abs() < step));
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "needs its many samples")]
fn white_noise_is_divided_by_the_time_constant() {
    for tau_s in [20.0, 60.0] {
        let thermal = with_tau(tau_s as f32);
        let temps: Vec<_> = noise().take(50_000).map(|n| 20.0 + 0.1 * n).collect();
        let sigma = 0.1 / f64::sqrt(3.0);
        let measured = rms(rates(&thermal, 1.0, temps).into_iter().skip(1000));
        let documented = sigma / tau_s * 60.0;
        assert!(measured < 1.01 * documented, "{measured}, {documented}");
        assert!(measured > 0.95 * documented, "{measured}, {documented}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "needs its many samples")]
fn slow_ramps_do_not_stagnate_at_a_kilohertz() {
    for (tau_s, ramp) in [(60.0, 0.02), (60.0, -0.002), (100.0, 0.1)] {
        let thermal = with_tau(tau_s);
        let count = (8.0 * tau_s * 1000.0) as u32;
        let temps = (0..count).map(|i| 70.0 + ramp / 60.0 * 1e-3 * f64::from(i));
        let rates = rates(&thermal, 1e-3, temps);
        // One last place of the temperature is 7.6e-6 degC, and as rate the same per minute.
        let error = (rates.last().unwrap() - ramp).abs();
        assert!(error < 0.005 * ramp.abs() + 1e-5, "{error} for {ramp}");
    }
}

/// The sum of two f32 resolves the lag far below one last place of the temperature (7.6e-6 degC
/// at 71 degC), so that a rate fades out smoothly instead of flickering at that level.
#[test]
fn the_rate_after_a_step_fades_below_the_last_place_of_the_temperature() {
    let count = fewer(10_000, 1000);
    let temps = (0..=count).map(|i| if i == 0 { 70.0 } else { 71.0 });
    for (i, rate) in (0..).zip(rates(&THERMAL, 0.1, temps)) {
        let expected = (-f64::from(i) / 600.0).exp();
        let error = rate / expected - 1.0;
        assert!(error.abs() < 0.01, "{rate} for {expected}");
    }
}

/// At the shift `kappa` the lag-compensated temperature is that of a part which lags (or leads).
#[test]
fn the_effective_temperature_lags_by_kappa_time_constants() {
    for &kappa in first(&[0.5, 0.0, 2.0], 1) {
        let thermal = thermal(ThermalSettings { kappa, ..SETTINGS });
        let mut state = ThermalState::new(&thermal);
        state.start(&thermal, 20.0);
        for s in 1..=1200 {
            let temp = 20.0 + 1.5 / 60.0 * s as f32;
            let point = state.update(&thermal, &SECOND, temp);
            let lag_s = (temp - point.effective_c) * 60.0 / 1.5;
            assert!(s < 900 || (lag_s - kappa * 60.0).abs() < 0.1, "{lag_s}");
        }
    }
}
