//! The time between two thermal updates, turned into integer factors.

use tempco::Status;

use crate::format::round_u64;
use crate::mask::Mask;
use crate::settings::{FixedThermal, LEAST_SLEW, TICKS_PER_S};

/// The time since the last thermal update, with the filter factors that follow from it; the
/// integer counterpart of [`tempco::Interval`], with the same meaning and the same series.
///
/// A fixed interval is best a constant, by [`new`](Self::new). Where the time is measured, use
/// [`from_micros`](Self::from_micros), which needs no floating point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedInterval {
    pub(crate) ticks: i32,
    /// The time, at most [`MOST_US`] \[2^-8 us\].
    pub(crate) time: u64,
    /// `1 - exp(-dt / tau)` \[2^-64\]; all ones restart.
    pub(crate) alpha: u64,
    /// Rate per degree of lag \[2^-22 / min\].
    pub(crate) gain: u32,
    /// How far the effective temperature may move in this time.
    pub(crate) slew: i32,
    /// Time has passed: 1, or 0.
    pub(crate) forward: i32,
    pub(crate) status: Status,
}

/// The longest time that is told from longer ones: 9.5 h, more than half of any time constant.
const MOST_US: i64 = 1 << 35;

impl FixedInterval {
    /// No time, or less than none: the rate stays what it was.
    pub(crate) const fn none(thermal: &FixedThermal) -> Self {
        Self {
            ticks: 0,
            time: 0,
            alpha: 0,
            gain: thermal.gain,
            slew: 0,
            forward: 0,
            status: Status::INTERVAL_INVALID,
        }
    }

    /// The interval of `dt_s` \[s\]; zero, negative, NaN and too long ones as in [`tempco`].
    ///
    /// Computes in f64: meant for constants and for power-on.
    pub const fn new(thermal: &FixedThermal, dt_s: f32) -> Self {
        // Not `dt_s <= 0`, which NaN would pass.
        let forward = dt_s > 0.0;
        if !forward {
            return Self::none(thermal);
        }
        let gap = dt_s > thermal.longest_s;
        let used_s = if gap { thermal.longest_s } else { dt_s } as f64;
        let x = round_u64(used_s / thermal.tau_s as f64 * ((1_u128 << 64) as f64));
        let ticks = (dt_s * TICKS_PER_S + 0.5) as i32;
        let time = round_u64(dt_s as f64 * 256e6);
        let most = (MOST_US as u64) << 8;
        let time = if time < most { time } else { most };
        Self::from_parts(thermal, (ticks, time), x, thermal.slew(used_s), gap)
    }

    /// The interval of `dt_us` \[us\], by integers alone; zero and negative ones count as no time.
    ///
    /// # Timing
    /// Does not depend on the data but for intervals that are not valid, which are shorter.
    #[inline]
    pub const fn from_micros(thermal: &FixedThermal, dt_us: i64) -> Self {
        /// `2^28 / 10`; the product below fits for all times up to [`MOST_US`].
        const TICKS_PER_US: i64 = (1 << 28) / 10 + 1;
        if dt_us <= 0 {
            return Self::none(thermal);
        }
        let gap = dt_us > thermal.longest_us as i64;
        let used_us = if gap {
            thermal.longest_us
        } else {
            dt_us as u32
        } as u64;
        let counted_us = if dt_us < MOST_US { dt_us } else { MOST_US };
        let ticks = (counted_us * TICKS_PER_US + (1 << 27)) >> 28;
        let ticks = if ticks > i32::MAX as i64 {
            i32::MAX as i64
        } else {
            ticks
        };
        let slew = (used_us * thermal.slew_per_us as u64 + (1 << 23)) >> 24;
        let slew = if slew > i32::MAX as u64 {
            i32::MAX as u64
        } else {
            slew
        } as i32;
        let slew = if slew < LEAST_SLEW { LEAST_SLEW } else { slew };
        let x = used_us.wrapping_mul(thermal.taus_per_us);
        let time = (counted_us as u64) << 8;
        Self::from_parts(thermal, (ticks as i32, time), x, slew, gap)
    }

