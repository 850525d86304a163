//! Terms of the bias that depend on where the temperature has been: hysteresis and a second lag.
//!
//! A table has none of them unless its set selected them, and without them they cost nothing: no
//! state, no instruction.
//!
//! They follow the lag-compensated temperature, faults and all: while it ramps to the reference because
//! the temperature was lost, so do the contact and, in its time, the lagging part. Each term is
//! bounded by its gain and its half width or limit, and moves no faster than the
//! lag-compensated temperature, so that neither a fault nor a return makes a step. After an
//! interval of more than half its time constant a lag begins again at zero.

use core::hint::select_unpredictable;

use crate::error::{MAX_COEFFICIENT, is_within};
use crate::estimator::Filter;
use crate::interval::slower_alpha;
use crate::sign::{limit, magnitude};
use crate::{Interval, TableError};

/// A hysteresis term: the lag-compensated temperature drags a contact along, as through a slot.
///
/// ```text
/// c  = min(max(c, u - w), u + w)          the contact follows at a distance of w at most [degC]
/// B += gain (u - c)
/// ```
///
/// The bias then runs through a loop that is `2 w gain` high, whether the temperature cycles fast or
/// slowly (play operator; Prandtl, Krasnosel'skii).
/// After power-on the contact is taken to be where the temperature is: the term fades in over the
/// first `2 w` of movement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Play<const AXES: usize> {
    /// Half of the slot's width, `w`, 0 to 1000 \[degC\].
    pub half_width_c: f32,
    /// \[unit of each axis per degC\]
    pub gain: [f32; AXES],
}

/// A second thermal lag: a part of the unit that is slower than the rate estimator.
///
/// ```text
/// S += alpha (u - S)                      the part's temperature [degC]
/// B += gain min(max(u - S, -limit), limit)
/// ```
///
/// with `alpha = 1 - exp(-dt / tau)`. After power-on the part is taken to be where the
/// temperature is, and so it is after an interval of more than half its time constant: the term
/// fades in with that time constant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlowPart<const AXES: usize> {
    /// Its time constant \[s\], from the rate estimator's to 60000.
    pub tau_s: f32,
    /// The largest lag that was calibrated, 0 to 1000 \[degC\].
    pub limit_c: f32,
    /// \[unit of each axis per degC\]
    pub gain: [f32; AXES],
}

/// Checked history terms of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct History<const AXES: usize, const PLAYS: usize = 0, const SLOW: usize = 0> {
    plays: [Play<AXES>; PLAYS],
    slow_parts: [SlowPart<AXES>; SLOW],
    per_tau_hz: [f32; SLOW],
}

/// What the history terms multiply their gains by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HistoryPoint<const PLAYS: usize, const SLOW: usize> {
    /// `u - c` of each play \[degC\].
    pub plays_c: [f32; PLAYS],
    /// Each second thermal lag, within its limit \[degC\].
    pub lags_c: [f32; SLOW],
}

/// The state of the history terms.
///
/// Used on its own by the fit, which thereby sees the very regressors that fly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HistoryState<const PLAYS: usize, const SLOW: usize> {
    contacts_c: [f32; PLAYS],
    slow_parts: [Filter; SLOW],
}

impl<const AXES: usize, const PLAYS: usize, const SLOW: usize> History<AXES, PLAYS, SLOW> {
    /// Checks the terms; `tau_s` is the time constant of the rate estimator they go with \[s\].
    ///
    /// # Errors
    /// Names the first figure that is not finite or out of its range.
    pub const fn new(
        tau_s: f32,
        plays: [Play<AXES>; PLAYS],
        slow_parts: [SlowPart<AXES>; SLOW],
    ) -> Result<Self, TableError> {
        let mut i = 0;
        while i < PLAYS {
            if !is_within(plays[i].half_width_c, 0.0, 1e3) {
                return Err(TableError::Setting("half_width_c"));
            }
            if !are_usable(&plays[i].gain) {
                return Err(TableError::Setting("gain of a play"));
            }
            i += 1;
        }
        let mut per_tau_hz = [0.0; SLOW];
        let mut i = 0;
        while i < SLOW {
            if !is_within(slow_parts[i].tau_s, tau_s, 6e4) {
                return Err(TableError::Setting("tau_s of a second thermal lag"));
            }
            if !is_within(slow_parts[i].limit_c, 0.0, 1e3) {
                return Err(TableError::Setting("limit_c"));
            }
            if !are_usable(&slow_parts[i].gain) {
                return Err(TableError::Setting("gain of a second thermal lag"));
            }
            per_tau_hz[i] = 1.0 / slow_parts[i].tau_s;
            i += 1;
        }
        Ok(Self {
            plays,
            slow_parts,
            per_tau_hz,
        })
    }

