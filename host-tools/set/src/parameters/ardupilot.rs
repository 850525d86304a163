//! Parameters of ArduPilot.
//!
//! ```text
//! P(d) = (GYR1 + (GYR2 + GYR3 d) d) d 1e-6,     d = clamp(T, TMIN, TMAX) - 35
//! rate = raw - offset - (P(T) - P(T at the calibration of the offset))      [rad/s]
//! ```
//!
//! There is no constant: the autopilot takes it out itself, as the offset of its calibration at rest.

use std::fmt::Write;
use std::ops::RangeInclusive;

use super::cubic::Cubics;
use super::{AXES, Parameters};

pub(super) const INSTANCES: RangeInclusive<u32> = 1..=3;

/// Temperature about which the coefficients are \[degC\].
const CENTRE_C: f64 = 35.0;

/// What coefficients are multiplied by, so that parameters have digits.
const SCALE: f64 = 1e6;

/// A parameter file: name and value.
pub(super) fn write(cubics: &Cubics, instance: u32) -> String {
    let cubics = cubics.about(CENTRE_C);
    let mut text = String::new();
    let mut line = |name: &str, value: f64| {
        writeln!(text, "INS_TCAL{instance}_{name},{}", value as f32).expect("a string takes all");
    };
    line("ENABLE", 1.0);
    line("TMIN", cubics.range_c.0);
    line("TMAX", cubics.range_c.1);
    for power in 1..4 {
        for (axis, cubic) in AXES.iter().zip(&cubics.axes) {
            let name = format!("GYR{power}_{}", axis.to_uppercase());
            line(&name, SCALE * cubic[power]);
        }
    }
    text
}

pub(super) fn read(parameters: &Parameters, instance: u32) -> Result<Cubics, String> {
    let value = |name: &str| parameters.get(&format!("INS_TCAL{instance}_{name}"));
    let mut axes = [[0.0; 4]; AXES.len()];
    for (axis, cubic) in AXES.iter().zip(&mut axes) {
        for (power, coefficient) in cubic.iter_mut().enumerate().skip(1) {
            *coefficient = value(&format!("GYR{power}_{}", axis.to_uppercase()))? / SCALE;
        }
    }
    Ok(Cubics {
        centre_c: CENTRE_C,
        range_c: (value("TMIN")?, value("TMAX")?),
        axes,
    })
}
