//! What a choice among models leaves in the set: the candidates and their held-out errors.

use serde::{Deserialize, Serialize};

use crate::Model;

/// Where the breakpoints are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Segments of equal width.
    Uniform,
    /// About as much time in each segment.
    Quantile,
    /// As asked for.
    Given,
}

impl Place {
    /// The place as it is written in sets.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Quantile => "quantile",
            Self::Given => "given",
        }
    }
}

/// A model as it stood to choice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Candidate {
    /// Form of the model.
    pub model: Model,
    /// Number of segments.
    pub segments: usize,
    /// Where the breakpoints are.
    pub place: Place,
    /// Coefficients of the rate terms of an axis, 0 where there are none.
    pub rate_columns: usize,
    /// Free coefficients of an axis.
    pub columns: usize,
    /// Time constant of the rate estimator \[s\].
    pub tau_s: f64,
    /// Shift of the lag-compensated temperature.
    pub kappa: f64,
    /// Half widths of its plays \[degC\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub half_widths_c: Vec<f64>,
    /// Time constant of its second lag \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau2_s: Option<f64>,
    /// Held-out root mean square error of each axis \[unit of the axis\].
    pub rmse: Vec<f64>,
    /// How much larger the held-out mean square is than the best candidate's, as a share,
    /// mean of the axes.
    pub excess: f64,
    /// Standard error of `excess`.
    pub excess_sigma: f64,
}

/// The choice among models.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// Soaks and ramps found in the logs.
    pub soaks_and_ramps: usize,
    /// Parts in which they were left out.
    pub folds: usize,
    /// Speeds of the ramps that differ by more than 30 % \[degC/min\].
    #[serde(default)]
    pub ramp_rates_c_per_min: Vec<f64>,
    /// The chosen model.
    pub chosen: Candidate,
    /// The others, best first.
    pub others: Vec<Candidate>,
}

impl Selection {
    /// History terms take ramps of this many rates. With one, what depends on the rate
    /// and what does not look the same, and so do two lags.
    pub const LEAST_RATES: usize = 2;

    /// Whether the logs hold ramps of enough rates to find history terms from.
    pub fn can_tell_history(&self) -> bool {
        self.ramp_rates_c_per_min.len() >= Self::LEAST_RATES
    }
}

/// Root mean square errors of blocks of ten seconds that were left out of the fit, by whole soaks
/// and ramps \[unit of the axis\]. They contain the noise of the blocks. None where what remained
/// could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutErrors {
    /// Soaks and ramps found in the logs.
    pub soaks_and_ramps: usize,
    /// Parts in which they were left out.
    pub folds: usize,
    /// Without compensation.
    pub none: f64,
    /// One cubic in T.
    pub cubic: Option<f64>,
    /// The static model of the paper.
    #[serde(rename = "static")]
    pub static_model: Option<f64>,
    /// The composite model of the paper.
    pub composite: Option<f64>,
    /// The fitted model.
    pub chosen: Option<f64>,
    /// Standard error, over the folds, of the difference between the mean squares of the fitted model
    /// and without compensation, as a share of the latter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub excess_sigma: Option<f64>,
    /// The error of terms that were left out because they are not better than a constant; the axis
    /// then keeps the constant alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<f64>,
}

impl HeldOutErrors {
    /// How much larger the mean square of the fitted model is than without compensation, as a
    /// share; negative where the model helps.
    pub fn excess(&self) -> Option<f64> {
        Some((self.chosen? / self.none).powi(2) - 1.0)
    }
}
