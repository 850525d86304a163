//! Estimates the rate of temperature, causally and without stagnation.

use crate::mask::{Mask, limit, max};
use crate::{FixedInterval, FixedThermal};

/// How far a first-order filter is behind, without the filter:
///
/// ```text
/// d  = d' + movement      lag before this sample is taken in
/// d' = d (1 - alpha)      what is left of it for the next one
/// ```
///
/// which is the recursion `d = T - L`, `L += alpha d` of the f32 core.
///
/// The lag is an i64 of 2^-51 degC, 4.4e-16. Each update rounds it down by at most that, so at
/// steady state it is off by at most that over alpha: 1e-8 degC at 4 kHz and a time constant of
/// 6000 s. No ramp is so slow that it would stand still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Lag {
    /// \[2^-51 degC\]
    residual: i64,
}

impl Lag {
    /// Lags are limited to 2048 degC, more than any sensor's range, so that no sequence of
    /// movements and jumps can overflow.
    const LIMIT: i32 = 1 << 30;

    pub(crate) const NONE: Self = Self { residual: 0 };

    /// Takes a movement \[2^-20 degC\] and returns the lag before it is taken in, as upper and
    /// lower word.
    #[inline(always)]
    pub(crate) fn update(&mut self, alpha: u64, movement: i32) -> (i32, u32) {
        // At most 2048 degC and 2048 of the 4096 that fit.
        let lag = self.residual + (i64::from(movement) << 31);
        let lower = lag as u32;
        let upper = limit((lag >> 32) as i32, Self::LIMIT);
        let lag = (i64::from(upper) << 32) | i64::from(lower);

        let alpha = ((alpha >> 32) as u32, alpha as u32);
        let increment =
            times(upper, lower, alpha.0) + ((i64::from(upper) * i64::from(alpha.1)) >> 32);
        self.residual = lag - increment;
        (upper, lower)
    }

    /// What is left of the lag \[2^-20 degC\], at most 2048 degC.
    #[inline(always)]
    pub(crate) const fn left(self) -> i64 {
        (self.residual + (1 << 30)) >> 31
    }

    /// The lag where something holds, else none.
    #[inline(always)]
    pub(crate) const fn keep(self, mask: Mask) -> Self {
        let upper = mask.keep((self.residual >> 32) as i32);
        let lower = mask.keep(self.residual as i32) as u32;
        Self {
            residual: ((upper as i64) << 32) | lower as i64,
        }
    }
}

/// The first-order rate estimator of the f32 core, kept as its lag:
///
/// ```text
/// f -= alpha f            share of the filter's memory from before the start
/// T' = d alpha / dt / max(1 - f, 60 s / tau)
/// ```
///
/// Where the temperature jumps without moving (a sensor that returns), there is no movement, and
/// the rate goes on from what it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct RateEstimator {
    lag: Lag,
    /// `f` \[2^-64\].
    unknown: u64,
    /// `1 / max(1 - f, 60 s / tau)` by a step of Newton's method per update \[2^-24\].
    correction: i32,
}

/// A correction of 1.
const UNCORRECTED: i32 = 1 << 24;

impl RateEstimator {
    pub(crate) const fn new(thermal: &FixedThermal) -> Self {
        Self {
            lag: Lag::NONE,
            unknown: u64::MAX,
            correction: thermal.most_correction,
        }
    }

    /// The rate of temperature \[2^-41 degC/min\] after a movement \[2^-20 degC\].
    #[inline]
    pub(crate) fn update(
        &mut self,
        thermal: &FixedThermal,
        interval: &FixedInterval,
        movement: i32,
    ) -> i64 {
        let (lag, lower) = self.lag.update(interval.alpha, movement);

        // Less than 2^-32 of it may as well stay.
        let unknown = u64::from((self.unknown >> 32) as u32);
        let alpha = (interval.alpha >> 32, interval.alpha & 0xffff_ffff);
        self.unknown -= unknown * alpha.0 + ((unknown * alpha.1) >> 32);
        let memory = (!((self.unknown >> 32) as u32) >> 1) as i32;
        let memory = max(memory, thermal.least_memory);

        let correction = i64::from(self.correction);
        // Rounded, so that 1 times 1, which is a last place less than 1, is 1.
        let product = (i64::from(memory) * correction + (1 << 31)) >> 32;
        let corrected = (correction * ((1 << 24) - product)) >> 23;
        let below = Mask::negative_wide(corrected - i64::from(UNCORRECTED));
        self.correction = below.pick(UNCORRECTED, corrected as i32);

        // Of time constants beyond 60 s the gain is at most 1, so the product fits.
        let gain = u64::from(interval.gain) * self.correction as u64;
        times(lag, lower, ((gain + (1 << 23)) >> 24) as u32)
    }
}

