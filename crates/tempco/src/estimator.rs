//! Estimates the rate of temperature, causally and without stagnation.

use core::hint::select_unpredictable;

use crate::sign::Sign;
use crate::{Interval, Thermal};

/// A first-order low-pass filter.
///
/// Its value is kept as a sum of two f32. With one, the increments of a slow ramp vanish below its
/// last place: at 1 kHz, 60 s and 70 degC a ramp of 0.02 degC/min reads 0.1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Filter {
    value: f32,
    /// What rounding left out of `value`.
    remainder: f32,
}

impl Filter {
    /// A filter of what has been like this for long.
    pub(crate) const fn new(value: f32) -> Self {
        Self {
            value,
            remainder: 0.0,
        }
    }

    /// Takes an input and returns how far the filter lagged behind it: `d = input - L`, then
    /// `L += alpha d`.
    #[inline(always)]
    pub(crate) fn lag(&mut self, alpha: f32, input: f32) -> f32 {
        let value = self.value;
        let lag = (input - value) - self.remainder;
        let increment = alpha * lag + self.remainder;
        self.value = value + increment;
        self.remainder = increment - (self.value - value);
        lag
    }

    /// Where it holds, goes on from another value.
    #[inline(always)]
    pub(crate) fn put(&mut self, holds: Sign, value: f32) {
        self.value = holds.select(value, self.value);
    }
}

/// First-order rate estimator: the lag of a filtered temperature behind the temperature.
///
/// ```text
/// d  = T - L              lag before this sample is taken in
/// L += alpha d
/// s += alpha (1 - s)      share of the filter's memory since the start, 1 - exp(-t / tau)
/// T' = d alpha / dt / max(s, 60 s / tau)
/// ```
///
/// On a steady ramp `d` settles at `rate * dt / alpha`, so `T'` is exact for every constant `dt`. After
/// the onset of a ramp it approaches as `1 - exp(-t / tau)`: the delay is `tau`. White noise of
/// standard deviation `sigma` on the temperature gives `sigma / tau` on the rate (0.018 degC/min for
/// a 0.0625 degC step and 60 s).
///
/// After power-on the filter has seen nothing but the time since, and a part may well be in the
/// middle of a ramp: dividing by `s` makes the rate exact for a ramp that lasts since before the
/// start. It is from then on a mean over the time since the start, which is why it is not trusted
/// with less than 60 s: in the first minute the rate fades in, and the noise is never more than
/// that of a filter of 60 s. Time constants up to that are not affected.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct RateEstimator {
    /// `L` \[degC\].
    filtered: Filter,
    /// `s`: a filter, too, of a step from 0 to 1.
    memory: Filter,
    /// `1 / max(s, 60 s / tau)`, by a step of Newton's method per update, which needs no division.
    /// What `s` moves in an update, `dt / t` of it at most, enters squared: `t` after the start the
    /// gain is short of the reciprocal by `(dt / t)^2`, 3e-4 after a minute of updates a second
    /// apart.
    gain: f32,
}

impl RateEstimator {
    pub(crate) const fn new(thermal: &Thermal, temp_c: f32) -> Self {
        Self {
            filtered: Filter::new(temp_c),
            memory: Filter::new(0.0),
            gain: 1.0 / thermal.least_memory,
        }
    }

