//! TMP117: a digital sensor, by the registers of the crate `tmp117`, whose own loops would wait.

use device_register::{EditRegister, ReadRegister};
use embedded_hal::i2c::I2c;
use tmp117::CELCIUS_CONVERSION;
use tmp117::register::{Average, Configuration, ConversionMode, Temperature};
use tmp117::tmp117_ll::Tmp117LL;

use crate::SensorFault;

/// What the register holds before the first conversion.
const NONE_YET: u16 = 0x8000;

/// The chip, on an I2C bus of up to 400 kHz.
pub struct Tmp117<I2C: I2c> {
    registers: Tmp117LL<I2C, I2C::Error>,
}

impl<I2C: I2c> Tmp117<I2C> {
    /// The chip at an address: 0x48 to 0x4b. [`start`](Self::start) comes next.
    pub fn new(i2c: I2C, address: u8) -> Self {
        Self {
            registers: Tmp117LL::new(i2c, address),
        }
    }

    /// Starts continuous conversion of means of eight, one per second with the interval as it is
    /// after power-on.
    ///
    /// # Errors
    /// [`SensorFault::Bus`].
    pub fn start(&mut self) -> Result<(), SensorFault> {
        self.registers
            .edit(|configuration: &mut Configuration| {
                configuration.set_mode(ConversionMode::Continuous);
                configuration.set_average(Average::Avg8);
            })
            .map_err(|_| SensorFault::Bus)
    }

    /// The temperature of the last conversion \[degC\], in steps of 0.0078125.
    ///
    /// # Errors
    /// [`SensorFault::NotReady`] where none has ended since the last reading;
    /// [`SensorFault::Bus`].
    pub fn read(&mut self) -> Result<f32, SensorFault> {
        let configuration: Configuration = self.registers.read().map_err(|_| SensorFault::Bus)?;
        if !configuration.data_ready() {
            return Err(SensorFault::NotReady);
        }
        let code: Temperature = self.registers.read().map_err(|_| SensorFault::Bus)?;
        match u16::from(code) {
            NONE_YET => Err(SensorFault::NotReady),
            code => Ok(f32::from(code as i16) * CELCIUS_CONVERSION),
        }
    }
}
