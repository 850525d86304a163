//! The simulated units that have a name.

use crate::bias::{AxisBias, StaticCurve};
use crate::error::UnknownName;
use crate::noise::NoiseLevels;
use crate::thermal::ThermalNetwork;

/// Names of the axes, in the order of every array of three.
pub const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// Names that [`Unit::named`] accepts.
pub const UNITS: &[&str] = &[PAPER];

const PAPER: &str = "paper";

/// A gyro unit: three axes in one case with one temperature sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Name of the unit.
    pub name: String,
    /// Heat flow from the air to the cavities.
    pub thermal: ThermalNetwork,
    /// True bias of the axes [`AXIS_NAMES`].
    pub bias: [AxisBias; 3],
    /// Noise of the gyro and temperature channels.
    pub noise: NoiseLevels,
}

impl Unit {
    /// The unit of a name in [`UNITS`].
    ///
    /// `paper` is the unit of Weng et al., Sensors 2020, 20(2), 377, as far as it is printed: the
    /// static bias of table 2 (for Z, the spread of table 1) and rate sensitivities of the size
    /// that table 3 implies. Time constants and noise are ours.
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn named(name: &str) -> Result<Self, UnknownName> {
        match name {
            PAPER => Ok(Self::paper()),
            _ => Err(UnknownName {
                kind: "unit",
                name: name.to_owned(),
                known: UNITS,
            }),
        }
    }

    fn paper() -> Self {
        let axis = |static_curve, rate_sensitivity| AxisBias {
            static_curve,
            rate_sensitivity,
            rate_sensitivity_slope_per_c: 0.004,
        };
        Self {
            name: PAPER.to_owned(),
            thermal: ThermalNetwork {
                case_time_constant_s: 360.0,
                cavity_time_constant_s: [300.0, 420.0, 240.0],
            },
            bias: [
                axis(StaticCurve::paper_x(), 0.07),
                axis(StaticCurve::paper_y(), 0.02),
                axis(StaticCurve::paper_z(), 0.015),
            ],
            noise: NoiseLevels::TYPICAL,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_exists_and_no_other() {
        for name in UNITS {
            assert_eq!(Unit::named(name).unwrap().name, *name);
        }
        let error = Unit::named("Paper").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown unit `Paper`, expected one of: paper"
        );
    }
}
