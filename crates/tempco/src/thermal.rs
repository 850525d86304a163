//! The thermal path shared by all axes of a unit, to the point at which the bias model is evaluated.

use core::hint::select_unpredictable;

use crate::conditioner::Conditioner;
use crate::estimator::RateEstimator;
use crate::history::{PlayState, SecondLagState};
use crate::settings::PLAYS;
use crate::sign::{Sign, limit, magnitude};
use crate::{Interval, Status, Thermal};

/// What the bias model is evaluated at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalPoint {
    /// Lag-compensated temperature `u` \[degC\].
    pub effective_c: f32,
    /// Rate of temperature, clamped to the calibrated range \[degC/min\].
    pub rate_c_per_min: f32,
    /// Second lag `d2`, clamped to the calibrated range \[degC\].
    pub lag2_c: f32,
    /// What each play is behind, `v - c` \[degC\].
    pub plays_c: [f32; PLAYS],
    /// Flags of the temperature.
    pub status: Status,
}

/// The state of the thermal path: conditioner, estimator, lag-compensated temperature, history.
///
/// Used on its own by the fit, which thereby sees the very regressors that fly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalState {
    conditioner: Conditioner,
    estimator: RateEstimator,
    second: SecondLagState,
    plays: PlayState,
    /// Time until rate, second lag and plays are put, below zero \[ticks\].
    starting: i32,
    effective_c: f32,
    /// What rate and history count for, 0 to 1: nothing while the temperature is lost.
    weight: f32,
}

impl ThermalState {
    /// The state before any temperature was seen: lost, at the reference temperature.
    pub const fn new(thermal: &Thermal) -> Self {
        let reference_c = thermal.settings.reference_c;
        Self {
            weight: 0.0,
            ..Self::at(thermal, reference_c)
        }
    }

    /// The state of a part that has been at this temperature for long \[degC\].
    const fn at(thermal: &Thermal, temp_c: f32) -> Self {
        Self {
            conditioner: Conditioner::new(temp_c),
            estimator: RateEstimator::new(thermal, temp_c),
            second: SecondLagState::new(temp_c),
            plays: PlayState::new(temp_c),
            starting: thermal.start,
            effective_c: temp_c,
            weight: 1.0,
        }
    }

    /// Starts at the first temperature after power-on, without the ramp from the reference
    /// temperature that a return in flight makes. One that the sensor cannot report leaves the
    /// state lost; any other is accepted, so take care that it is good, for instance the median of
    /// several readings.
    pub fn start(&mut self, thermal: &Thermal, temp_c: f32) -> ThermalPoint {
        let Some(conditioner) = Conditioner::start(thermal, temp_c) else {
            *self = Self::new(thermal);
            self.conditioner.rejected = 1;
            return ThermalPoint {
                effective_c: self.effective_c,
                status: Status::TEMPERATURE_INVALID | Status::TEMPERATURE_LOST | Status::SETTLING,
                ..ThermalPoint::default()
            };
        };
        *self = Self {
            conditioner,
            ..Self::at(thermal, temp_c)
        };
        ThermalPoint {
            effective_c: temp_c,
            status: Status::SETTLING,
            ..ThermalPoint::default()
        }
    }

    /// Takes one temperature \[degC\], `interval` after the one before; NaN where there is none.
    ///
    /// The lag-compensated temperature moves by no more than the maximum slew, whatever is passed in.
    /// Where the temperature is held, the rate decays with the time constant of the estimator.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn update(&mut self, thermal: &Thermal, interval: &Interval, temp_c: f32) -> ThermalPoint {
        let settings = &thermal.settings;
        let conditioned = self.conditioner.update(thermal, interval, temp_c);
        let rate = self.estimator.update(
            thermal,
            interval,
            conditioned.temp_c,
            conditioned.change_c,
            conditioned.moved,
        );
        let in_range = |rate| {
            let (min, max) = (settings.rate_min_c_per_min, settings.rate_max_c_per_min);
            clamp(rate, min, max, Status::RATE_CLAMPED)
        };
        let (rate, rate_clamped) = in_range(rate);

        // A unit that is switched on in a ramp has been in it.
        let starting = self.starting.saturating_add(interval.ticks);
        let starts = Sign(self.starting) & !Sign(starting) & !conditioned.lost;
        self.starting = starting;
        let (start_rate, _) = in_range(settings.rate_start * rate);
        let rate = starts.select(start_rate, rate);
        self.estimator
            .put(starts, thermal, conditioned.temp_c, rate);

        let start_c = settings.lag2_start_min * rate;
        let (lag2_c, lag2_clamped) = clamp(
            self.second.update(interval, &conditioned, starts, start_c),
            settings.lag2_min_c,
            settings.lag2_max_c,
            thermal.lag2_flag,
        );

