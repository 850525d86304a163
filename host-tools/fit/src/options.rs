//! How to fit.

use serde::{Deserialize, Serialize};
use tempco::{Thermal, ThermalSettings};
use tempco_evaluate::TAU_RANGE_S;
use tempco_set::Stretch;
use tempco_set::run::with_every_rate;

use crate::error::FitError;
use crate::method::{LagSearch, Method};

/// Length of the blocks of a summary \[s\]: short against every time constant of a thermal model,
/// long enough to make a day a matter of some thousand blocks.
const BLOCK_S: f64 = 10.0;

/// What to fit, and how.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// Serial number of the unit.
    pub serial: String,
    /// What is fitted.
    pub method: Method,
    /// What must be known before the logs are summarised.
    pub plan: PlanOptions,
}

impl FitOptions {
    /// A fit by the default plan.
    pub fn new(serial: &str, method: impl Into<Method>) -> Self {
        Self {
            serial: serial.to_owned(),
            method: method.into(),
            plan: PlanOptions::default(),
        }
    }
}

/// What must be known before logs are summarised. By default a robust fit with the core's default
/// settings, judged at 100 s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanOptions {
    /// Settings of the thermal path. The rate limits and the reference temperature are set by the
    /// fit; time constant and `kappa` as well, where they are searched.
    pub thermal: ThermalSettings,
    /// What the default model searches of the first lag.
    pub search: LagSearch,
    /// Stretches of log time that are not fitted, in every log.
    pub exclude: Vec<Stretch>,
    /// Whether spikes and disturbances are left out.
    pub robust: bool,
    /// Angle per pulse that the logs are read with \[arcsec\].
    pub scale_factor_arcsec: Option<f64>,
    /// Averaging time of the statistics \[s\].
    pub tau_s: f64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            thermal: ThermalSettings::DEFAULT,
            search: LagSearch::ALL,
            exclude: Vec::new(),
            robust: true,
            scale_factor_arcsec: None,
            tau_s: 100.0,
        }
    }
}

/// A plan by which logs are summarised: options that were checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub(crate) options: PlanOptions,
    /// Settings of the thermal path, with limits that no rate reaches: while fitting, every rate
    /// counts.
    pub(crate) thermal: Thermal,
    /// Length of a block, as long as the log is not too long \[s\].
    pub(crate) block_s: f64,
}

impl Plan {
    /// Checks the options.
    ///
    /// Blocks are about ten seconds long: so long that means over `tau_s` are made of whole blocks,
    /// and no longer than these.
    ///
    /// # Errors
    /// An averaging time outside [`TAU_RANGE_S`], settings that the core refuses.
    pub fn new(options: PlanOptions) -> Result<Self, FitError> {
        let tau_s = options.tau_s;
        if !TAU_RANGE_S.contains(&tau_s) {
            return Err(FitError::AveragingTime { tau_s });
        }
        let parts = (tau_s / BLOCK_S).round().max(1.0);
        Ok(Self {
            thermal: with_every_rate(options.thermal).map_err(FitError::Settings)?,
            block_s: tau_s / parts,
            options,
        })
    }

    /// What was checked.
    pub fn options(&self) -> &PlanOptions {
        &self.options
    }
}
