//! One axis of a set: its polynomials, how well they are known, and how well they do.

use serde::{Deserialize, Serialize};
use tempco::Terms;
use tempco_log::AxisUnit;

use crate::HeldOutErrors;
use crate::model::{COMPOSITE, Polynomial, join, split};

/// One axis as fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisSet {
    /// Name.
    pub name: String,
    /// Unit of the bias.
    pub unit: AxisUnit,
    /// Temperature at which the bias is 0 with the rate at 0 \[degC\]. Accelerometers alone have it:
    /// their constant is gravity and stays in the output, so that the change of the bias about
    /// this temperature is taken out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_c: Option<f64>,
    /// The polynomial of each segment.
    pub polynomials: Vec<Polynomial>,
    /// Standard deviations of the coefficients of each polynomial; empty in an imported set.
    #[serde(default)]
    pub sigmas: Vec<CoefficientSigmas>,
    /// Gains of the plays, as in the table; none where it has no plays.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gains: Vec<GainSet>,
    /// What remains after a spline model, as noise; none of other models, whose residuals are not
    /// taken apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseSet>,
    /// Errors on soaks and ramps that were left out of the fit; none in an imported set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out: Option<HeldOutErrors>,
    /// How well the set does on the logs it was fitted to; none in an imported set.
    pub statistics: Option<AxisStatistics>,
}

/// The gain of a play.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainSet {
    /// \[unit of the axis per degC\]
    pub gain: f64,
    /// Standard deviation (1 sigma) under the [`noise`](AxisSet::noise) of the axis, for the half
    /// width that was found; 0 where the axis does without the play.
    pub sigma: f64,
}

/// White noise and random walk that account for the residuals of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseSet {
    /// Standard deviation of means over ten seconds \[unit of the axis\].
    pub white: f64,
    /// Growth of the random walk \[unit of the axis per square root of an hour\].
    pub walk: f64,
}

/// Standard deviations (1 sigma) of the coefficients of a
/// [`Polynomial`], in its basis; 0 for terms that were not fitted.
///
/// Of static and composite models, those of least squares, which hold for white residuals, times
/// the [`serial_factor`](AxisStatistics::serial_factor) of the axis; of splines, those under the
/// [`noise`](AxisSet::noise) of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoefficientSigmas {
    /// Of the static coefficients, lowest power first \[unit of the axis\].
    pub a: [f64; Terms::STATIC],
    /// Of the rate coefficients, lowest power first \[unit of the axis per degC/min\].
    pub r: [f64; Terms::RATE],
    /// Of the coefficients of the second lag, lowest power first \[unit of the axis per degC\].
    pub s: [f64; Terms::LAG],
    /// Correlations of `a` and `r` in the order of [`Terms::NAMES`], row by row; 0 with a term that
    /// was not fitted.
    #[serde(default)]
    pub correlation: [[f64; COMPOSITE]; COMPOSITE],
}

impl CoefficientSigmas {
    /// Of the leading coefficients.
    pub fn new(sigmas: &[f64], correlations: &[Vec<f64>]) -> Self {
        let (a, r) = split(sigmas);
        let correlation = |i: usize, j: usize| {
            let row = correlations.get(i);
            row.and_then(|row| row.get(j)).copied().unwrap_or(0.0)
        };
        Self {
            a,
            r,
            s: [0.0; Terms::LAG],
            correlation: std::array::from_fn(|i| std::array::from_fn(|j| correlation(i, j))),
        }
    }

    /// From the covariance of `a` and `r`.
    pub fn from_covariance(covariance: [[f64; COMPOSITE]; COMPOSITE]) -> Self {
        let sigmas: [f64; COMPOSITE] = std::array::from_fn(|i| covariance[i][i].max(0.0).sqrt());
        let correlation = |i: usize, j: usize| match sigmas[i] * sigmas[j] {
            0.0 => 0.0,
            product => covariance[i][j] / product,
        };
        let (a, r) = split(&sigmas);
        Self {
            a,
            r,
            s: [0.0; Terms::LAG],
            correlation: std::array::from_fn(|i| std::array::from_fn(|j| correlation(i, j))),
        }
    }

    /// The standard deviations of `a` and `r` in the order of [`Terms::NAMES`].
    pub fn to_array(&self) -> [f64; COMPOSITE] {
        join(&self.a, &self.r)
    }

    /// Multiplies all of them.
    pub fn scale(&mut self, factor: f64) {
        for sigma in self.a.iter_mut().chain(&mut self.r).chain(&mut self.s) {
            *sigma *= factor;
        }
    }
}

/// Figures of an axis over the fitted logs \[unit of the axis\].
///
/// `rmse` figures are of single rows, `sigma` figures of means over `tau_s`; each about the mean
/// of the log it belongs to. `cubic` is one cubic in T, fitted to the same rows for comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisStatistics {
    /// Rows.
    pub rows: usize,
    /// RMS without compensation.
    pub rmse_raw: f64,
    /// RMS with the cubic.
    pub rmse_cubic: f64,
    /// RMS with the emitted table, applied by the core.
    pub rmse_compensated: f64,
    /// Averaging time \[s\].
    pub tau_s: f64,
    /// Number of means.
    pub n: usize,
    /// Bias stability at `tau_s` without compensation.
    pub sigma_raw: f64,
    /// Bias stability at `tau_s` with the cubic.
    pub sigma_cubic: f64,
    /// Bias stability at `tau_s` with the emitted table, applied by the core.
    pub sigma_compensated: f64,
    /// Standard deviation of the means of what remains, over that of means of as many independent
    /// rows: above 1 where neighbouring residuals resemble each other, below 1 where counting
    /// whole pulses sets them apart. None where there are too few means to tell.
    #[serde(default)]
    pub serial_factor: Option<f64>,
}
