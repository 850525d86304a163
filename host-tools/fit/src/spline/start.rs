//! Where rate, second lag and plays are put after a power-on in mid-ramp.

use tempco::ThermalSettings;

use crate::least_squares::Block;
use crate::spline::lags::{HALF_WIDTHS_C, LEAST_DIVISOR, Lags};
use crate::spline::regressors::Points;

/// The core puts them so long after power-on \[s\].
const AFTER_S: f64 = ThermalSettings::START_S as f64;

/// The change of temperature is asked over up to so much more \[s\]: there may be gaps.
const TOLERANCE_S: f64 = 60.0;

/// The most that the core takes.
const MOST_RATE_START: f64 = 1e2;
const MOST_MIN: f64 = 1e3;

/// Factors of the plays that are tried \[min\], each so many times the one before.
const FIRST_MIN: f64 = 1.0;
const RATIO: f64 = 1.3;
const TRIED: usize = 20;

/// Factors of the start, of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Start {
    /// The rate, per rate that an estimator finds which began `AFTER_S` before.
    pub(crate) rate: f64,
    /// The second lag, per rate \[min\].
    pub(crate) lag2_min: f64,
    /// What the plays are behind, per rate and within their half widths \[min\].
    pub(crate) play_min: f64,
}

impl Start {
    /// The factors that come nearest, by least squares, to what the logs were at every moment, if
    /// only the change of temperature since `AFTER_S` before is known:
    ///
    /// ```text
    /// fresh = (T(t) - T(t - 120 s)) / 120 s (1 - exp(-120 s / tau))       what the estimator finds
    /// T'    = rate fresh
    /// d2    = lag2_min T'
    /// v - c = clamp(play_min T', -w, w)
    /// ```
    pub(crate) fn new(blocks: &[Block], temp_c: &[f64], points: &Points, lags: &Lags) -> Self {
        let fresh = fresh_rates(blocks, temp_c, lags.tau_s);
        let sum = |of: &dyn Fn(usize) -> f64| fresh.iter().map(|(i, fresh)| fresh * of(*i)).sum();
        let squares: f64 = fresh.iter().map(|(_, fresh)| fresh * fresh).sum();
        let rate: f64 = sum(&|i| points.rates[i]);
        let rate = (rate / squares).clamp(0.0, MOST_RATE_START);
        // Without a ramp in the logs there is nothing to go by.
        if rate.is_nan() || rate == 0.0 {
            return Self::default();
        }
        let lag2: f64 = sum(&|i| points.lags2_c[i]);
        Self {
            rate,
            lag2_min: (lag2 / squares / rate).clamp(-MOST_MIN, MOST_MIN),
            play_min: play_min(&fresh, rate, points),
        }
    }

    /// Settings of the core with this start.
    pub(crate) fn settings(&self, of: ThermalSettings) -> ThermalSettings {
        ThermalSettings {
            rate_start: self.rate as f32,
            lag2_start_min: self.lag2_min as f32,
            play_start_min: self.play_min as f32,
            ..of
        }
    }
}

/// For each block that has another one `AFTER_S` before it, what an estimator that began there finds
/// \[degC/min\].
fn fresh_rates(blocks: &[Block], temp_c: &[f64], tau_s: f64) -> Vec<(usize, f64)> {
    let share = -libm::expm1(-AFTER_S / tau_s);
    let least = (f64::from(ThermalSettings::LEAST_MEMORY_S) / tau_s).min(1.0);
    let share = share / share.max(least).max(LEAST_DIVISOR.into());
    let mut before = 0;
    let fresh = |i: usize| {
        let is_before =
            |of: &Block| of.log != blocks[i].log || blocks[i].time_s - of.time_s >= AFTER_S;
        while before < i && is_before(&blocks[before + 1]) {
            before += 1;
        }
        if blocks[before].log != blocks[i].log {
            return None;
        }
        let passed_s = blocks[i].time_s - blocks[before].time_s;
        let change_c = temp_c[i] - temp_c[before];
        let is_near = (AFTER_S..AFTER_S + TOLERANCE_S).contains(&passed_s);
        is_near.then(|| (i, 60.0 * share * change_c / passed_s))
    };
    (0..blocks.len()).filter_map(fresh).collect()
}

fn play_min(fresh: &[(usize, f64)], rate: f64, points: &Points) -> f64 {
    let error = |factor: f64| -> f64 {
        let plays = points.plays_c.iter().zip(HALF_WIDTHS_C);
        let of_play = plays.map(|(plays_c, width_c)| {
            let squares = fresh.iter().map(|(i, fresh)| {
                let put_c = (factor * rate * fresh).clamp(-width_c, width_c);
                ((plays_c[*i] - put_c) / width_c).powi(2)
            });
            squares.sum::<f64>()
        });
        of_play.sum()
    };
    if points.plays_c.is_empty() {
        return 0.0;
    }
    let tried = (0..TRIED).scan(FIRST_MIN, |factor, _| {
        let now = *factor;
        *factor *= RATIO;
        Some(now)
    });
    let best = tried.min_by(|a, b| error(*a).total_cmp(&error(*b)));
    best.unwrap_or(0.0)
}
