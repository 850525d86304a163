//! A thermistor below a fixed resistor, measured against the voltage that feeds both.

use crate::SensorFault;

/// A code nearer to an end of its range than this share of it is at the rail.
const RAIL: f64 = 0.005;

/// A fixed resistor from the reference voltage to the thermistor, the thermistor to ground; the
/// converter measures the thermistor's share of the reference, which therefore cancels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Divider {
    /// The fixed resistor \[ohm\].
    pub fixed_ohm: f64,
}

impl Divider {
    /// Resistance of the thermistor, with its share of the reference voltage \[ohm\].
    ///
    /// # Errors
    /// [`SensorFault::Open`] within 0.5 % of the reference, [`SensorFault::Short`] within 0.5 % of
    /// ground.
    pub fn thermistor_ohm(&self, share: f64) -> Result<f64, SensorFault> {
        if share.is_nan() || share > 1.0 - RAIL {
            Err(SensorFault::Open)
        } else if share < RAIL {
            Err(SensorFault::Short)
        } else {
            Ok(self.fixed_ohm * share / (1.0 - share))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_a_resistance_and_a_rail_a_fault() {
        let divider = Divider {
            fixed_ohm: 10_000.0,
        };
        assert_eq!(divider.thermistor_ohm(0.5), Ok(10_000.0));
        assert_eq!(divider.thermistor_ohm(0.25), Ok(10_000.0 / 3.0));
        for share in [0.996, 1.0, 2.0, f64::NAN] {
            assert_eq!(divider.thermistor_ohm(share), Err(SensorFault::Open));
        }
        for share in [0.004, 0.0, -1.0] {
            assert_eq!(divider.thermistor_ohm(share), Err(SensorFault::Short));
        }
    }
}
