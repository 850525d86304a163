//! A gyro unit: what it is made of, and those that have a name.

use serde::{Deserialize, Deserializer};

use crate::check::{Invalid, Range, element};
use crate::curve::StaticCurve;
use crate::drift::Drift;
use crate::error::UnknownName;
use crate::file;
use crate::gyro::GyroNoise;
use crate::hysteresis::{ModeSteps, Play};
use crate::sensor::TemperatureReading;
use crate::thermal::ThermalNetwork;
use crate::tone::Tone;

/// Names of the axes, in the order of every array of three.
pub const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// Names that [`Unit::named`] accepts.
pub const UNITS: &[&str] = &[
    "paper",
    "smooth",
    "wavy",
    "hysteretic",
    "ln100",
    "mems",
    "fog",
];

const FILES: [&str; 7] = [
    include_str!("../units/paper.toml"),
    include_str!("../units/smooth.toml"),
    include_str!("../units/wavy.toml"),
    include_str!("../units/hysteretic.toml"),
    include_str!("../units/ln100.toml"),
    include_str!("../units/mems.toml"),
    include_str!("../units/fog.toml"),
];

/// A gyro unit: three axes in one case with one temperature sensor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unit {
    /// Name of the unit: that of its file, without ending.
    #[serde(skip)]
    pub name: String,
    /// One line for lists of units.
    #[serde(default)]
    pub description: String,
    /// The rate unit: what all rates and biases of the unit are in.
    pub rate_unit: RateUnit,
    /// What the gyros put out.
    pub output: Output,
    /// Heat flow from the air to the cavities.
    pub thermal: ThermalNetwork,
    /// How the temperature is read.
    pub temperature: TemperatureReading,
    /// Tones in the angle of the gyros; 16 at most.
    #[serde(default)]
    pub tone: Vec<Tone>,
    /// Probability that a row is missing from the log.
    #[serde(default)]
    pub lost_rows: f64,
    /// The axes [`AXIS_NAMES`].
    #[serde(rename = "axis", deserialize_with = "three_axes")]
    pub axes: [Axis; 3],
}

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

/// One axis: its bias and its noise. What is not given is not there.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Static part of the bias.
    pub static_curve: StaticCurve,
    /// Temperature rate sensitivity g at 25 degC, rate unit per degC/min.
    #[serde(default)]
    pub rate_sensitivity: f64,
    /// Relative change k of the rate sensitivity with temperature, 1/degC.
    #[serde(default)]
    pub rate_sensitivity_slope_per_c: f64,
    /// Sensitivity h to the difference between case and cavity, rate unit per degC.
    #[serde(default)]
    pub gradient_sensitivity: f64,
    /// Hysteresis: a sum of plays, 16 at most.
    #[serde(default)]
    pub play: Vec<Play>,
    /// Steps of the path-length control.
    #[serde(default)]
    pub modes: Option<ModeSteps>,
    /// Random drift of the bias.
    #[serde(default)]
    pub drift: Drift,
    /// Fast noise.
    #[serde(default)]
    pub noise: GyroNoise,
}

fn three_axes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[Axis; 3], D::Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Axes {
        x: Axis,
        y: Axis,
        z: Axis,
    }
    let Axes { x, y, z } = Axes::deserialize(deserializer)?;
    Ok([x, y, z])
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

    /// Arcsec per rate unit times s.
    pub(crate) const fn arcsec_per_angle(self, scale_factor_arcsec: f64) -> f64 {
        match self {
            Self::PulsesPerS => scale_factor_arcsec,
            Self::Dph => 1.0,
            Self::Dps => 3600.0,
        }
    }
}

