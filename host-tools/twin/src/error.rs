//! What can be wrong with a name, a profile or a simulation.

use thiserror::Error;

/// A name for which there is no unit or no profile.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown {kind} `{name}`, expected one of: {}", known.join(", "))]
pub struct UnknownName {
    /// What was asked for: `unit` or `profile`.
    pub kind: &'static str,
    /// The name as given.
    pub name: String,
    /// Every name that would have been accepted.
    pub known: &'static [&'static str],
}

/// A chamber programme that cannot be run. Steps are counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The programme has no step.
    #[error("the chamber programme has no steps")]
    Empty,
    /// A temperature is outside [`AIR_RANGE_C`](crate::AIR_RANGE_C) or not a number; step 0 is
    /// the start.
    #[error("step {step}: air temperature {air_c} degC is outside -100..200 degC")]
    AirTemperature {
        /// Number of the step, 0 for the start.
        step: usize,
        /// The temperature as given, degC.
        air_c: f64,
    },
    /// A soak has a duration that is not positive and finite.
    #[error("step {step}: soak of {duration_min} min, expected a positive duration")]
    SoakDuration {
        /// Number of the step.
        step: usize,
        /// The duration as given, minutes.
        duration_min: f64,
    },
    /// A ramp has a rate that is not positive and finite.
    #[error("step {step}: ramp at {rate_c_per_min} degC/min, expected a positive rate")]
    RampRate {
        /// Number of the step.
        step: usize,
        /// The rate as given, degC/min.
        rate_c_per_min: f64,
    },
    /// The programme lasts longer than [`MAX_DURATION_S`](crate::MAX_DURATION_S).
    #[error("the chamber programme lasts longer than 10000 h")]
    TooLong,
}

/// A simulation that cannot be started.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The sample rate is outside [`RATE_RANGE_HZ`](crate::RATE_RANGE_HZ) or not a number.
    #[error("sample rate {rate_hz} Hz is outside 0.01..10000 Hz")]
    Rate {
        /// The rate as given, Hz.
        rate_hz: f64,
    },
}
