//! Temperature compensation as parameters of autopilots: a cubic in temperature for each gyro axis.
//!
//! ```text
//! set -> table of the core at rest -> cubic -> text of parameters -> cubic -> quadratic cells -> set
//!                                     (export)                       (import)
//! ```
//!
//! A cubic has no rate and no history. What it loses of a table is stated for each axis.

mod ardupilot;
mod cubic;
mod export;
mod import;
mod px4;

pub use export::{Exported, Loss, export_parameters};
pub use import::{Imported, import_parameters};

use std::collections::BTreeMap;

use tempco_log::AxisUnit;

use cubic::Cubics;

/// Whose parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Autopilot {
    /// `TC_G0_*`, as QGroundControl writes parameter files.
    Px4,
    /// `INS_TCAL1_*`, as Mission Planner and MAVProxy write them.
    ArduPilot,
}

impl Autopilot {
    /// The instances of a gyro that it knows, as users number them.
    pub const fn instances(self) -> std::ops::RangeInclusive<u32> {
        match self {
            Self::Px4 => px4::INSTANCES,
            Self::ArduPilot => ardupilot::INSTANCES,
        }
    }

    fn write(self, cubics: &Cubics, instance: u32, device_id: i32) -> String {
        match self {
            Self::Px4 => px4::write(cubics, instance, device_id),
            Self::ArduPilot => ardupilot::write(cubics, instance),
        }
    }

    fn read(self, parameters: &Parameters, instance: u32) -> Result<Cubics, String> {
        match self {
            Self::Px4 => px4::read(parameters, instance),
            Self::ArduPilot => ardupilot::read(parameters, instance),
        }
    }
}

/// The axes of a gyro, in the order of all parameters.
const AXES: [&str; 3] = ["x", "y", "z"];

/// What a bias in a unit is multiplied by to be in rad/s.
///
/// # Errors
/// A unit of something else than an angular rate.
fn to_rad_per_s(unit: AxisUnit) -> Result<f64, String> {
    match unit {
        AxisUnit::Radps => Ok(1.0),
        AxisUnit::Dps => Ok(1_f64.to_radians()),
        AxisUnit::Dph => Ok((1.0 / 3600.0_f64).to_radians()),
        AxisUnit::PulsesPerS => Err(
            "the axes are in pulses/s: expected a set in deg/h, fitted with --scale-factor"
                .to_owned(),
        ),
        AxisUnit::Mps2 | AxisUnit::G => Err(format!("the axes are in {unit}: expected gyros")),
    }
}

/// The numbers of a file of parameters, by name.
struct Parameters(BTreeMap<String, f64>);

impl Parameters {
    /// Reads lines whose cells are separated by tabs, commas or blanks; `name_and_value` says where the
    /// name and the value stand among them. Blank lines and lines that begin with `#` are left out.
    fn parse(text: &str, (name, value): (usize, usize)) -> Result<Self, String> {
        let mut parameters = BTreeMap::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let cells: Vec<&str> = line
                .split(['\t', ',', ' '])
                .filter(|cell| !cell.is_empty())
                .collect();
            let found = cells.get(name).zip(cells.get(value));
            let found = found.and_then(|(name, value)| Some((*name, value.parse::<f64>().ok()?)));
            let Some((name, value)) = found.filter(|(_, value)| value.is_finite()) else {
                return Err(format!(
                    "line {}: `{line}`: expected a parameter and its value",
                    number + 1
                ));
            };
            parameters.insert(name.to_owned(), value);
        }
        Ok(Self(parameters))
    }

    /// The value of a parameter.
    fn get(&self, name: &str) -> Result<f64, String> {
        let value = self.0.get(name).copied();
        value.ok_or_else(|| format!("no parameter {name}"))
    }
}