    /// The rate of temperature \[degC/min\].
    ///
    /// A change that is no movement, such as the return of a sensor that was off, is passed on to
    /// the filtered temperature, and the rate goes on from what it was.
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        thermal: &Thermal,
        interval: &Interval,
        temp_c: f32,
        change_c: f32,
        moved: Sign,
    ) -> f32 {
        let filtered_c = self.filtered.value;
        self.filtered.value = moved.select(filtered_c, filtered_c + change_c);
        let lag_c = self.filtered.lag(interval.alpha, temp_c);

        self.memory.lag(interval.alpha, 1.0);
        let memory = at_least(self.memory.value, thermal.least_memory);
        // From below, Newton's method always converges; a step from far above would leave the
        // positive numbers.
        self.gain = at_least(self.gain * (2.0 - memory * self.gain), 1.0);
        lag_c * interval.rate_gain_per_min * self.gain
    }

    /// Where it holds, takes the ramp for one that has lasted for long at this rate \[degC/min\].
    #[inline(always)]
    pub(crate) fn put(&mut self, holds: Sign, thermal: &Thermal, temp_c: f32, rate_c_per_min: f32) {
        let lag_c = thermal.tau_min * rate_c_per_min;
        self.filtered.put(holds, temp_c - lag_c);
        self.memory.put(holds, 1.0);
    }

    /// What is left out of a full memory halves again and again. Below this it never counts: the sum
    /// of both stays 1.
    pub(crate) fn drop_tiny(&mut self) {
        if self.memory.value == 1.0 && self.memory.remainder.abs() < 1e-30 {
            self.memory.remainder = 0.0;
        }
    }
}