    /// By the series of [`tempco::Interval`] in `x = dt / tau` \[2^-64\], at most 1/2.
    #[inline]
    const fn from_parts(
        thermal: &FixedThermal,
        (ticks, time): (i32, u64),
        x: u64,
        slew: i32,
        gap: bool,
    ) -> Self {
        let narrow = x >> 33;
        let inner = nest(narrow, 4, nest(narrow, 5, ONE));
        let alpha_per_x = nest(narrow, 2, nest(narrow, 3, inner));
        let alpha = product(x, alpha_per_x);
        let gain = (thermal.gain as u64 * alpha_per_x + (ONE >> 1)) >> 31;
        Self {
            ticks,
            time,
            alpha: if gap { u64::MAX } else { alpha },
            gain: if gap { 0 } else { gain as u32 },
            slew,
            forward: 1,
            status: if gap {
                Status::INTERVAL_INVALID
            } else {
                Status::OK
            },
        }
    }
}

/// 1 with 31 fractional bits, the format of the series.
const ONE: u64 = 1 << 31;

/// `ONE - x / divisor * factor`; the reciprocal has 32 fractional bits.
#[inline(always)]
const fn nest(x: u64, divisor: u64, factor: u64) -> u64 {
    ONE - ((((x * factor) >> 31) * (((1 << 32) + divisor / 2) / divisor)) >> 32)
}

/// `x factor`, both at most 1, in the format of `x` \[2^-64\]; wraps where it is 1.
#[inline(always)]
const fn product(x: u64, factor: u64) -> u64 {
    let upper = ((x >> 32) * factor).wrapping_mul(2);
    upper.wrapping_add(((x & 0xffff_ffff) * factor) >> 31)
}

/// A time constant of its own, no shorter than that of the settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct TimeConstant {
    /// Time constants per 2^-8 us \[2^-64\].
    per_time: u64,
    /// Half of it \[2^-8 us\].
    longest: u64,
}

impl TimeConstant {
    pub(crate) const fn new(tau_s: f32) -> Self {
        let tau = tau_s as f64 * 256e6;
        Self {
            per_time: round_u64((1_u128 << 64) as f64 / tau),
            longest: round_u64(0.5 * tau),
        }
    }