        // While the temperature is lost they fade out, so that the constant bias is left.
        let weight = conditioned.lost.select(0.0, 1.0);
        self.weight += limit(weight - self.weight, interval.fade);
        let fading = Sign::above(magnitude(1.0), magnitude(self.weight));

        let temp_c = conditioned.temp_c;
        let measured_c = temp_c - thermal.shift_min * rate - settings.kappa2 * lag2_c;
        let target_c = conditioned.lost.select(settings.reference_c, measured_c);
        let way_c = target_c - self.effective_c;
        let ramping = Sign::above(magnitude(way_c), interval.near);
        self.effective_c += limit(way_c, interval.slew);

        let drag_c = temp_c - thermal.play_shift_min * rate - settings.play_kappa2 * lag2_c;
        let start_c = settings.play_start_min * rate;
        let (plays_c, unknown) =
            self.plays
                .update(thermal, interval, &conditioned, drag_c, starts, start_c);

        let settling = conditioned.settling | ramping | fading | Sign(self.starting);
        ThermalPoint {
            effective_c: self.effective_c,
            rate_c_per_min: rate * self.weight,
            lag2_c: lag2_c * self.weight,
            plays_c: plays_c.map(|play_c| play_c * self.weight),
            status: interval.status
                | rate_clamped
                | lag2_clamped
                | Status::HISTORY_UNKNOWN.where_holds(unknown)
                | Status::TEMPERATURE_JUMPED.where_holds(conditioned.jumped)
                | Status::of([
                    conditioned.impossible,
                    conditioned.spike,
                    conditioned.lost,
                    settling,
                ]),
        }
    }

    /// Makes zero of numbers that are too small to change any output. An x86 is slow with them, so
    /// a long run on a host calls this from time to time.
    pub fn drop_tiny(&mut self) {
        self.estimator.drop_tiny();
    }

    /// Temperatures rejected since the start (wraps at 2^32).
    pub const fn rejected(&self) -> u32 {
        self.conditioner.rejected
    }

    /// Restarts of the estimator since the start, the first one included (wraps at 2^32).
    pub const fn restarts(&self) -> u32 {
        self.conditioner.restarts
    }
}

/// `value` within `min..=max`, and `flag` if it was not.
#[inline(always)]
pub(crate) fn clamp(value: f32, min: f32, max: f32, flag: Status) -> (f32, Status) {
    let limited = select_unpredictable(value < min, min, value);
    let limited = select_unpredictable(limited > max, max, limited);
    (limited, flag.when(limited != value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThermalSettings;

    /// At one temperature, what rounding left out of it stays in the filter.
    #[test]
    fn dropping_what_is_tiny_changes_no_output() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let second = Interval::new(&thermal, 1.0);
        let mut state = ThermalState::new(&thermal);
        state.start(&thermal, 20.0);
        let mut dropped = state;
        for number in 0..5000 {
            let temp_c = if number == 0 { 20.5 } else { 20.0 };
            let point = state.update(&thermal, &second, temp_c);
            dropped.drop_tiny();
            assert_eq!(dropped.update(&thermal, &second, temp_c), point);
        }
        assert_ne!(dropped, state, "something was dropped");
    }

    /// A start without a temperature is short for an update in no time without one: all that follows
    /// is the same, and it counts as rejected.
    #[test]
    fn a_start_without_a_temperature_is_an_update_without_one() {
        for tau_s in [0.1, 59.0, 77.7, 600.0, 6000.0] {
            let settings = ThermalSettings {
                tau_s,
                lag2_max_c: 5.0,
                half_width1_c: 1.0,
                rate_start: 1.5,
                ..ThermalSettings::DEFAULT
            };
            let thermal = Thermal::new(settings).unwrap();
            let mut updated = ThermalState::new(&thermal);
            let no_time = Interval::new(&thermal, 0.0);
            let expected = updated.update(&thermal, &no_time, f32::NAN);
            let mut started = updated;
            started.start(&thermal, 40.0);
            let point = started.start(&thermal, f32::INFINITY);
            let status = Status::TEMPERATURE_INVALID | Status::TEMPERATURE_LOST | Status::SETTLING;
            assert_eq!(point, ThermalPoint { status, ..expected });
            let tenth = Interval::new(&thermal, 0.1 * tau_s);
            for number in 0..100_u16 {
                let is_there = number % 9 > 2;
                let temp_c = if is_there {
                    20.0 + f32::from(number)
                } else {
                    f32::NAN
                };
                let expected = updated.update(&thermal, &tenth, temp_c);
                assert_eq!(started.update(&thermal, &tenth, temp_c), expected);
                assert_eq!(started.rejected(), updated.rejected());
                assert_eq!(started.restarts(), updated.restarts());
            }
        }
    }
}
