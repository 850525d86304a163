//! From counts of the gyro to units of the table, and what tables must be like: units, scale factor
//! and largest bias of the board and of the table that the image was built with.

use tempco_image::{Fit, Unit as AxisUnit};

use super::devices::{Count, Gyro};
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

/// What an axis shows by a count per second, or of rates by a count, in the unit of each axis.
pub fn per_count<G: Gyro<C, A>, const C: usize, const A: usize>(
    units: &[[AxisUnit; A]; C],
) -> [[f32; A]; C] {
    each_axis(|channel, axis| in_unit::<G, C, A>(G::COUNTS[channel][axis], units[channel][axis]))
}

fn in_unit<G: Gyro<C, A>, const C: usize, const A: usize>(count: Count, unit: AxisUnit) -> f32 {
    const DEG: f32 = core::f32::consts::PI / 180.0;
    match count {
        Count::Pulses(pulses) => {
            pulses
                * match unit {
                    // One arc second per second is one degree per hour.
                    AxisUnit::Dph => G::SCALE_FACTOR_ARCSEC,
                    AxisUnit::Dps => G::SCALE_FACTOR_ARCSEC / 3600.0,
                    AxisUnit::Radps => G::SCALE_FACTOR_ARCSEC * core::f32::consts::PI / 648_000.0,
                    // Tables of accelerations are refused.
                    AxisUnit::PulsesPerS | AxisUnit::Mps2 | AxisUnit::G => 1.0,
                }
        }
        Count::Rate(deg_per_s) => match unit {
            AxisUnit::Dph => deg_per_s * 3600.0,
            AxisUnit::Dps => deg_per_s,
            AxisUnit::Radps => deg_per_s * DEG,
            // A table of raw counts. Tables of accelerations are refused.
            AxisUnit::PulsesPerS | AxisUnit::Mps2 | AxisUnit::G => 1.0,
        },
    }
}

/// From counts of a sample to the unit of each axis. An increment is of the time between two samples.
pub fn scale<G: Gyro<C, A>, const C: usize, const A: usize>(
    units: &[[AxisUnit; A]; C],
    sample_rate_hz: f32,
) -> [[f32; A]; C] {
    let per_count = per_count::<G, C, A>(units);
    each_axis(|channel, axis| match G::COUNTS[channel][axis] {
        Count::Pulses(_) => per_count[channel][axis] * sample_rate_hz,
        Count::Rate(_) => per_count[channel][axis],
    })
}

/// What a table must fit.
pub fn fits<G: Gyro<C, A>, const C: usize, const A: usize>(
    units: &[[AxisUnit; A]; C],
) -> [[Fit; A]; C] {
    let per_count = per_count::<G, C, A>(units);
    each_axis(|channel, axis| Fit {
        unit: units[channel][axis],
        scale_factor_arcsec: G::SCALE_FACTOR_ARCSEC,
        max_bias: G::MAX_TABLE_BIAS * per_count[channel][axis],
    })
}

fn each_axis<V, const C: usize, const A: usize>(of: impl Fn(usize, usize) -> V) -> [[V; A]; C] {
    core::array::from_fn(|channel| core::array::from_fn(|axis| of(channel, axis)))
}

#[cfg(test)]
mod tests {
    use tempco::Status;

    use super::super::devices::AtRest;
    use super::*;

    /// A quarter of a pulse of 2 arcsec, and 0.5 deg/s.
    struct Both;

    impl Gyro<1, 2> for Both {
        const COUNTS: [[Count; 2]; 1] = [[Count::Pulses(0.25), Count::Rate(0.5)]];
        const SCALE_FACTOR_ARCSEC: f32 = 2.0;
        const AT_REST: AtRest = AtRest {
            sigma: 1.0,
            max_bias: 4.0,
        };
        const MAX_TABLE_BIAS: f32 = 100.0;

        fn sample(&mut self) -> Option<[[i32; 2]; 1]> {
            None
        }

        fn put(&mut self, _: &[[f32; 2]; 1], _: &[Status; 1]) {}
    }

    #[test]
    fn increments_and_rates_become_the_unit_of_their_axis() {
        // Of 1000 samples per second; and the largest bias of a table.
        for (unit, increment, rate, limit) in [
            (AxisUnit::Dph, 500.0, 1800.0, [50.0, 180_000.0]),
            (AxisUnit::Dps, 500.0 / 3600.0, 0.5, [50.0 / 3600.0, 50.0]),
            (
                AxisUnit::Radps,
                (500.0_f32 / 3600.0).to_radians(),
                0.5_f32.to_radians(),
                [(50.0_f32 / 3600.0).to_radians(), 50.0_f32.to_radians()],
            ),
            (AxisUnit::PulsesPerS, 250.0, 1.0, [25.0, 100.0]),
        ] {
            let near = |a: f32, b: f32| (a / b - 1.0).abs() < 1e-6;
            let [[a, b]] = scale::<Both, 1, 2>(&[[unit; 2]], 1000.0);
            assert!(near(a, increment) && near(b, rate), "{unit:?}: {a} {b}");
            let [fits] = fits::<Both, 1, 2>(&[[unit; 2]]);
            for (fit, limit) in fits.iter().zip(limit) {
                assert!(near(fit.max_bias, limit), "{unit:?}: {fit:?}");
                assert_eq!((fit.unit, fit.scale_factor_arcsec), (unit, 2.0));
            }
        }
    }
}
