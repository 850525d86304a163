//! A gyro unit: what it is made of.

use serde::{Deserialize, Deserializer};

use crate::check::{Invalid, Range, element};
use crate::curve::StaticCurve;
use crate::drift::Drift;
use crate::gyro::GyroNoise;
use crate::hysteresis::{ModeSteps, Play};
use crate::output::{Output, RateUnit};
use crate::sensor::TemperatureReading;
use crate::thermal::ThermalNetwork;
use crate::tone::Tone;

/// Names of the axes, in the order of every array of three.
pub const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

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

impl Unit {
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
