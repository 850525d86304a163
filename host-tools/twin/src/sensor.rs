//! The temperature sensor.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::events::{Fault, FaultKind};
use crate::normal::{NormalSource, Stream};

/// How the temperature is read.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemperatureReading {
    /// White noise of one reading before quantisation, sigma in degC.
    #[serde(default)]
    pub sigma_c: f64,
    /// Step of the reading, degC; 0 for none. 0.0625 and 1 are common.
    #[serde(default)]
    pub step_c: f64,
    /// What it reads short and open, degC: no reading is outside.
    #[serde(default = "default_rails_c")]
    pub rails_c: [f64; 2],
}

const fn default_rails_c() -> [f64; 2] {
    [-99.0, 199.0]
}

impl TemperatureReading {
    /// Neither noise nor steps.
    pub const EXACT: Self = Self {
        sigma_c: 0.0,
        step_c: 0.0,
        rails_c: default_rails_c(),
    };

    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::new(0.0, 100.0).check("sigma_c", self.sigma_c)?;
        Range::new(0.0, 50.0).check("step_c", self.step_c)?;
        let [low_c, high_c] = self.rails_c;
        Range::TEMPERATURE.check("rails_c", low_c)?;
        Range::TEMPERATURE.check("rails_c", high_c)?;
        if low_c < high_c {
            Ok(())
        } else {
            let found = format!("{low_c} to {high_c}");
            Err(Invalid::new("rails_c", found, "a lower and a higher end"))
        }
    }
}

/// The temperature sensor.
#[derive(Debug, Clone)]
pub(crate) struct TemperatureSensor {
    noise: NormalSource,
    reading: TemperatureReading,
    /// The last reading there was.
    held_c: Option<f64>,
}

impl TemperatureSensor {
    pub(crate) fn new(reading: &TemperatureReading, seed: u64) -> Self {
        Self {
            noise: NormalSource::new(seed, Stream::Temperature),
            reading: *reading,
            held_c: None,
        }
    }

    /// One reading, degC, with the sensor at `sensor_c`. The faults are those that are there.
    pub(crate) fn read<'a>(
        &mut self,
        sensor_c: f64,
        faults: impl Iterator<Item = &'a Fault> + Clone,
    ) -> f64 {
        let [low_c, high_c] = self.reading.rails_c;
        let offset_c: f64 = faults.clone().map(|fault| offset_c(fault.what)).sum();
        let noisy_c = sensor_c + self.reading.sigma_c * self.noise.next() + offset_c;
        let converted_c = self.converted(noisy_c).clamp(low_c, high_c);
        let reading_c = faults.fold(converted_c, |reading_c, fault| match fault.what {
            FaultKind::TemperatureStuck => self.held_c.unwrap_or(reading_c),
            FaultKind::TemperatureOpen => high_c,
            FaultKind::TemperatureShort => low_c,
            FaultKind::TemperatureMissing => f64::NAN,
            _ => reading_c,
        });
        if !reading_c.is_nan() {
            self.held_c = Some(reading_c);
        }
        reading_c
    }

    /// The converter's reading of a temperature.
    fn converted(&self, noisy_c: f64) -> f64 {
        let step_c = self.reading.step_c;
        if step_c > 0.0 {
            // Half a step is rounded up on both sides of 0, as in an integrating converter.
            (noisy_c / step_c + 0.5).floor() * step_c
        } else {
            noisy_c
        }
    }
}

fn offset_c(fault: FaultKind) -> f64 {
    match fault {
        FaultKind::TemperatureOffset { by_c } | FaultKind::TemperatureSpike { by_c } => by_c,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const READING: TemperatureReading = TemperatureReading {
        sigma_c: 0.02,
        step_c: 0.0625,
        rails_c: [-55.0, 150.0],
    };

    fn mean_and_sigma(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (mean, (square / (n - 1.0)).sqrt())
    }

    #[test]
    fn readings_are_noisy_multiples_of_the_step() {
        let mut sensor = TemperatureSensor::new(&READING, 1);
        let readings: Vec<f64> = (0..20_000)
            .map(|_| sensor.read(-3.03125, [].iter()))
            .collect();
        assert!(readings.iter().all(|t| (t / 0.0625).fract() == 0.0));
        // Half a step from either code, both come up alike.
        let (mean, _) = mean_and_sigma(&readings);
        assert!((mean + 3.03125).abs() < 0.001, "{mean}");

        let reading = TemperatureReading {
            step_c: 0.0,
            ..READING
        };
        let mut sensor = TemperatureSensor::new(&reading, 1);
        let readings: Vec<f64> = (0..20_000).map(|_| sensor.read(40.0, [].iter())).collect();
        let (mean, sigma) = mean_and_sigma(&readings);
        assert!((mean - 40.0).abs() < 0.001, "{mean}");
        assert!((sigma / 0.02 - 1.0).abs() < 0.05, "{sigma}");
    }

    #[test]
    fn faults_do_what_they_are_called() {
        let exact = TemperatureReading {
            sigma_c: 0.0,
            step_c: 1.0,
            ..READING
        };
        let mut sensor = TemperatureSensor::new(&exact, 1);
        let mut read = |sensor_c: f64, kinds: &[FaultKind]| {
            let faults: Vec<Fault> = kinds
                .iter()
                .map(|&what| Fault {
                    at_min: 0.0,
                    duration_min: 1.0,
                    what,
                })
                .collect();
            sensor.read(sensor_c, faults.iter())
        };
        // With nothing read yet there is nothing to be stuck at.
        assert_eq!(read(20.2, &[FaultKind::TemperatureStuck]), 20.0);
        assert_eq!(read(25.0, &[FaultKind::TemperatureStuck]), 20.0);
        assert_eq!(read(25.0, &[FaultKind::TemperatureOpen]), 150.0);
        assert_eq!(read(25.0, &[FaultKind::TemperatureShort]), -55.0);
        assert!(read(25.0, &[FaultKind::TemperatureMissing]).is_nan());
        assert_eq!(read(25.0, &[FaultKind::TemperatureStuck]), -55.0);
        let off = |by_c| FaultKind::TemperatureOffset { by_c };
        assert_eq!(read(25.0, &[off(5.0), off(-2.0)]), 28.0);
        assert_eq!(
            read(25.0, &[FaultKind::TemperatureSpike { by_c: 500.0 }]),
            150.0
        );
        assert_eq!(read(25.0, &[FaultKind::RowsLost]), 25.0);
    }
}
