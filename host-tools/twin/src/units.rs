//! The units that have a name.

use crate::error::UnknownName;
use crate::file;
use crate::unit::Unit;

/// Names that [`Unit::named`] accepts.
pub const UNITS: &[&str] = &[
    "paper",
    "smooth",
    "wavy",
    "hysteretic",
    "ln100",
    "mems",
    "fog",
    "gradient",
    "mode_hops",
    "fibre",
    "loop",
];

const FILES: [&str; 11] = [
    include_str!("../units/paper.toml"),
    include_str!("../units/smooth.toml"),
    include_str!("../units/wavy.toml"),
    include_str!("../units/hysteretic.toml"),
    include_str!("../units/ln100.toml"),
    include_str!("../units/mems.toml"),
    include_str!("../units/fog.toml"),
    include_str!("../units/gradient.toml"),
    include_str!("../units/mode_hops.toml"),
    include_str!("../units/fibre.toml"),
    include_str!("../units/loop.toml"),
];

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
    /// | `gradient` | a ring laser gyro far behind its thermometer: gradient from case to cavity, self-heating |
    /// | `mode_hops` | a ring laser gyro whose bias drifts within a mode and steps back at each hop |
    /// | `fibre` | a fibre-optic gyro with its thermometer at the hub, behind the coil |
    /// | `loop` | a ring laser gyro with hysteresis as large as its curves, long lags, no mode steps |
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn named(name: &str) -> Result<Self, UnknownName> {
        let unit = file::unit(name, Self::source(name)?);
        Ok(unit.expect("the units of this crate are valid"))
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
            "unknown unit `Paper`, expected one of: paper, smooth, wavy, hysteretic, ln100, mems, fog, \
             gradient, mode_hops, fibre, loop"
        );
    }
}
