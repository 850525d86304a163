//! Parameters of PX4.
//!
//! ```text
//! d = clamp(T, TMIN, TMAX) - TREF
//! rate = raw - (X0 + X1 d + X2 d^2 + X3 d^3)      [rad/s]
//! ```

use std::fmt::Write;
use std::ops::RangeInclusive;

use super::cubic::Cubics;
use super::{AXES, Parameters};

pub(super) const INSTANCES: RangeInclusive<u32> = 0..=3;

/// Types of values in the file.
const INTEGER: u32 = 6;
const FLOAT: u32 = 9;

/// A parameter file as QGroundControl writes it: vehicle, component, name, value and type.
pub(super) fn write(cubics: &Cubics, instance: u32, device_id: i32) -> String {
    let mut text = String::from("# Vehicle-Id Component-Id Name Value Type\n");
    let mut line = |name: &str, value: &dyn std::fmt::Display, kind: u32| {
        writeln!(text, "1\t1\t{name}\t{value}\t{kind}").expect("a string takes all");
    };
    line("TC_G_ENABLE", &1, INTEGER);
    line(&format!("TC_G{instance}_ID"), &device_id, INTEGER);
    let (low, high) = cubics.range_c;
    for (name, value) in [("TMIN", low), ("TMAX", high), ("TREF", cubics.centre_c)] {
        line(&format!("TC_G{instance}_{name}"), &(value as f32), FLOAT);
    }
    for (axis, cubic) in cubics.axes.iter().enumerate() {
        for (power, value) in cubic.iter().enumerate() {
            let name = format!("TC_G{instance}_X{power}_{axis}");
            line(&name, &(*value as f32), FLOAT);
        }
    }
    text
}

pub(super) fn read(parameters: &Parameters, instance: u32) -> Result<Cubics, String> {
    let value = |name: &str| parameters.get(&format!("TC_G{instance}_{name}"));
    let mut axes = [[0.0; 4]; AXES.len()];
    for (axis, cubic) in axes.iter_mut().enumerate() {
        for (power, coefficient) in cubic.iter_mut().enumerate() {
            *coefficient = value(&format!("X{power}_{axis}"))?;
        }
    }
    Ok(Cubics {
        centre_c: value("TREF")?,
        range_c: (value("TMIN")?, value("TMAX")?),
        axes,
    })
}
