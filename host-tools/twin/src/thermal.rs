//! Heat flow: air to case, case to block, block to the cavity of each gyro, and to the sensor.

use serde::Deserialize;

use crate::check::{Invalid, Range};

/// Heat flow of a unit: first-order lags in a row, with self-heating.
///
/// ```text
/// d(case)/dt   = (air    + case_rise   - case)   / case_time_constant
/// d(block)/dt  = (case   + block_rise  - block)  / block_time_constant
/// d(cavity)/dt = (block  + cavity_rise - cavity) / cavity_time_constant    for each axis
/// d(sensor)/dt = (part it sits on      - sensor) / sensor_time_constant
/// ```
///
/// On a long ramp each part lags the one before it by rate x time constant. The rises are there while
/// the unit is powered. What flows back from a part to the one before it is left out: parts get
/// lighter from the case inwards.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalNetwork {
    /// Air to case, s, 0.001 to 1e7.
    pub case_time_constant_s: f64,
    /// Case to block, s; 0 when the block is one with the case.
    #[serde(default)]
    pub block_time_constant_s: f64,
    /// Block to the cavity of the X, Y and Z gyro, s, 0.001 to 1e7.
    pub cavity_time_constant_s: [f64; 3],
    /// The part it sits on to the temperature sensor, s; 0 for none.
    #[serde(default)]
    pub sensor_time_constant_s: f64,
    /// The part that the temperature sensor sits on.
    #[serde(default)]
    pub sensor_on: Part,
    /// Self-heating of the case above the air, degC.
    #[serde(default)]
    pub case_rise_c: f64,
    /// Self-heating of the block above the case, degC; needs a block of its own.
    #[serde(default)]
    pub block_rise_c: f64,
    /// Self-heating of each cavity above the block, degC.
    #[serde(default)]
    pub cavity_rise_c: [f64; 3],
}

/// A part of the unit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The case.
    #[default]
    Case,
    /// The block that carries the gyros.
    Block,
}

/// Parts with a temperature: case, block, three cavities, sensor.
pub(crate) const NODES: usize = 6;
pub(crate) const CASE: usize = 0;
pub(crate) const BLOCK: usize = 1;
pub(crate) const CAVITY: usize = 2;
pub(crate) const SENSOR: usize = 5;

/// Temperatures of the parts, degC.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ThermalState(pub(crate) [f64; NODES]);

impl ThermalState {
    pub(crate) fn case_c(&self) -> f64 {
        self.0[CASE]
    }

    pub(crate) fn cavity_c(&self) -> [f64; 3] {
        core::array::from_fn(|axis| self.0[CAVITY + axis])
    }

    pub(crate) fn sensor_c(&self) -> f64 {
        self.0[SENSOR]
    }
}

/// A part with what it follows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lag {
    pub(crate) parent: Option<usize>,
    pub(crate) time_constant_s: f64,
    pub(crate) rise_c: f64,
}

impl ThermalNetwork {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        let time = Range::TIME_CONSTANT;
        time.check("case_time_constant_s", self.case_time_constant_s)?;
        for (name, value) in [
            ("block_time_constant_s", self.block_time_constant_s),
            ("sensor_time_constant_s", self.sensor_time_constant_s),
        ] {
            if value != 0.0 {
                time.check(name, value).map_err(|error| Invalid {
                    expected: format!("0 or {}", error.expected),
                    ..error
                })?;
            }
        }
        for value in self.cavity_time_constant_s {
            time.check("cavity_time_constant_s", value)?;
        }
        let rise = Range::new(-50.0, 50.0);
        rise.check("case_rise_c", self.case_rise_c)?;
        rise.check("block_rise_c", self.block_rise_c)?;
        for value in self.cavity_rise_c {
            rise.check("cavity_rise_c", value)?;
        }
        if self.block_time_constant_s == 0.0 && self.block_rise_c != 0.0 {
            return Err(Invalid::new(
                "block_rise_c",
                self.block_rise_c,
                "0 where block_time_constant_s is 0",
            ));
        }
        Ok(())
    }

    /// The parts, each after the one it follows.
    pub(crate) fn lags(&self) -> [Lag; NODES] {
        let lag = |parent, time_constant_s, rise_c| Lag {
            parent: Some(parent),
            time_constant_s,
            rise_c,
        };
        let cavity = |axis: usize| {
            let time_constant_s = self.cavity_time_constant_s[axis];
            lag(BLOCK, time_constant_s, self.cavity_rise_c[axis])
        };
        let sensor_parent = match self.sensor_on {
            Part::Case => CASE,
            Part::Block => BLOCK,
        };
        [
            Lag {
                parent: None,
                time_constant_s: self.case_time_constant_s,
                rise_c: self.case_rise_c,
            },
            lag(CASE, self.block_time_constant_s, self.block_rise_c),
            cavity(0),
            cavity(1),
            cavity(2),
            lag(sensor_parent, self.sensor_time_constant_s, 0.0),
        ]
    }

    /// The same without power: nothing warms itself.
    pub(crate) fn unpowered(&self) -> Self {
        Self {
            case_rise_c: 0.0,
            block_rise_c: 0.0,
            cavity_rise_c: [0.0; 3],
            ..*self
        }
    }

    /// All parts at their rises above the air.
    pub(crate) fn at_rest(&self, air_c: f64) -> ThermalState {
        ThermalState(self.rises_c().map(|rise_c| air_c + rise_c))
    }

    /// Rise of every part above the air, degC.
    pub(crate) fn rises_c(&self) -> [f64; NODES] {
        self.sums(|lag| lag.rise_c)
    }

    /// A quantity of each part and of all it follows, added up.
    pub(crate) fn sums(&self, quantity: impl Fn(&Lag) -> f64) -> [f64; NODES] {
        let mut sums = [0.0; NODES];
        for (node, lag) in self.lags().iter().enumerate() {
            sums[node] = lag.parent.map_or(0.0, |parent| sums[parent]) + quantity(lag);
        }
        sums
    }

    /// Rate of each cavity's temperature, degC/min.
    pub(crate) fn cavity_rate_c_per_min(&self, state: &ThermalState) -> [f64; 3] {
        core::array::from_fn(|axis| {
            let distance_c = state.0[BLOCK] + self.cavity_rise_c[axis] - state.0[CAVITY + axis];
            60.0 * distance_c / self.cavity_time_constant_s[axis]
        })
    }
}
