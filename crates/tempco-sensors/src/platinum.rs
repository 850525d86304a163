//! Platinum resistors by the Callendar-Van Dusen equation.

use crate::SensorFault;

/// Coefficients of IEC 60751.
const A: f64 = 3.9083e-3;
const B: f64 = -5.775e-7;
const C: f64 = -4.183e-12;

/// Range of the equation \[degC\].
const RANGE_C: (f64, f64) = (-200.0, 850.0);

/// A platinum resistor after IEC 60751.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Platinum {
    /// Resistance at 0 degC \[ohm\].
    pub r0_ohm: f64,
}

impl Platinum {
    /// 100 ohm at 0 degC.
    pub const PT100: Self = Self { r0_ohm: 100.0 };
    /// 1000 ohm at 0 degC.
    pub const PT1000: Self = Self { r0_ohm: 1000.0 };

    /// Resistance at a temperature from -200 to 850 degC \[ohm\]:
    /// `R0 (1 + A T + B T^2 + C (T - 100) T^3)`, the last term below 0 degC only.
    pub fn resistance_ohm(&self, temp_c: f64) -> f64 {
        let quadratic = 1.0 + temp_c * (A + temp_c * B);
        let below_zero = if temp_c < 0.0 {
            C * (temp_c - 100.0) * temp_c * temp_c * temp_c
        } else {
            0.0
        };
        self.r0_ohm * (quadratic + below_zero)
    }

    /// Temperature at a resistance \[degC\], by the inverse of
    /// [`resistance_ohm`](Self::resistance_ohm), within 3e-9 degC before rounding to f32.
    ///
    /// # Errors
    /// [`SensorFault::Short`] below the resistance at -200 degC, [`SensorFault::Open`] above that
    /// at 850 degC or where it is not a number.
    pub fn temp_c(&self, r_ohm: f64) -> Result<f32, SensorFault> {
        if r_ohm < self.resistance_ohm(RANGE_C.0) {
            return Err(SensorFault::Short);
        }
        if r_ohm.is_nan() || r_ohm > self.resistance_ohm(RANGE_C.1) {
            return Err(SensorFault::Open);
        }
        // The form of the solution that does not cancel near 0 degC.
        let excess = 1.0 - r_ohm / self.r0_ohm;
        let mut temp_c = 2.0 * excess / (-A - libm::sqrt(A * A - 4.0 * B * excess));
        if temp_c < 0.0 {
            // The quadratic is off by 2.4 degC at most; of Newton, the first step leaves
            // 2.5e-3 degC and the second 2.7e-9.
            for _ in 0..2 {
                let cubic = C * temp_c * temp_c * (4.0 * temp_c - 300.0);
                let slope = self.r0_ohm * (A + 2.0 * B * temp_c + cubic);
                temp_c -= (self.resistance_ohm(temp_c) - r_ohm) / slope;
            }
        }
        Ok(temp_c as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the tables of IEC 60751 for 100 ohm, which have two decimals.
    #[test]
    fn the_tables_of_the_standard_are_met() {
        for (temp_c, r_ohm) in [
            (-200.0, 18.52),
            (-100.0, 60.26),
            (-50.0, 80.31),
            (0.0, 100.0),
            (25.0, 109.73),
            (100.0, 138.51),
            (200.0, 175.86),
            (400.0, 247.09),
            (850.0, 390.48),
        ] {
            let found = Platinum::PT100.resistance_ohm(temp_c);
            assert!((found - r_ohm).abs() < 0.0051, "{temp_c}: {found}");
            let found = Platinum::PT1000.resistance_ohm(temp_c);
            assert!((found - 10.0 * r_ohm).abs() < 0.051, "{temp_c}: {found}");
        }
    }

    #[test]
    fn the_inverse_is_exact_to_f32_everywhere() {
        for step in 0..=10_500 {
            let temp_c = -200.0 + 0.1 * f64::from(step);
            let r_ohm = Platinum::PT1000.resistance_ohm(temp_c);
            let found = Platinum::PT1000.temp_c(r_ohm.clamp(
                Platinum::PT1000.resistance_ohm(-200.0),
                Platinum::PT1000.resistance_ohm(850.0),
            ));
            let error = f64::from(found.unwrap()) - temp_c;
            assert!(
                error.abs() <= 6.1e-8 * temp_c.abs() + 1e-9,
                "{temp_c}: {error}"
            );
        }
    }

    #[test]
    fn impossible_resistances_are_faults() {
        let of = |r_ohm| Platinum::PT100.temp_c(r_ohm);
        for r_ohm in [-1.0, 0.0, 18.5, f64::NEG_INFINITY] {
            assert_eq!(of(r_ohm), Err(SensorFault::Short), "{r_ohm}");
        }
        for r_ohm in [390.6, f64::INFINITY, f64::NAN] {
            assert_eq!(of(r_ohm), Err(SensorFault::Open), "{r_ohm}");
        }
    }
}