impl Unit {
    /// The TOML text of a name in [`UNITS`].
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn source(name: &str) -> Result<&'static str, UnknownName> {
        let known = UNITS.iter().position(|known| *known == name);
        known.map(|index| FILES[index]).ok_or_else(|| UnknownName {
            kind: "unit",
            name: name.to_owned(),
            known: UNITS,
        })
    }

    /// The unit of a name in [`UNITS`].
    ///
    /// | name | what it is |
    /// | --- | --- |
    /// | `paper` | the ring laser gyro of Weng et al., Sensors 2020, 20(2), 377, as far as it is printed: the static bias of table 2 (for Z, the spread of table 1) and rate sensitivities of the size that table 3 implies; time constants and noise are ours |
    /// | `smooth` | a ring laser gyro with smooth curves and no memory: what a model should fit to the noise |
    /// | `wavy` | curves with several waves over the range: too many for four segments |
    /// | `hysteretic` | plays, gradients, modes, self-heating, drift: what a model cannot remove |
    /// | `ln100` | noise as measured on a navigation-grade ring laser unit at 64 Hz |
    /// | `mems` | a MEMS gyro with rate output in deg/s and a thermometer of whole degrees |
    /// | `fog` | a fibre-optic gyro with rate output in deg/h and a large rate sensitivity |
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn named(name: &str) -> Result<Self, UnknownName> {
        let unit = file::unit(name, Self::source(name)?);
        Ok(unit.expect("the units of this crate are valid"))
    }

    /// Finds the first part that cannot be.
    ///
    /// # Errors
    ///
    /// [`Invalid`] names it.
    pub fn check(&self) -> Result<(), Invalid> {
        self.output.check(self.rate_unit)?;
        let inside = |part: &'static str| move |error: Invalid| error.inside(part);
        self.thermal.check().map_err(inside("thermal"))?;
        self.temperature.check().map_err(inside("temperature"))?;
        check_count("tone", self.tone.len())?;
        for (index, tone) in self.tone.iter().enumerate() {
            let place = element("tone", index);
            tone.check().map_err(|error| error.inside(place))?;
        }
        Range::new(0.0, 0.999).check("lost_rows", self.lost_rows)?;
        for (axis, name) in self.axes.iter().zip(AXIS_NAMES) {
            let place = format!("axis.{name}");
            axis.check().map_err(|error| error.inside(place))?;
        }
        Ok(())
    }

    /// Angle of a rate unit times s, arcsec.
    pub(crate) fn arcsec_per_angle(&self) -> f64 {
        let scale_factor_arcsec = match self.output {
            Output::Pulses {
                scale_factor_arcsec,
            } => scale_factor_arcsec,
            Output::Rate { .. } => 1.0,
        };
        self.rate_unit.arcsec_per_angle(scale_factor_arcsec)
    }
}

impl Output {
    fn check(&self, rate_unit: RateUnit) -> Result<(), Invalid> {
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

impl Axis {
    fn check(&self) -> Result<(), Invalid> {
        let inside = |part: &'static str| move |error: Invalid| error.inside(part);
        self.static_curve.check().map_err(inside("static_curve"))?;
        let signed = Range::SIGNED;
        signed.check("rate_sensitivity", self.rate_sensitivity)?;
        let slope = self.rate_sensitivity_slope_per_c;
        Range::new(-1.0, 1.0).check("rate_sensitivity_slope_per_c", slope)?;
        signed.check("gradient_sensitivity", self.gradient_sensitivity)?;
        check_count("play", self.play.len())?;
        for (index, play) in self.play.iter().enumerate() {
            let place = element("play", index);
            play.check().map_err(|error| error.inside(place))?;
        }
        if let Some(modes) = self.modes {
            modes.check().map_err(inside("modes"))?;
        }
        self.drift.check().map_err(inside("drift"))?;
        self.noise.check().map_err(inside("noise"))
    }
}

fn check_count(list: &str, count: usize) -> Result<(), Invalid> {
    if count <= 16 {
        Ok(())
    } else {
        let found = format!("a list of {count}");
        Err(Invalid::new(list, found, "16 elements at most"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_exists_and_no_other() {
        for name in UNITS {
            let unit = Unit::named(name).unwrap();
            assert_eq!(unit.name, *name);
            assert!(!unit.description.is_empty(), "{name}");
        }
        let error = Unit::named("Paper").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown unit `Paper`, expected one of: paper, smooth, wavy, hysteretic, ln100, mems, fog"
        );
    }
}