#[inline(always)]
fn at_least(value: f32, least: f32) -> f32 {
    select_unpredictable(value > least, value, least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Thermal, ThermalSettings};

    const MOVED: Sign = Sign(-1);

    /// The same estimator in f64, fed the same f32 temperatures.
    fn reference(thermal: &ThermalSettings, dt_s: f64, temps: impl Iterator<Item = f32>) -> f64 {
        let x = dt_s / f64::from(thermal.tau_s);
        let alpha = -(-x).exp_m1();
        let (mut filtered, mut memory, mut rate) = (None, 0.0, 0.0);
        for temp in temps.map(f64::from) {
            let lag = temp - filtered.unwrap_or(temp);
            filtered = Some(filtered.unwrap_or(temp) + alpha * lag);
            memory += alpha * (1.0 - memory);
            let least = f64::min(60.0 / f64::from(thermal.tau_s), 1.0);
            rate = lag * alpha / dt_s * 60.0 / f64::max(memory, least);
        }
        rate
    }

    /// The acceptance bound of the estimator: 1 % or 1e-4 degC/min, whichever is larger, for all
    /// usual sample rates, slow and fast ramps, cold and hot.
    #[test]
    fn agrees_with_f64_from_stagnating_to_steep_ramps() {
        let mut worst: f64 = 0.0;
        let (taus, rates) = (&[60.0, 600.0], &[1_u32, 10, 100, 1000]);
        // Miri is slow; the slowest rate takes every path.
        let few = cfg!(miri);
        for &tau_s in &taus[..if few { 1 } else { taus.len() }] {
            let settings = ThermalSettings {
                tau_s,
                ..ThermalSettings::DEFAULT
            };
            let thermal = Thermal::new(settings).unwrap();
            for &rate_hz in &rates[..if few { 1 } else { rates.len() }] {
                let dt_s = 1.0 / rate_hz as f32;
                let interval = Interval::new(&thermal, dt_s);
                for ramp in [0.001, 0.01, 0.1, 1.0, 10.0] {
                    for start in [-40.0, 25.0, 85.0] {
                        for direction in [1.0, -1.0] {
                            let samples = 150 * rate_hz;
                            let temps = move || {
                                (0..samples).map(move |i| {
                                    let minutes = f64::from(i) / f64::from(rate_hz) / 60.0;
                                    (start + direction * ramp * minutes) as f32
                                })
                            };
                            let mut estimator = RateEstimator::new(&thermal, start as f32);
                            let mut rate = 0.0;
                            for temp in temps() {
                                rate = estimator.update(&thermal, &interval, temp, 0.0, MOVED);
                            }
                            let expected = reference(&settings, f64::from(dt_s), temps());
                            let error = (f64::from(rate) - expected).abs();
                            let allowed = (0.01 * expected.abs()).max(1e-4);
                            assert!(
                                error <= allowed,
                                "{rate} for {expected} at {start} degC, {ramp} degC/min, \
                                 {rate_hz} Hz, tau {tau_s} s"
                            );
                            worst = worst.max(error / allowed);
                        }
                    }
                }
            }
        }
        // Far inside the bound: a regression shows before it becomes a failure in the field.
        assert!(worst < 0.05, "worst error is {worst} of the allowance");
    }

    #[test]
    fn a_shift_is_not_differentiated() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let interval = Interval::new(&thermal, 1.0);
        let mut estimator = RateEstimator::new(&thermal, -40.0);
        assert!(estimator.update(&thermal, &interval, 20.0, 60.0, MOVED) > 50.0);
        let mut estimator = RateEstimator::new(&thermal, -40.0);
        let mut rate = |moved| estimator.update(&thermal, &interval, 20.0, 60.0, moved);
        assert_eq!(rate(!MOVED), 0.0);
        assert_eq!(rate(MOVED), 0.0);
    }

    /// At 1 kHz and 6000 s a single f32 would stand still at four fifths.
    #[test]
    #[cfg_attr(miri, ignore = "millions of updates")]
    fn the_memory_does_not_stand_still() {
        let settings = ThermalSettings {
            tau_s: 6000.0,
            ..ThermalSettings::DEFAULT
        };
        let thermal = Thermal::new(settings).unwrap();
        let interval = Interval::new(&thermal, 1e-3);
        let mut estimator = RateEstimator::new(&thermal, 25.0);
        for _ in 0..6_000_000 {
            estimator.update(&thermal, &interval, 25.0, 0.0, MOVED);
        }
        let expected = 1.0 - (-1.0_f32).exp();
        assert!((estimator.memory.value - expected).abs() < 1e-5);
        assert!((estimator.gain * expected - 1.0).abs() < 1e-5);
    }

    #[test]
    #[cfg_attr(miri, ignore = "many updates")]
    fn what_is_tiny_changes_no_output() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let interval = Interval::new(&thermal, 1.0);
        let mut estimators = [(); 2].map(|()| RateEstimator::new(&thermal, 25.0));
        for update in 0..100_u16 * 60 {
            let temp_c = 25.0 + f32::from(update % 7) * 0.01;
            estimators[1].drop_tiny();
            let [kept, dropped] = estimators
                .each_mut()
                .map(|estimator| estimator.update(&thermal, &interval, temp_c, 0.0, MOVED));
            assert_eq!(kept.to_bits(), dropped.to_bits(), "{update}");
        }
        let left_out = estimators.map(|estimator| estimator.memory.remainder);
        assert!(left_out[0] != 0.0 && left_out[1] == 0.0, "{left_out:?}");
    }

    #[test]
    fn what_may_still_count_is_not_dropped() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        for (value, remainder) in [(1.0, 1e-20), (0.5, 1e-35)] {
            let memory = Filter { value, remainder };
            let mut estimator = RateEstimator::new(&thermal, 25.0);
            estimator.memory = memory;
            estimator.drop_tiny();
            assert_eq!(estimator.memory, memory);
        }
    }

    /// Newton's method by one step per update gets there whatever intervals come, in whatever
    /// order, and is never out of bounds on the way.
    #[test]
    fn the_correction_of_the_start_dies_out_whatever_the_intervals() {
        for tau_s in [0.1, 59.0, 600.0, 6000.0] {
            let settings = ThermalSettings {
                tau_s,
                ..ThermalSettings::DEFAULT
            };
            let thermal = Thermal::new(settings).unwrap();
            for first in [1e-5, 0.01, 0.1, 0.499, 0.5, 1e6] {
                let mut estimator = RateEstimator::new(&thermal, 25.0);
                let parts = [first, 1e-5, 0.5, 1e-5, first]
                    .into_iter()
                    .chain([0.1; 200]);
                for part in parts {
                    let interval = Interval::new(&thermal, part * tau_s);
                    estimator.update(&thermal, &interval, 25.0, 0.0, MOVED);
                    assert!((0.0..=1.0).contains(&estimator.memory.value));
                    let most = 1.000_001 / thermal.least_memory;
                    assert!(
                        estimator.gain >= 1.0 && estimator.gain <= most,
                        "{estimator:?}"
                    );
                }
                assert!((estimator.gain - 1.0).abs() < 1e-5, "{estimator:?}");
            }
        }
    }
}
