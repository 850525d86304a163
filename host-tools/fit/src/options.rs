//! How to fit.

use tempco::ThermalSettings;
use tempco_evaluate::TAU_RANGE_S;
use tempco_set::Stretch;
use tempco_set::run::with_every_rate;

use crate::error::FitError;
use crate::method::Method;
use crate::summary::Plan;

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
    /// Settings of the thermal path. The rate limits and the reference temperature are set by the
    /// fit; time constant and `kappa` as well, where the method searches them.
    pub thermal: ThermalSettings,
    /// Stretches of log time that are not fitted, in every log.
    pub exclude: Vec<Stretch>,
    /// Whether spikes and disturbances are left out.
    pub robust: bool,
    /// Angle per pulse that the logs were read with \[arcsec\].
    pub scale_factor_arcsec: Option<f64>,
    /// Averaging time of the statistics \[s\].
    pub tau_s: f64,
}

impl FitOptions {
    /// A robust fit with the core's default settings, judged at 100 s.
    pub fn new(serial: &str, method: impl Into<Method>) -> Self {
        Self {
            serial: serial.to_owned(),
            method: method.into(),
            thermal: ThermalSettings::DEFAULT,
            exclude: Vec::new(),
            robust: true,
            scale_factor_arcsec: None,
            tau_s: 100.0,
        }
    }

    /// What must be known before logs are summarised.
    ///
    /// Blocks are about ten seconds long: so long that means over `tau_s` are made of whole blocks,
    /// and no longer than these.
    ///
    /// # Errors
    /// An averaging time outside [`TAU_RANGE_S`], settings that the core refuses.
    pub fn plan(&self) -> Result<Plan, FitError> {
        if !TAU_RANGE_S.contains(&self.tau_s) {
            return Err(FitError::AveragingTime { tau_s: self.tau_s });
        }
        let parts = (self.tau_s / BLOCK_S).round().max(1.0);
        Ok(Plan {
            // While fitting, every rate counts.
            thermal: with_every_rate(self.thermal).map_err(FitError::Settings)?,
            exclude: self.exclude.clone(),
            robust: self.robust,
            block_s: self.tau_s / parts,
        })
    }
}