    /// `1 - exp(-dt / tau)` \[2^-64\] by the f32 core's series, and whether the interval is
    /// longer than half the time constant, where that means nothing.
    #[inline(always)]
    pub(crate) const fn alpha(&self, interval: &FixedInterval) -> (u64, Mask) {
        let x = interval.time.wrapping_mul(self.per_time);
        let narrow = x >> 33;
        let alpha = product(x, nest(narrow, 2, nest(narrow, 3, ONE)));
        let gap = Mask::negative_wide(self.longest as i64 - interval.time as i64);
        (alpha, gap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempco::{Thermal, ThermalSettings};

    fn thermal(tau_s: f32) -> FixedThermal {
        let settings = ThermalSettings {
            tau_s,
            ..ThermalSettings::DEFAULT
        };
        FixedThermal::new(&Thermal::new(settings).unwrap()).unwrap()
    }

    /// The series is the f32 core's; the integers add 2^-30 and the rounding of the gain.
    #[test]
    fn factors_agree_with_the_exponential_to_the_documented_error() {
        for tau_s in [0.1, 1.0, 60.0, 600.0, 6000.0] {
            let thermal = thermal(tau_s);
            for step in 1..=5000 {
                let dt_s = step as f32 * 1e-4 * tau_s;
                let dt_us = (f64::from(dt_s) * 1e6).round() as i64;
                let by_us = (
                    FixedInterval::from_micros(&thermal, dt_us),
                    dt_us as f64 * 1e-6,
                );
                let by_s = (FixedInterval::new(&thermal, dt_s), f64::from(dt_s));
                for (interval, dt_s) in [by_us, by_s] {
                    let x = dt_s / f64::from(tau_s);
                    let alpha = -(-x).exp_m1();
                    let allowed = if x <= 0.125 { 2e-7 } else { 6e-5 };
                    let error = interval.alpha as f64 / (u64::MAX as f64) / alpha - 1.0;
                    assert!(error.abs() < allowed, "alpha {error} at x {x}, tau {tau_s}");
                    let gain = alpha / dt_s * 60.0;
                    let error = f64::from(interval.gain) / 4_194_304.0 / gain - 1.0;
                    let rounding = 2.5e-9 * f64::from(tau_s) * 2.0;
                    assert!(
                        error.abs() < allowed + rounding,
                        "gain {error} at {x}, {tau_s}"
                    );
                }
            }
        }
    }

    #[test]
    fn other_time_constants_agree_with_the_exponential_and_know_their_gaps() {
        let thermal = thermal(0.1);
        for tau_s in [0.1_f32, 60.0, 1800.0, 60_000.0] {
            let slower = TimeConstant::new(tau_s);
            for share in [0.001, 0.05, 0.1, 0.3, 0.4999, 0.5001, 0.6, 1e6] {
                let x = f64::from(tau_s) * share;
                let by_us = FixedInterval::from_micros(&thermal, (x * 1e6).round() as i64);
                for interval in [by_us, FixedInterval::new(&thermal, x as f32)] {
                    let (alpha, gap) = slower.alpha(&interval);
                    assert_eq!(gap.count() == 1, share > 0.5, "{share}, {tau_s} s");
                    let error = alpha as f64 / (1_u128 << 64) as f64 / -(-share).exp_m1() - 1.0;
                    let allowed = if share > 0.1 { 6.1e-3 } else { 5e-5 };
                    assert!(
                        share > 0.5 || error.abs() < allowed,
                        "{error}, {share}, {tau_s} s"
                    );
                }
            }
            let none = slower.alpha(&FixedInterval::none(&thermal));
            assert_eq!((none.0, none.1.count()), (0, 0));
        }
    }

    #[test]
    fn both_ways_lead_to_the_same_interval() {
        let thermal = thermal(60.0);
        for dt_us in [
            250_i64, 1000, 10_000, 100_000, 1_000_000, 30_000_000, 31_000_000,
        ] {
            let by_us = FixedInterval::from_micros(&thermal, dt_us);
            let by_s = FixedInterval::new(&thermal, dt_us as f32 * 1e-6);
            assert_eq!(by_us.ticks, by_s.ticks, "{dt_us}");
            assert_eq!(by_us.status, by_s.status);
            assert!(by_us.gain.abs_diff(by_s.gain) <= 1);
            assert!(by_us.slew.abs_diff(by_s.slew) <= 1 + by_s.slew as u32 / 100_000);
            let alphas = by_us.alpha as f64 / by_s.alpha as f64;
            assert!((alphas - 1.0).abs() < 1e-7, "{dt_us}");
        }
    }

    #[test]
    fn impossible_and_long_intervals_are_flagged() {
        let thermal = thermal(60.0);
        let mut none = [0.0, -1.0, f32::NAN, f32::NEG_INFINITY]
            .map(|dt_s| FixedInterval::new(&thermal, dt_s))
            .to_vec();
        none.extend([0, -1, i64::MIN].map(|us| FixedInterval::from_micros(&thermal, us)));
        for interval in none {
            assert_eq!(interval, FixedInterval::none(&thermal));
        }
        let long = [
            (FixedInterval::new(&thermal, 30.001), 3_000_100),
            (FixedInterval::new(&thermal, f32::INFINITY), i32::MAX),
            (FixedInterval::from_micros(&thermal, 30_001_000), 3_000_100),
            (FixedInterval::from_micros(&thermal, i64::MAX), i32::MAX),
            (
                FixedInterval::from_micros(&thermal, 3_600_000_000),
                360_000_001,
            ),
        ];
        for (interval, ticks) in long {
            assert_eq!(interval.status, Status::INTERVAL_INVALID);
            assert!(interval.ticks.abs_diff(ticks) <= 40, "{}", interval.ticks);
            assert_eq!((interval.alpha, interval.gain), (u64::MAX, 0));
            assert!(interval.slew.abs_diff(15 << 20) < 200);
        }
        assert_eq!(FixedInterval::new(&thermal, 30.0).status, Status::OK);
        assert_eq!(
            FixedInterval::from_micros(&thermal, 30_000_000).status,
            Status::OK
        );
    }
}
