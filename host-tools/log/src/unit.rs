//! Units of the axes, as they stand in column names and in coefficient sets.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Unit of an axis and so of its bias.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisUnit {
    /// Degrees per hour.
    Dph,
    /// Degrees per second.
    Dps,
    /// Radians per second.
    Radps,
    /// Pulses per second, from pulse counts per sample without a scale factor.
    PulsesPerS,
    /// Metres per second squared.
    Mps2,
    /// Standard gravity.
    G,
}

impl AxisUnit {
    /// The unit as it is written in column names and coefficient sets.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dph => "dph",
            Self::Dps => "dps",
            Self::Radps => "radps",
            Self::PulsesPerS => "pulses_per_s",
            Self::Mps2 => "mps2",
            Self::G => "g",
        }
    }

    /// Whether it is of an accelerometer.
    pub const fn is_acceleration(self) -> bool {
        matches!(self, Self::Mps2 | Self::G)
    }

    /// The unit in which the random walk of the axis's integral is stated, and what a figure in
    /// this unit times sqrt(s) is multiplied by: angle random walk of a gyro, velocity random walk
    /// of an accelerometer.
    pub const fn random_walk(self) -> (&'static str, f64) {
        const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;
        match self {
            Self::Dph => ("deg/sqrt(h)", 1.0 / 60.0),
            Self::Dps => ("deg/sqrt(h)", 60.0),
            Self::Radps => ("deg/sqrt(h)", 60.0 * DEG_PER_RAD),
            Self::PulsesPerS => ("pulses/sqrt(s)", 1.0),
            Self::Mps2 => ("m/s/sqrt(h)", 60.0),
            Self::G => ("g/sqrt(Hz)", 1.0),
        }
    }

    /// The unit as a person writes it.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Dph => "deg/h",
            Self::Dps => "deg/s",
            Self::Radps => "rad/s",
            Self::PulsesPerS => "pulses/s",
            Self::Mps2 => "m/s^2",
            Self::G => "g",
        }
    }
}

impl fmt::Display for AxisUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// How the values of a column are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnUnit {
    /// The values are in the axis's unit.
    Direct(AxisUnit),
    /// The values are pulse counts per sample.
    Pulses,
}

impl ColumnUnit {
    /// What a value of the column is multiplied by, and the unit it is then in. Pulses of rows
    /// `interval_s` apart become angles by a scale factor \[arcsec per pulse\]; 1 arcsec/s is 1 deg/h.
    pub fn in_axis_unit(
        self,
        interval_s: f64,
        scale_factor_arcsec: Option<f64>,
    ) -> (f64, AxisUnit) {
        match (self, scale_factor_arcsec) {
            (Self::Direct(unit), _) => (1.0, unit),
            (Self::Pulses, Some(scale_factor)) => (scale_factor / interval_s, AxisUnit::Dph),
            (Self::Pulses, None) => (1.0 / interval_s, AxisUnit::PulsesPerS),
        }
    }
}

/// The units a column may have, for messages.
pub const COLUMN_UNITS: &str = "dph, dps, radps, pulses, pulses_per_s, mps2, g";

impl FromStr for ColumnUnit {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        Ok(match text {
            "pulses" => Self::Pulses,
            "dph" => Self::Direct(AxisUnit::Dph),
            "dps" => Self::Direct(AxisUnit::Dps),
            "radps" => Self::Direct(AxisUnit::Radps),
            "pulses_per_s" => Self::Direct(AxisUnit::PulsesPerS),
            "mps2" => Self::Direct(AxisUnit::Mps2),
            "g" => Self::Direct(AxisUnit::G),
            _ => return Err(()),
        })
    }
}
