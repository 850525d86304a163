//! The two thermal lags of the spline model, and which mix of them the curve and the plays see.

use tempco::{PLAYS, ThermalSettings};

use crate::least_squares::{Basis, RateForm};

/// No lag is limited while fitting \[degC\].
const NO_LIMIT_C: f32 = 1e3;

/// Half widths of the plays \[degC\]. Trials that searched for them found nothing better.
pub(crate) const HALF_WIDTHS_C: [f64; PLAYS] = [2.0, 12.0];

/// The least number that the rate is divided by after power-on: what a lasting ramp has is put later.
pub(crate) const LEAST_DIVISOR: f32 = 0.4;

/// Cells over which a gain of rate or second lag is straight; all of them where they are few.
const STRAIGHT: usize = 4;

/// Parameters of the thermal path, apart from coefficients.
///
/// ```text
/// u = T - kappa d1 - kappa2 d2               temperature of the curve
/// v = T - play_kappa d1 - play_kappa2 d2     what drags the plays
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lags {
    /// Time constant of the first lag, which also gives the rate \[s\].
    pub(crate) tau_s: f64,
    /// Time constant of the second lag \[s\].
    pub(crate) tau2_s: f64,
    pub(crate) kappa: f64,
    pub(crate) kappa2: f64,
    pub(crate) play_kappa: f64,
    pub(crate) play_kappa2: f64,
}

impl Lags {
    /// How many numbers are searched.
    pub(crate) const COUNT: usize = 6;

    /// As the search moves them: logarithms of the first time constant and of how many times as
    /// long the second is, then the mixes.
    pub(crate) fn to_array(self) -> [f64; Self::COUNT] {
        [
            libm::log(self.tau_s),
            libm::log(self.tau2_s / self.tau_s),
            self.kappa,
            self.kappa2,
            self.play_kappa,
            self.play_kappa2,
        ]
    }

    /// The inverse of [`to_array`](Self::to_array).
    pub(crate) fn from_array(of: [f64; Self::COUNT]) -> Self {
        Self {
            tau_s: libm::exp(of[0]),
            tau2_s: libm::exp(of[0] + of[1]),
            kappa: of[2],
            kappa2: of[3],
            play_kappa: of[4],
            play_kappa2: of[5],
        }
    }
}

/// Which terms a model has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Form {
    /// Cells of the curve, at most.
    pub(crate) cells: usize,
    /// Bias per rate of temperature.
    pub(crate) rates: bool,
    /// The second lag, in the mixes and in the bias.
    pub(crate) lag2: bool,
    /// How many of the plays, the narrow one first.
    pub(crate) plays: usize,
}

impl Form {
    /// The basis of this form over some edges of cells \[degC\].
    pub(crate) fn basis(&self, edges_c: Vec<f64>, logs: usize) -> Basis {
        let rate = match self.rates {
            true => RateForm::Hats,
            false => RateForm::None,
        };
        let cells_of_hat = STRAIGHT.min(edges_c.len() - 1);
        Basis::new(edges_c, rate, logs)
            .with_hats_over(cells_of_hat)
            .with_history(self.lag2, self.plays)
    }

    /// Settings of the core with this form; no second lag is limited.
    pub(crate) fn settings(&self, lags: &Lags, of: ThermalSettings) -> ThermalSettings {
        let width_c = |play: usize| match play < self.plays {
            true => HALF_WIDTHS_C[play] as f32,
            false => 0.0,
        };
        let limit_c = if self.lag2 { NO_LIMIT_C } else { 0.0 };
        ThermalSettings {
            tau_s: lags.tau_s as f32,
            kappa: lags.kappa as f32,
            tau2_s: lags.tau2_s as f32,
            kappa2: lags.kappa2 as f32,
            lag2_min_c: -limit_c,
            lag2_max_c: limit_c,
            half_width1_c: width_c(0),
            half_width2_c: width_c(1),
            play_kappa: lags.play_kappa as f32,
            play_kappa2: lags.play_kappa2 as f32,
            least_divisor: LEAST_DIVISOR,
            ..of
        }
    }
}

/// Ends of cells of equal width over a range \[degC\].
pub(crate) fn edges_c((low, high): (f64, f64), cells: usize) -> Vec<f64> {
    let edge = |k: usize| low + (high - low) * k as f64 / cells as f64;
    (0..=cells).map(edge).collect()
}

/// The most cells, up to some number, that whole hats cover.
pub(crate) fn whole_hats(cells: usize) -> usize {
    match cells {
        ..STRAIGHT => cells,
        _ => cells / STRAIGHT * STRAIGHT,
    }
}