    /// The hysteresis terms.
    pub const fn plays(&self) -> &[Play<AXES>; PLAYS] {
        &self.plays
    }

    /// The second lags.
    pub const fn slow_parts(&self) -> &[SlowPart<AXES>; SLOW] {
        &self.slow_parts
    }

    /// Adds the terms at `point` to the bias of every axis.
    #[inline(always)]
    pub fn add(&self, point: &HistoryPoint<PLAYS, SLOW>, bias: &mut [f32; AXES]) {
        for (play, &play_c) in self.plays.iter().zip(&point.plays_c) {
            for (bias, gain) in bias.iter_mut().zip(&play.gain) {
                *bias += gain * play_c;
            }
        }
        for (part, &lag_c) in self.slow_parts.iter().zip(&point.lags_c) {
            for (bias, gain) in bias.iter_mut().zip(&part.gain) {
                *bias += gain * lag_c;
            }
        }
    }
}

impl<const AXES: usize> History<AXES> {
    /// No terms.
    pub(crate) const NONE: Self = Self {
        plays: [],
        slow_parts: [],
        per_tau_hz: [],
    };
}

impl<const PLAYS: usize, const SLOW: usize> HistoryState<PLAYS, SLOW> {
    /// The state of a part that has been at this lag-compensated temperature for long \[degC\].
    pub const fn new(effective_c: f32) -> Self {
        Self {
            contacts_c: [effective_c; PLAYS],
            slow_parts: [Filter::new(effective_c); SLOW],
        }
    }

    /// Takes the lag-compensated temperature of an update \[degC\], `interval` after the one before.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn update<const AXES: usize>(
        &mut self,
        history: &History<AXES, PLAYS, SLOW>,
        interval: &Interval,
        effective_c: f32,
    ) -> HistoryPoint<PLAYS, SLOW> {
        let mut point = HistoryPoint {
            plays_c: [0.0; PLAYS],
            lags_c: [0.0; SLOW],
        };
        let plays = history.plays.iter().zip(&mut self.contacts_c);
        for ((play, contact_c), play_c) in plays.zip(&mut point.plays_c) {
            let width_c = play.half_width_c;
            *contact_c = within(*contact_c, effective_c - width_c, effective_c + width_c);
            *play_c = effective_c - *contact_c;
        }
        let parts = history.slow_parts.iter().zip(&history.per_tau_hz);
        let lags = self.slow_parts.iter_mut().zip(&mut point.lags_c);
        for ((part, &per_tau_hz), (slow, lag_c)) in parts.zip(lags) {
            let alpha = slower_alpha(interval, per_tau_hz);
            let before_c = slow.lag(alpha, effective_c);
            // Nothing is left of it where alpha is 1.
            *lag_c = limit(before_c * (1.0 - alpha), magnitude(part.limit_c));
        }
        point
    }
}

#[inline(always)]
fn within(value: f32, least: f32, most: f32) -> f32 {
    let value = select_unpredictable(value < least, least, value);
    select_unpredictable(value > most, most, value)
}

const fn are_usable<const N: usize>(values: &[f32; N]) -> bool {
    let mut i = 0;
    while i < N {
        if !is_within(values[i], -MAX_COEFFICIENT, MAX_COEFFICIENT) {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Thermal, ThermalSettings};

    /// One step of each kind by hand.
    #[test]
    fn the_contact_and_the_slow_part_follow() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let interval = Interval::new(&thermal, 25.0);
        let play = Play {
            half_width_c: 2.0,
            gain: [0.5],
        };
        let part = SlowPart {
            tau_s: 100.0,
            limit_c: 3.0,
            gain: [-1.0],
        };
        let history = History::new(60.0, [play], [part]).unwrap();
        let mut state = HistoryState::new(10.0);
        // The series at a quarter of the time constant.
        let alpha = 0.25 * (1.0 - 0.125 * (1.0 - 0.25 / 3.0));
        let mut slow = 10.0;
        for (effective_c, contact_c) in [(11.5, 10.0), (14.0, 12.0), (11.0, 12.0), (9.0, 11.0)] {
            let point = state.update(&history, &interval, effective_c);
            assert_eq!(state.contacts_c, [contact_c]);
            assert_eq!(point.plays_c, [effective_c - contact_c]);
            slow += alpha * (effective_c - slow);
            assert!((point.lags_c[0] - (effective_c - slow)).abs() < 1e-6);
            let mut bias = [100.0];
            history.add(&point, &mut bias);
            let added = 0.5 * point.plays_c[0] - point.lags_c[0];
            assert!((bias[0] - 100.0 - added).abs() < 1e-5);
        }
        assert_eq!(state.update(&history, &interval, 80.0).lags_c, [3.0]);
    }
}
