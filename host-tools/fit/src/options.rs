//! What to fit.

use tempco::ThermalSettings;
use tempco_evaluate::TAU_RANGE_S;
use tempco_set::run::with_every_rate;
use tempco_set::{Model, Overlap, Segmentation, Stretch};

use crate::error::FitError;
use crate::summary::Plan;

/// Length of the blocks of a digest \[s\]: short against every time constant of a thermal model,
/// long enough to make a day a matter of some thousand blocks.
const BLOCK_S: f64 = 10.0;

/// Terms of the thermal history beside the five of every segment, for splines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum States {
    /// None.
    None,
    /// Those that lower the error on soaks and ramps left out of the fit by more than one standard
    /// error.
    Auto,
}

/// What to fit.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// Serial number of the unit.
    pub serial: String,
    /// Form of the model.
    pub model: Model,
    /// What is applied where segments overlap.
    pub overlap: Overlap,
    /// The segments; without them the measured range is divided in the paper's manner.
    pub segments: Option<Segmentation>,
    /// Settings of the thermal path. The rate limits and the reference temperature are set by the
    /// fit; time constant and `kappa` as well, where the model is a spline and they are not fixed
    /// below.
    pub thermal: ThermalSettings,
    /// Time constant of the rate estimator \[s\], if it is not to be fitted.
    pub rate_tau_s: Option<f32>,
    /// Shift of the effective temperature, if it is not to be fitted.
    pub kappa: Option<f32>,
    /// Whether a spline may earn plays and a slow part.
    pub states: States,
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
    /// A robust fit over the measured range with the core's default settings, blended linearly,
    /// judged at 100 s.
    pub fn new(serial: &str, model: Model) -> Self {
        Self {
            serial: serial.to_owned(),
            model,
            overlap: Overlap::Linear,
            segments: None,
            thermal: ThermalSettings::DEFAULT,
            rate_tau_s: None,
            kappa: None,
            states: States::Auto,
            exclude: Vec::new(),
            robust: true,
            scale_factor_arcsec: None,
            tau_s: 100.0,
        }
    }

    /// What must be known before logs are digested.
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
            thermal: with_every_rate(self.thermal_settings()).map_err(FitError::Settings)?,
            exclude: self.exclude.clone(),
            robust: self.robust,
            block_s: self.tau_s / parts,
        })
    }

    /// The thermal path that a fit begins with.
    pub(crate) fn thermal_settings(&self) -> ThermalSettings {
        ThermalSettings {
            tau_s: self.rate_tau_s.unwrap_or(self.thermal.tau_s),
            kappa: self.kappa.unwrap_or(self.thermal.kappa),
            ..self.thermal
        }
    }
}
