//! What tables must be like: units, scale factor and largest bias of the board and of the table
//! that the image was built with.

use tempco_image::{Fit, Unit as AxisUnit};

use super::devices::Gyro;
use super::{AXES, CHANNELS};
use crate::table;

/// Units of the axes, as of the table the image was built with: the output is in these, whatever
/// table is loaded.
pub const UNITS: [[AxisUnit; AXES]; CHANNELS] = {
    let mut units = [[AxisUnit::PulsesPerS; AXES]; CHANNELS];
    let mut channel = 0;
    while channel < CHANNELS {
        let mut axis = 0;
        while axis < AXES {
            units[channel][axis] = unit(table::AXIS_UNITS[channel][axis]);
            axis += 1;
        }
        channel += 1;
    }
    units
};

const fn unit(name: &str) -> AxisUnit {
    match name.as_bytes() {
        b"dph" => AxisUnit::Dph,
        b"dps" => AxisUnit::Dps,
        b"radps" => AxisUnit::Radps,
        b"pulses_per_s" => AxisUnit::PulsesPerS,
        b"mps2" => AxisUnit::Mps2,
        b"g" => AxisUnit::G,
        // Only while the image is built.
        _ => panic!("AXIS_UNITS of the table: no such unit"),
    }
}

/// What a count per second is in a unit.
fn per_count<G: Gyro<C, A>, const C: usize, const A: usize>(unit: AxisUnit) -> f32 {
    let per_pulse = match unit {
        // One arc second per second is one degree per hour.
        AxisUnit::Dph => G::SCALE_FACTOR_ARCSEC,
        AxisUnit::Dps => G::SCALE_FACTOR_ARCSEC / 3600.0,
        AxisUnit::Radps => G::SCALE_FACTOR_ARCSEC * core::f32::consts::PI / 648_000.0,
        // Tables of accelerations are refused.
        AxisUnit::PulsesPerS | AxisUnit::Mps2 | AxisUnit::G => 1.0,
    };
    G::PULSES_PER_COUNT * per_pulse
}

/// From counts per sample to the unit of each axis.
pub fn scale<G: Gyro<C, A>, const C: usize, const A: usize>(
    units: &[[AxisUnit; A]; C],
    sample_rate_hz: f32,
) -> [[f32; A]; C] {
    units.map(|axes| axes.map(|unit| per_count::<G, C, A>(unit) * sample_rate_hz))
}

/// What a table must fit.
pub fn fits<G: Gyro<C, A>, const C: usize, const A: usize>(
    units: &[[AxisUnit; A]; C],
) -> [[Fit; A]; C] {
    let fit = |unit| Fit {
        unit,
        scale_factor_arcsec: G::SCALE_FACTOR_ARCSEC,
        max_bias: G::MAX_TABLE_BIAS * per_count::<G, C, A>(unit),
    };
    units.map(|axes| axes.map(fit))
}
