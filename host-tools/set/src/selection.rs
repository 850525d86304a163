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
    /// Share of the second lag in the lag-compensated temperature.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub kappa2: f64,
    /// As `kappa`, of the temperature that drags the plays.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub play_kappa: f64,
    /// As `kappa2`, of the temperature that drags the plays.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub play_kappa2: f64,
    /// Held-out root mean square error of each axis \[unit of the axis\].
    pub rmse: Vec<f64>,
    /// How much larger the held-out mean square is than the best candidate's, as a share,
    /// mean of the axes.
    pub excess: f64,
    /// Standard error of `excess`.
    pub excess_sigma: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
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
    /// The others, best first; none since the form follows from the logs.
    pub others: Vec<Candidate>,
}

impl Selection {
    /// A second lag takes ramps of this many rates. With one, two lags look the same.
    pub const LEAST_RATES: usize = 2;

    /// Whether the logs hold ramps of enough rates to find two lags from.
    pub fn can_tell_lags(&self) -> bool {
        self.ramp_rates_c_per_min.len() >= Self::LEAST_RATES
    }
}

/// A model that the fitted one is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SimplerModel {
    /// One cubic in T.
    Cubic,
    /// The static model of the paper.
    Static,
    /// The composite model of the paper.
    Composite,
}

impl SimplerModel {
    /// The model as it is written in sets.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cubic => "cubic",
            Self::Static => "static",
            Self::Composite => "composite",
        }
    }
}

/// A simpler model that does better than the fitted one where both were left out, by more than
/// one standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surpassed {
    /// The simpler model.
    pub by: SimplerModel,
    /// Its error \[unit of the axis\].
    pub rmse: f64,
    /// How much larger the mean square of the fitted model is, as a share.
    pub excess: f64,
    /// Standard error of `excess`, over the folds.
    pub excess_sigma: f64,
}

/// Root mean square errors of means over 100 s that were left out of the fit, by whole soaks and
/// ramps, less the white noise of the means \[unit of the axis\]; in sets of version 1 of means over
/// 10 s, with their noise. None where what remained
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
    /// The best simpler model, where one does better.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surpassed: Option<Surpassed>,
}

impl HeldOutErrors {
    /// How much larger the mean square of the fitted model is than without compensation, as a
    /// share; negative where the model helps.
    pub fn excess(&self) -> Option<f64> {
        Some((self.chosen? / self.none).powi(2) - 1.0)
    }
}
