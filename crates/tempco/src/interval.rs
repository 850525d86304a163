//! The time between two thermal updates, turned into the factors the estimator needs.

use crate::{Status, Thermal};

/// The time since the last thermal update, with the filter factors that follow from it.
///
/// A unit that samples its temperature at a fixed rate makes one constant of it; where the time
/// varies, make a new one for each update: that takes only multiplications and subtractions.
///
/// With `x = dt / tau` the factors are `alpha = 1 - exp(-x)` and `alpha / dt`, by the series
/// `alpha / x = 1 - x/2 (1 - x/3 (1 - x/4 (1 - x/5)))`, whose relative error is below 6e-5 at the
/// limit `x = 1/2` and below 1e-7 for `x <= 1/8`. A longer interval restarts the estimator: what
/// the temperature did meanwhile is not known, and nothing is invented.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Interval {
    pub(crate) dt_s: f32,
    pub(crate) alpha: f32,
    /// Rate of temperature per degree of lag \[1/min\].
    pub(crate) rate_gain_per_min: f32,
    /// How far the temperature may move in this time \[degC\].
    pub(crate) slew_c: f32,
    pub(crate) restart: bool,
    pub(crate) status: Status,
}

/// A temperature near 150 degC has a last place of 1.5e-5 degC; a smaller step would vanish.
const LEAST_SLEW_C: f32 = 2e-5;

impl Interval {
    /// The first update after power-on: no time has passed and nothing needs to ramp.
    pub(crate) const POWER_ON: Self = Self {
        dt_s: 0.0,
        alpha: 0.0,
        rate_gain_per_min: 0.0,
        slew_c: f32::INFINITY,
        restart: true,
        status: Status::OK,
    };

    /// The interval of `dt_s` \[s\] for the given thermal settings.
    ///
    /// Zero, negative and NaN count as no time at all; they and intervals beyond
    /// [`Thermal::longest_interval_s`] set [`Status::INTERVAL_INVALID`].
    pub const fn new(thermal: &Thermal, dt_s: f32) -> Self {
        let positive = dt_s > 0.0;
        let longest_s = thermal.longest_interval_s();
        let restart = dt_s > longest_s;
        let dt_s = if restart {
            longest_s
        } else if positive {
            dt_s
        } else {
            0.0
        };
        let x = dt_s * thermal.per_tau_hz;
        let slew_c = thermal.settings.max_slew_c_per_min * dt_s * (1.0 / 60.0);
        let alpha_per_x = 1.0
            - x * (1.0 / 2.0) * (1.0 - x * (1.0 / 3.0) * (1.0 - x * (1.0 / 4.0) * (1.0 - x * 0.2)));
        Self {
            dt_s,
            alpha: x * alpha_per_x,
            rate_gain_per_min: 60.0 * thermal.per_tau_hz * alpha_per_x,
            slew_c: if positive & (slew_c < LEAST_SLEW_C) {
                LEAST_SLEW_C
            } else {
                slew_c
            },
            restart,
            status: Status::INTERVAL_INVALID.when(restart || !positive),
        }
    }

    /// The time used \[s\]: what was given, limited to `0..=`[`Thermal::longest_interval_s`].
    pub const fn dt_s(&self) -> f32 {
        self.dt_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThermalSettings;

    const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
        Ok(thermal) => thermal,
        Err(_) => panic!(),
    };

    #[test]
    fn factors_agree_with_the_exponential_to_the_documented_error() {
        for step in 1..=5000 {
            let dt_s = step as f32 * 0.006;
            let interval = Interval::new(&THERMAL, dt_s);
            let x = f64::from(dt_s) / f64::from(ThermalSettings::DEFAULT.tau_s);
            let alpha = -(-x).exp_m1();
            let allowed = if x <= 0.125 { 2e-7 } else { 6e-5 };
            let error = f64::from(interval.alpha) / alpha - 1.0;
            assert!(error.abs() < allowed, "alpha {error} at x {x}");
            let gain = alpha / f64::from(dt_s) * 60.0;
            let error = f64::from(interval.rate_gain_per_min) / gain - 1.0;
            assert!(error.abs() < allowed, "gain {error} at x {x}");
        }
    }

    #[test]
    fn impossible_and_long_intervals_are_flagged() {
        for dt_s in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
            let interval = Interval::new(&THERMAL, dt_s);
            assert_eq!(interval.status, Status::INTERVAL_INVALID);
            assert_eq!((interval.dt_s, interval.alpha), (0.0, 0.0));
            assert!(!interval.restart);
        }
        for dt_s in [30.001, 1e9, f32::INFINITY] {
            let interval = Interval::new(&THERMAL, dt_s);
            assert_eq!(interval.status, Status::INTERVAL_INVALID);
            assert_eq!(interval.dt_s, 30.0);
            assert!(interval.restart);
        }
        assert_eq!(Interval::new(&THERMAL, 30.0).status, Status::OK);
    }
}
