//! Bias stability at one averaging time.

use serde::Serialize;

use crate::means::Means;
use crate::measured::Measured;

/// Bias stability at one averaging time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// Averaging time \[s\].
    pub tau_s: f64,
    /// Number of non-overlapping means.
    pub n: usize,
    /// The figures, if there are two means or more.
    pub sigma: Measured<Sigmas>,
}

/// Sample standard deviations of the means \[unit of the axis\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sigmas {
    /// Without compensation.
    pub raw: f64,
    /// With the reference; none where there is no reference for the axis.
    pub reference: Option<f64>,
    /// With compensation.
    pub compensated: f64,
    /// `1 - compensated / raw`; negative where compensation does harm.
    pub improvement: f64,
    /// `1 - compensated / reference`; negative where the reference does better.
    pub improvement_over_reference: Option<f64>,
}

impl Stability {
    /// Of rows `interval_s` apart, from means over `tau_s`.
    pub(super) fn new(
        [raw, compensated]: [&Means; 2],
        reference: Option<f64>,
        interval_s: f64,
        tau_s: f64,
    ) -> Self {
        let n = raw.means.len();
        let refusal = if interval_s > tau_s * (1.0 + 1e-9) {
            Some(format!("rows are {interval_s} s apart"))
        } else if n < 2 {
            Some(format!("{n} full stretches in the log"))
        } else {
            None
        };
        let sigma = match refusal {
            Some(not_measured) => Measured::Not { not_measured },
            None => Measured::Figure(Sigmas::new(raw.sigma(), reference, compensated.sigma())),
        };
        Self { tau_s, n, sigma }
    }
}

impl Sigmas {
    fn new(raw: f64, reference: Option<f64>, compensated: f64) -> Self {
        Self {
            raw,
            reference,
            compensated,
            improvement: 1.0 - compensated / raw,
            improvement_over_reference: reference.map(|sigma| 1.0 - compensated / sigma),
        }
    }
}
