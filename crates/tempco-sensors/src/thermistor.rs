//! Thermistors by the Steinhart-Hart equation.

use crate::SensorFault;

/// 0 degC \[K\].
const ZERO_C_IN_K: f64 = 273.15;

/// A thermistor: `1 / T = a + b ln R + c (ln R)^3`, T in kelvin, R in ohm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Thermistor {
    /// \[1/K\]
    pub a: f64,
    /// \[1/K\]
    pub b: f64,
    /// \[1/K\]
    pub c: f64,
}

impl Thermistor {
    /// By the beta equation, `R = R25 exp(beta (1/T - 1/298.15))`, which data sheets give for
    /// narrow ranges \[ohm, K\].
    pub fn from_beta(r25_ohm: f64, beta_k: f64) -> Self {
        let b = 1.0 / beta_k;
        Self {
            a: 1.0 / (25.0 + ZERO_C_IN_K) - b * libm::log(r25_ohm),
            b,
            c: 0.0,
        }
    }

    /// Temperature at a resistance \[degC\].
    ///
    /// # Errors
    /// Resistances that belong to no temperature from -100 to 300 degC: [`SensorFault::Open`] on the
    /// cold side, where the resistance is high, and [`SensorFault::Short`] on the hot one.
    pub fn temp_c(&self, r_ohm: f64) -> Result<f32, SensorFault> {
        // Also where it is not a number.
        if r_ohm.is_nan() || r_ohm == f64::INFINITY {
            return Err(SensorFault::Open);
        }
        if r_ohm <= 0.0 {
            return Err(SensorFault::Short);
        }
        let log = libm::log(r_ohm);
        let inverse_k = self.a + log * (self.b + self.c * log * log);
        let temp_c = 1.0 / inverse_k - ZERO_C_IN_K;
        if inverse_k <= 0.0 || temp_c > 300.0 {
            Err(SensorFault::Short)
        } else if temp_c < -100.0 {
            Err(SensorFault::Open)
        } else {
            Ok(temp_c as f32)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beta_equation_is_inverted() {
        let thermistor = Thermistor::from_beta(10_000.0, 3977.0);
        for temp_c in [-40.0_f64, 0.0, 25.0, 50.0, 125.0] {
            let exponent = 3977.0 * (1.0 / (temp_c + 273.15) - 1.0 / 298.15);
            let found = f64::from(thermistor.temp_c(10_000.0 * libm::exp(exponent)).unwrap());
            assert!((found - temp_c).abs() < 1e-5, "{temp_c}: {found}");
        }
    }

    /// The three-term equation, solved for the resistance by bisection.
    #[test]
    fn all_three_terms_count() {
        let thermistor = Thermistor {
            a: 1.129_148e-3,
            b: 2.341_25e-4,
            c: 8.767_41e-8,
        };
        for temp_c in [-40.0_f64, 0.0, 25.0, 85.0, 125.0] {
            let (mut low, mut high) = (1.0_f64, 1e7_f64);
            for _ in 0..200 {
                let middle = libm::sqrt(low * high);
                let log = libm::log(middle);
                let kelvin =
                    1.0 / (1.129_148e-3 + 2.341_25e-4 * log + 8.767_41e-8 * log * log * log);
                if kelvin - 273.15 > temp_c {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let found = f64::from(thermistor.temp_c(low).unwrap());
            assert!((found - temp_c).abs() < 1e-5, "{temp_c}: {found}");
        }
        let at_25 = f64::from(thermistor.temp_c(10_000.0).unwrap());
        assert!((at_25 - 25.0).abs() < 0.01, "{at_25}");
    }

    #[test]
    fn impossible_resistances_are_faults() {
        let thermistor = Thermistor::from_beta(10_000.0, 3977.0);
        for r_ohm in [-1.0, 0.0, 1e-3, 1.0, f64::NEG_INFINITY] {
            assert_eq!(thermistor.temp_c(r_ohm), Err(SensorFault::Short), "{r_ohm}");
        }
        for r_ohm in [1e9, 1e300, f64::INFINITY, f64::NAN] {
            assert_eq!(thermistor.temp_c(r_ohm), Err(SensorFault::Open), "{r_ohm}");
        }
    }
}
