//! What a gyro puts out: whole pulses of an angle, or a rate in steps.

use serde::Deserialize;

use crate::check::{Invalid, Range};

/// The unit of rates and biases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RateUnit {
    /// Pulses per second.
    PulsesPerS,
    /// Degrees per hour.
    Dph,
    /// Degrees per second.
    Dps,
}

/// What the gyros put out.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Output {
    /// Whole pulses of an angle, counted per sample; the rest is carried.
    Pulses {
        /// Angle of one pulse, arcsec.
        scale_factor_arcsec: f64,
    },
    /// The mean rate over a sample, in steps.
    Rate {
        /// Step of the output, rate unit.
        step: f64,
        /// Largest magnitude of the output, rate unit.
        full_scale: f64,
    },
}

impl RateUnit {
    /// As it stands in the names of columns.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PulsesPerS => "pulses_per_s",
            Self::Dph => "dph",
            Self::Dps => "dps",
        }
    }
}

impl Output {
    /// Angle of a rate unit times s, arcsec.
    pub const fn arcsec_per_angle(self, rate_unit: RateUnit) -> f64 {
        match (rate_unit, self) {
            (
                RateUnit::PulsesPerS,
                Self::Pulses {
                    scale_factor_arcsec,
                },
            ) => scale_factor_arcsec,
            (RateUnit::PulsesPerS, Self::Rate { .. }) | (RateUnit::Dph, _) => 1.0,
            (RateUnit::Dps, _) => 3600.0,
        }
    }

    pub(crate) fn check(&self, rate_unit: RateUnit) -> Result<(), Invalid> {
        match *self {
            Self::Pulses {
                scale_factor_arcsec,
            } => {
                let range = Range::new(1e-6, 1e6);
                range.check("output.pulses.scale_factor_arcsec", scale_factor_arcsec)
            }
            Self::Rate { step, full_scale } => {
                if rate_unit == RateUnit::PulsesPerS {
                    return Err(Invalid::new(
                        "output.rate",
                        "a rate in pulses",
                        "output.pulses",
                    ));
                }
                // Logs have 6 decimals.
                Range::new(1e-5, 1e6).check("output.rate.step", step)?;
                Range::new(step, 1e9).check("output.rate.full_scale", full_scale)
            }
        }
    }
}

/// Most pulses of a sample: above, not every whole number is an `f64`.
const MOST_PULSES: f64 = (1_u64 << 53) as f64;

/// Whole numbers of an angle increment.
#[derive(Debug, Clone)]
pub(crate) enum Quantiser {
    /// Counts pulses; the rest of the angle is carried, so that none is lost.
    Pulses {
        /// Pulses per rate unit times s.
        pulses: f64,
        /// Angle turned since the last whole pulse, 0..1.
        rest: f64,
    },
    /// Rounds the mean rate to steps, within a full scale.
    Rate {
        /// Steps per rate unit times s.
        steps: f64,
        most: f64,
    },
}

impl Quantiser {
    pub(crate) fn new(output: Output, rate_unit: RateUnit, interval_s: f64) -> Self {
        match output {
            Output::Pulses {
                scale_factor_arcsec,
            } => Self::Pulses {
                pulses: output.arcsec_per_angle(rate_unit) / scale_factor_arcsec,
                rest: 0.0,
            },
            Output::Rate { step, full_scale } => Self::Rate {
                steps: 1.0 / (interval_s * step),
                most: (full_scale / step).floor(),
            },
        }
    }

    pub(crate) fn count(&mut self, angle: f64) -> i64 {
        match self {
            Self::Pulses { pulses, rest } => {
                let angle_pulses = *rest + angle * *pulses;
                let whole = angle_pulses.floor();
                *rest = angle_pulses - whole;
                whole.clamp(-MOST_PULSES, MOST_PULSES) as i64
            }
            Self::Rate { steps, most } => {
                (angle * *steps + 0.5).floor().clamp(-*most, *most) as i64
            }
        }
    }
}
