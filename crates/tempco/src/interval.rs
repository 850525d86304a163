//! The time between two thermal updates, turned into the factors the estimator needs.

use crate::settings::TICKS_PER_S;
use crate::sign::{Sign, magnitude};
use crate::{Status, Thermal};

/// A temperature near 150 degC has a last place of 1.5e-5 degC; a smaller step would vanish.
const LEAST_SLEW_C: f32 = 2e-5;

/// When the temperature is lost, what the rate and the history add fades out over this time, and
/// as slowly in again \[s\].
const FADE_S: f32 = 60.0;

/// `1 - exp(-x)` by `x (1 - x/2 (1 - x/3))`, whose relative error is below 6.1e-3 at `x = 1/2` and
/// below 5e-5 for `x <= 1/10`; 1 for larger `x`.
const fn second_alpha(x: f32) -> f32 {
    let alpha = x * (1.0 - x * (1.0 / 2.0) * (1.0 - x * (1.0 / 3.0)));
    Sign::above(magnitude(x), magnitude(0.5)).select_bits(1.0, alpha)
}

/// The time since the last thermal update, with the filter factors that follow from it.
///
/// A unit that samples its temperature at a fixed rate makes one constant of it; where the time
/// varies, make a new one for each update: that takes multiplications, sums and comparisons only.
///
/// With `x = dt / tau` the factors are `alpha = 1 - exp(-x)` and `alpha / dt`, by the series
/// `alpha / x = 1 - x/2 (1 - x/3 (1 - x/4 (1 - x/5)))`, whose relative error is below 6e-5 at the
/// limit `x = 1/2` and below 2e-7 for `x <= 1/8`. A longer interval restarts the estimator: what
/// the temperature did meanwhile is not known, and nothing is invented.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(C, align(8))]
pub struct Interval {
    pub(crate) ticks: i32,
    /// A change up to this is noise and movement of one interval \[bits of degC\].
    pub(crate) near: i32,
    pub(crate) alpha: f32,
    /// `alpha` of the second lag.
    pub(crate) alpha2: f32,
    /// How far the weight of rate and history may move in this time \[bits\].
    pub(crate) fade: i32,
    /// Rate of temperature per degree of lag \[1/min\].
    pub(crate) rate_gain_per_min: f32,
    /// How far the lag-compensated temperature may move in this time \[bits of degC\].
    pub(crate) slew: i32,
    /// Largest accepted jump, without what the part can have moved \[degC\]. Negative infinity if
    /// no time has passed: a temperature without time is not accepted.
    pub(crate) gate_c: f32,
    pub(crate) status: Status,
}

impl Interval {
    /// The interval of `dt_s` \[s\] for the given thermal settings.
    ///
    /// Zero, negative and NaN count as no time at all, and the temperature that comes with them is
    /// not accepted; once the temperature is lost, the next one may confirm it. They and intervals beyond [`Thermal::longest_interval_s`] set
    /// [`Status::INTERVAL_INVALID`].
    #[inline]
    pub const fn new(thermal: &Thermal, dt_s: f32) -> Self {
        let forward = dt_s > 0.0;
        let longest_s = thermal.longest_interval_s();
        let real_s = if forward { dt_s } else { 0.0 };
        let gap = Sign::above(magnitude(real_s), magnitude(longest_s));
        // The same comparison, of floats: the solvers do not find the slew behind that of bits.
        let used_s = if real_s > longest_s {
            longest_s
        } else {
            real_s
        };
        let x = used_s * thermal.per_tau_hz;
        let alpha_per_x = 1.0
            - x * (1.0 / 2.0) * (1.0 - x * (1.0 / 3.0) * (1.0 - x * (1.0 / 4.0) * (1.0 - x * 0.2)));
        let slew_c = thermal.settings.max_slew_c_per_min * used_s * (1.0 / 60.0);
        let vanishes = forward & (slew_c < LEAST_SLEW_C);
        let slew_c = if vanishes { LEAST_SLEW_C } else { slew_c };
        let gate_c = if forward {
            thermal.settings.spike_gate_c
        } else {
            f32::NEG_INFINITY
        };
        Self {
            // The conversion saturates.
            ticks: (real_s * TICKS_PER_S + 0.5) as i32,
            alpha: gap.select_bits(1.0, x * alpha_per_x),
            alpha2: second_alpha(real_s * thermal.per_tau2_hz),
            fade: magnitude(real_s * (1.0 / FADE_S)),
            rate_gain_per_min: gap.select_bits(0.0, 60.0 * thermal.per_tau_hz * alpha_per_x),
            slew: magnitude(slew_c),
            near: (gate_c + slew_c).to_bits() as i32,
            gate_c,
            status: Status::INTERVAL_INVALID.when(gap.holds() | !forward),
        }
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
        for step in (1..=5000).step_by(if cfg!(miri) { 49 } else { 1 }) {
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
    fn the_share_of_the_second_lag_agrees_with_the_exponential_to_the_documented_error() {
        for tau2_s in [0.1_f32, 60.0, 1800.0, 60_000.0] {
            let settings = ThermalSettings {
                tau2_s,
                ..ThermalSettings::DEFAULT
            };
            let thermal = Thermal::new(settings).unwrap();
            for step in (1..5000).step_by(if cfg!(miri) { 49 } else { 1 }) {
                let dt_s = step as f32 * 1e-4 * tau2_s;
                let x = f64::from(dt_s) / f64::from(tau2_s);
                let alpha2 = f64::from(Interval::new(&thermal, dt_s).alpha2);
                let error = alpha2 / -(-x).exp_m1() - 1.0;
                let allowed = if x <= 0.1 { 5e-5 } else { 6.1e-3 };
                assert!(error.abs() < allowed, "{error} at x {x}");
            }
            for gap_s in [0.500_1 * tau2_s, 1e9, f32::INFINITY] {
                assert_eq!(Interval::new(&thermal, gap_s).alpha2, 1.0);
            }
            for none_s in [f32::NAN, 0.0, -1.0] {
                assert_eq!(Interval::new(&thermal, none_s).alpha2, 0.0);
            }
        }
    }

    #[test]
    fn impossible_and_long_intervals_are_flagged() {
        for dt_s in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
            let interval = Interval::new(&THERMAL, dt_s);
            assert_eq!(interval.status, Status::INTERVAL_INVALID);
            assert_eq!((interval.ticks, interval.alpha), (0, 0.0));
            assert_eq!(interval.gate_c, f32::NEG_INFINITY);
        }
        for (dt_s, ticks) in [
            (30.001, 3_000_100),
            (1e9, i32::MAX),
            (f32::INFINITY, i32::MAX),
        ] {
            let interval = Interval::new(&THERMAL, dt_s);
            assert_eq!(interval.status, Status::INTERVAL_INVALID);
            assert_eq!((interval.ticks, interval.alpha), (ticks, 1.0));
            assert_eq!(interval.rate_gain_per_min, 0.0);
            assert!((f32::from_bits(interval.slew as u32) - 15.0).abs() < 1e-5);
        }
        assert_eq!(Interval::new(&THERMAL, 30.0).status, Status::OK);
    }
}
