//! Terms of the thermal history in integers: hysteresis and a second lag.

use tempco::{History, Play, SlowPart};

use crate::FixedInterval;
use crate::estimator::Lag;
use crate::format::{FRACTION_BITS, from_f32, power_of_two, round};
use crate::interval::TimeConstant;
use crate::mask::{limit, limit_wide, upper};

/// Gains of all axes for a figure of a known range, scaled so that the product is the upper word of
/// a multiplication.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Gain<const AXES: usize> {
    /// Makes the figure a fraction of its full scale \[2^-31\].
    shift: u32,
    /// Twice the full scale times the gain \[last place of each axis\].
    factors: [i32; AXES],
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct FixedPlay<const AXES: usize> {
    half_width: i32,
    gain: Gain<AXES>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct FixedSlowPart<const AXES: usize> {
    tau: TimeConstant,
    limit: i32,
    gain: Gain<AXES>,
}

/// The integer counterpart of [`tempco::History`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct FixedHistory<const AXES: usize, const PLAYS: usize, const SLOW: usize> {
    plays: [FixedPlay<AXES>; PLAYS],
    slow_parts: [FixedSlowPart<AXES>; SLOW],
}

/// The state of the history terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct HistoryState<const PLAYS: usize, const SLOW: usize> {
    contacts: [i32; PLAYS],
    lags: [Lag; SLOW],
}

/// How far figures up to `most` \[2^-20\] are from fractions with 31 bits of a full scale: 1 or
/// the next power of two.
pub(crate) const fn shift(most: i32) -> u32 {
    let mut shift = 31 - FRACTION_BITS;
    while shift > 0 && most as i64 >= 1 << (31 - shift) {
        shift -= 1;
    }
    shift
}

/// The full scale of a figure.
pub(crate) const fn full_scale(shift: u32) -> f64 {
    power_of_two(31 - FRACTION_BITS as i32 - shift as i32)
}

impl<const AXES: usize> Gain<AXES> {
    const fn new(most: i32, gain: &[f32; AXES], exponents: &[i32; AXES]) -> Self {
        let shift = shift(most);
        let mut factors = [0; AXES];
        let mut axis = 0;
        while axis < AXES {
            let per_place = power_of_two(-exponents[axis]);
            factors[axis] = round(gain[axis] as f64 * 2.0 * full_scale(shift) * per_place);
            axis += 1;
        }
        Self { shift, factors }
    }

    #[inline(always)]
    fn add(&self, figure: i32, bias: &mut [i32; AXES]) {
        let figure = figure << self.shift;
        for (bias, factor) in bias.iter_mut().zip(self.factors) {
            *bias = bias.wrapping_add(upper(factor, figure));
        }
    }
}

impl<const AXES: usize, const PLAYS: usize, const SLOW: usize> FixedHistory<AXES, PLAYS, SLOW> {
    /// Converts the terms, for the exponents of the axes.
    pub(crate) const fn new(history: &History<AXES, PLAYS, SLOW>, exponents: &[i32; AXES]) -> Self {
        let mut plays = [FixedPlay {
            half_width: 0,
            gain: Gain::new(0, &[0.0; AXES], exponents),
        }; PLAYS];
        let mut i = 0;
        while i < PLAYS {
            let Play { half_width_c, gain } = history.plays()[i];
            let half_width = from_f32(half_width_c);
            plays[i] = FixedPlay {
                half_width,
                gain: Gain::new(half_width, &gain, exponents),
            };
            i += 1;
        }
        let mut slow_parts = [FixedSlowPart {
            tau: TimeConstant::new(1.0),
            limit: 0,
            gain: Gain::new(0, &[0.0; AXES], exponents),
        }; SLOW];
        let mut i = 0;
        while i < SLOW {
            let SlowPart {
                tau_s,
                limit_c,
                gain,
            } = history.slow_parts()[i];
            let limit = from_f32(limit_c);
            slow_parts[i] = FixedSlowPart {
                tau: TimeConstant::new(tau_s),
                limit,
                gain: Gain::new(limit, &gain, exponents),
            };
            i += 1;
        }
        Self { plays, slow_parts }
    }

    /// Adds the terms to the bias of every axis.
    #[inline(always)]
    pub(crate) fn add(
        &self,
        state: &HistoryState<PLAYS, SLOW>,
        effective: i32,
        bias: &mut [i32; AXES],
    ) {
        for (play, contact) in self.plays.iter().zip(state.contacts) {
            play.gain.add(effective - contact, bias);
        }
        for (part, lag) in self.slow_parts.iter().zip(state.lags) {
            part.gain.add(limit_wide(lag.left(), part.limit), bias);
        }
    }
}

impl<const PLAYS: usize, const SLOW: usize> HistoryState<PLAYS, SLOW> {
    /// The state of a part that has been at this effective temperature for long.
    pub(crate) const fn new(effective: i32) -> Self {
        Self {
            contacts: [effective; PLAYS],
            lags: [Lag::NONE; SLOW],
        }
    }

    /// Takes the effective temperature, and how far it moved.
    #[inline(always)]
    pub(crate) fn update<const AXES: usize>(
        &mut self,
        history: &FixedHistory<AXES, PLAYS, SLOW>,
        interval: &FixedInterval,
        effective: i32,
        movement: i32,
    ) {
        for (play, contact) in history.plays.iter().zip(&mut self.contacts) {
            // Both are within 2^30 of zero.
            *contact = effective - limit(effective - *contact, play.half_width);
        }
        for (part, lag) in history.slow_parts.iter().zip(&mut self.lags) {
            let (alpha, gap) = part.tau.alpha(interval);
            lag.update(alpha, movement);
            *lag = lag.keep(gap.not());
        }
    }
}

/// More than the terms of an axis can add up to, by the full scale of each \[unit of the axis\].
pub(crate) const fn peak<const AXES: usize, const PLAYS: usize, const SLOW: usize>(
    history: &History<AXES, PLAYS, SLOW>,
    axis: usize,
) -> f64 {
    let mut sum = 0.0;
    let mut i = 0;
    while i < PLAYS {
        let Play { half_width_c, gain } = &history.plays()[i];
        sum += full_scale(shift(from_f32(*half_width_c))) * gain[axis].abs() as f64;
        i += 1;
    }
    let mut i = 0;
    while i < SLOW {
        let SlowPart { limit_c, gain, .. } = &history.slow_parts()[i];
        sum += full_scale(shift(from_f32(*limit_c))) * gain[axis].abs() as f64;
        i += 1;
    }
    sum
}

/// The sum of the gains of an axis \[unit of the axis per degC\].
pub(crate) const fn gains<const AXES: usize, const PLAYS: usize, const SLOW: usize>(
    history: &History<AXES, PLAYS, SLOW>,
    axis: usize,
) -> f64 {
    let mut sum = 0.0;
    let mut i = 0;
    while i < PLAYS {
        sum += history.plays()[i].gain[axis].abs() as f64;
        i += 1;
    }
    let mut i = 0;
    while i < SLOW {
        sum += history.slow_parts()[i].gain[axis].abs() as f64;
        i += 1;
    }
    sum
}
