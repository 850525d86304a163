//! Temperature sensors and a gyro for tempco, over embedded-hal 1.0.
//!
//! | sensor | chip | conversion |
//! |---|---|---|
//! | platinum, PT100 or PT1000 | MAX31865 ([`Max31865`]) | [`Platinum`]: Callendar-Van Dusen |
//! | thermistor (NTC) | ADS1220 ([`Ads1220`]) | [`Divider`], [`Thermistor`]: Steinhart-Hart |
//! | digital | TMP117 ([`Tmp117`]) | none |
//!
//! A reading is a temperature \[degC\] or a [`SensorFault`]; [`for_core`] turns it into what
//! the compensator takes. Nothing waits for a conversion: it is started, and read when due. What
//! the chips want in microseconds and less is waited for: by the drivers within a selection, by
//! [`ChipSelect`] around it.
//!
//! The TMP117 is driven by the crate `tmp117`. For the MAX31865 and the ADS1220 there was no
//! maintained crate for embedded-hal 1.0.
//!
//! The gyro is an ICM-42688-P ([`icm42688`]), read in blocks from its FIFO.
//!
//! Conversions are in f64 by `libm`, so that a host finds the same values; they run as often as
//! temperatures are measured, not per gyro sample.
#![no_std]
#![forbid(unsafe_code)]

mod ads1220;
mod chip_select;
mod divider;
pub mod icm42688;
mod max31865;
mod platinum;
mod thermistor;
mod tmp117;

pub use crate::tmp117::Tmp117;
pub use ads1220::{Ads1220, Gain, Input, Rate};
pub use chip_select::ChipSelect;
pub use divider::Divider;
pub use max31865::{Filter, Max31865, Wires};
pub use platinum::Platinum;
pub use thermistor::Thermistor;

use core::fmt;

/// Why there is no temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SensorFault {
    /// The bus failed, or the chip does not answer as it should.
    Bus,
    /// The sensor or a wire to it is open.
    Open,
    /// The sensor or a wire to it is short-circuited.
    Short,
    /// A voltage is beyond what the chip can measure.
    Rail,
    /// No conversion has ended since the last reading.
    NotReady,
}

impl fmt::Display for SensorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bus => "the bus failed or the chip does not answer",
            Self::Open => "the sensor is open",
            Self::Short => "the sensor is short-circuited",
            Self::Rail => "a voltage is out of range",
            Self::NotReady => "no conversion has ended",
        })
    }
}

impl core::error::Error for SensorFault {}

/// A reading as the compensator takes it: NaN for a sensor that failed, so that the last good
/// temperature is held and the status says so; nothing where there is no news yet, in which case
/// there is nothing to update with.
pub fn for_core(reading: Result<f32, SensorFault>) -> Option<f32> {
    match reading {
        Ok(temp_c) => Some(temp_c),
        Err(SensorFault::NotReady) => None,
        Err(_) => Some(f32::NAN),
    }
}