/// `(upper 2^32 + lower) factor / 2^32`, rounded down.
#[inline(always)]
fn times(upper: i32, lower: u32, factor: u32) -> i64 {
    let low = (u64::from(lower) * u64::from(factor)) >> 32;
    i64::from(upper) * i64::from(factor) + low as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FixedThermal;
    use tempco::{Thermal, ThermalSettings};

    fn to_rate(rate: i64) -> f64 {
        rate as f64 / (1_u64 << 41) as f64
    }

    /// The f32 core's bound is 1 % or 1e-4 degC/min; here the series' 6e-5, the rounding of the
    /// gain, and one last place of the lag are all that is left.
    #[test]
    fn agrees_with_f64_from_stagnating_to_steep_ramps() {
        for tau_s in [0.1_f32, 60.0, 600.0, 6000.0] {
            let settings = ThermalSettings {
                tau_s,
                ..ThermalSettings::DEFAULT
            };
            let thermal = FixedThermal::new(&Thermal::new(settings).unwrap()).unwrap();
            for rate_hz in [1_u32, 10, 100, 4000] {
                let dt_s = 1.0 / rate_hz as f32;
                if dt_s > 0.5 * tau_s {
                    continue;
                }
                let interval = FixedInterval::new(&thermal, dt_s);
                let alpha = -(-f64::from(dt_s) / f64::from(tau_s)).exp_m1();
                let gain = alpha / f64::from(dt_s) * 60.0;
                for ramp in [1e-4, -0.01, 1.0, -20.0] {
                    let temp = |i: u32| {
                        (ramp / 60.0 * f64::from(i) * f64::from(dt_s) * 1_048_576.0).round() as i32
                    };
                    let (mut residual, mut largest) = (0.0, 0.0_f64);
                    let (mut memory, least) = (0.0, f64::min(60.0 / f64::from(tau_s), 1.0));
                    let mut estimator = RateEstimator::new(&thermal);
                    for i in 1..=200 * rate_hz {
                        let movement = temp(i) - temp(i - 1);
                        let lag = residual + f64::from(movement) / 1_048_576.0;
                        residual = lag - alpha * lag;
                        memory += alpha * (1.0 - memory);
                        let expected = gain * lag / f64::max(memory, least);
                        largest = largest.max(expected.abs());
                        let rate = to_rate(estimator.update(&thermal, &interval, movement));
                        let error = (rate - expected).abs();
                        // A step of Newton's method leaves the square of what the memory moved.
                        let moved = if memory > least {
                            1.0 / f64::from(i)
                        } else {
                            0.0
                        };
                        let relative = 6.5e-5 + 2.5e-9 * f64::from(tau_s) + 1.1 * moved * moved;
                        let allowed = relative * largest + 1e-9;
                        assert!(
                            error <= allowed,
                            "{error} of {expected} at {ramp}, {rate_hz} Hz, {tau_s} s"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn no_sequence_of_movements_overflows() {
        let thermal = FixedThermal::new(&Thermal::new(ThermalSettings::DEFAULT).unwrap()).unwrap();
        for direction in [1, -1] {
            let mut estimator = RateEstimator::new(&thermal);
            let mut last = 0.0;
            for _ in 0..10_000 {
                let interval = FixedInterval::new(&thermal, 1e-5);
                last = to_rate(estimator.update(&thermal, &interval, direction * (1273 << 20)));
            }
            assert!((last / f64::from(direction) - 2048.0).abs() < 1.0, "{last}");
            let gap = FixedInterval::new(&thermal, 100.0);
            assert_eq!(estimator.update(&thermal, &gap, 0), 0);
            let second = FixedInterval::new(&thermal, 1.0);
            assert!(
                estimator.update(&thermal, &second, 0).abs() < 4,
                "a gap forgets the lag"
            );
        }
    }
}
