//! Estimates the rate of temperature, causally and without stagnation.

use crate::interval::Interval;
use crate::sign::Sign;

/// First-order rate estimator: the lag of a filtered temperature behind the temperature.
///
/// ```text
/// d  = T - L              lag before this sample is taken in
/// L += alpha d
/// T' = d alpha / dt
/// ```
///
/// On a steady ramp `d` settles at `rate * dt / alpha`, so `T'` is exact for every constant `dt`. After
/// the onset of a ramp it approaches as `1 - exp(-t / tau)`: the delay is `tau`. White noise of
/// standard deviation `s` on the temperature gives `s / tau` on the rate (0.018 degC/min for
/// a 0.0625 degC step and 60 s).
///
/// The filtered temperature is kept as a sum of two f32. With one, the increments of a slow ramp
/// vanish below its last place: at 1 kHz, 60 s and 70 degC a ramp of 0.02 degC/min reads 0.1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct RateEstimator {
    filtered_c: f32,
    /// What rounding left out of `filtered_c` \[degC\].
    remainder_c: f32,
}

impl RateEstimator {
    pub(crate) const fn new(temp_c: f32) -> Self {
        Self {
            filtered_c: temp_c,
            remainder_c: 0.0,
        }
    }

    /// The rate of temperature \[degC/min\].
    ///
    /// A change that is no movement, such as the return of a sensor that was off, is passed on to
    /// the filtered temperature, and the rate goes on from what it was.
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        interval: &Interval,
        temp_c: f32,
        change_c: f32,
        moved: Sign,
    ) -> f32 {
        let filtered_c = moved.select(self.filtered_c, self.filtered_c + change_c);
        let lag_c = (temp_c - filtered_c) - self.remainder_c;
        let increment_c = interval.alpha * lag_c + self.remainder_c;
        self.filtered_c = filtered_c + increment_c;
        self.remainder_c = increment_c - (self.filtered_c - filtered_c);
        lag_c * interval.rate_gain_per_min
    }
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
        let (mut filtered, mut rate) = (None, 0.0);
        for temp in temps.map(f64::from) {
            let lag = temp - filtered.unwrap_or(temp);
            filtered = Some(filtered.unwrap_or(temp) + alpha * lag);
            rate = lag * alpha / dt_s * 60.0;
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
                            let mut estimator = RateEstimator::new(start as f32);
                            let mut rate = 0.0;
                            for temp in temps() {
                                rate = estimator.update(&interval, temp, 0.0, MOVED);
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
        let interval = Interval::new(&Thermal::new(ThermalSettings::DEFAULT).unwrap(), 1.0);
        let mut estimator = RateEstimator::new(-40.0);
        assert!(estimator.update(&interval, 20.0, 60.0, MOVED) > 50.0);
        let mut estimator = RateEstimator::new(-40.0);
        assert_eq!(estimator.update(&interval, 20.0, 60.0, !MOVED), 0.0);
        assert_eq!(estimator.update(&interval, 20.0, 60.0, MOVED), 0.0);
    }
}
