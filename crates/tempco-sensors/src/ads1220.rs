//! ADS1220: a 24-bit converter with four inputs.

use embedded_hal::spi::{Operation, SpiDevice};

use crate::{Divider, SensorFault, Thermistor};

const RESET: u8 = 0x06;
const START: u8 = 0x08;
const READ_DATA: u8 = 0x10;
const READ_ALL_REGISTERS: u8 = 0x23;
const WRITE_ALL_REGISTERS: u8 = 0x43;

/// Time for which the chip takes no command after a reset \[ns\]: 50 us and 32 of its clocks, of
/// 4.096 MHz.
const AFTER_RESET_NS: u32 = 60_000;

/// One conversion per start.
const SINGLE_SHOT: u8 = 0;
/// Reference from the pins REFP0 and REFN0; rejection of 50 and 60 Hz at 20 samples per second.
const EXTERNAL_REFERENCE: u8 = 0x50;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Input {
    /// AIN0 against AIN1.
    Ain0Ain1 = 0x0,
    /// AIN2 against AIN3.
    Ain2Ain3 = 0x5,
    /// AIN0 against ground.
    Ain0 = 0x8,
    /// AIN1 against ground.
    Ain1 = 0x9,
    /// AIN2 against ground.
    Ain2 = 0xa,
    /// AIN3 against ground.
    Ain3 = 0xb,
}

/// Gain before the converter. Up to 4 the amplifier is by-passed, as inputs against ground need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Gain {
    /// 1
    X1 = 0,
    /// 2
    X2 = 1,
    /// 4
    X4 = 2,
}

/// Conversions per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Rate {
    /// 20, with rejection of mains hum.
    Sps20 = 0,
    /// 90
    Sps90 = 2,
    /// 330
    Sps330 = 4,
}

/// The chip, on an SPI bus in mode 1, with a chip select that keeps
/// [`SELECT_NS`](Self::SELECT_NS): a [`ChipSelect`](crate::ChipSelect), for instance.
pub struct Ads1220<SPI> {
    spi: SPI,
    gain: Gain,
}

impl<SPI: SpiDevice> Ads1220<SPI> {
    /// The least time from an edge of chip select to the next edge, of chip select or clock \[ns\].
    pub const SELECT_NS: u32 = 50;

    /// The chip. [`configure`](Self::configure) comes next.
    pub const fn new(spi: SPI) -> Self {
        Self {
            spi,
            gain: Gain::X1,
        }
    }

    /// Resets the chip, and waits until it takes commands again: 60 us, within the selection, so the
    /// SPI device needs a delay.
    ///
    /// # Errors
    /// [`SensorFault::Bus`].
    pub fn reset(&mut self) -> Result<(), SensorFault> {
        self.spi
            .transaction(&mut [
                Operation::Write(&[RESET]),
                Operation::DelayNs(AFTER_RESET_NS),
            ])
            .map_err(|_| SensorFault::Bus)
    }

    /// Chooses input, gain and rate, for single conversions against the external reference.
    ///
    /// # Errors
    /// [`SensorFault::Bus`], also where the chip does not keep what is written.
    pub fn configure(&mut self, input: Input, gain: Gain, rate: Rate) -> Result<(), SensorFault> {
        self.gain = gain;
        let by_pass = 1;
        let registers = [
            (input as u8) << 4 | (gain as u8) << 1 | by_pass,
            (rate as u8) << 5 | SINGLE_SHOT,
            EXTERNAL_REFERENCE,
            0,
        ];
        let [r0, r1, r2, r3] = registers;
        self.write(&[WRITE_ALL_REGISTERS, r0, r1, r2, r3])?;
        if self.command_and_read(READ_ALL_REGISTERS)? == registers {
            Ok(())
        } else {
            Err(SensorFault::Bus)
        }
    }

    /// Starts a conversion, which is due after the period of the rate and a tenth more.
    ///
    /// # Errors
    /// [`SensorFault::Bus`].
    pub fn start(&mut self) -> Result<(), SensorFault> {
        self.write(&[START])
    }

    /// The last conversion, as a share of the reference voltage, -1 to below 1, before the gain.
    ///
    /// # Errors
    /// [`SensorFault::Bus`]; [`SensorFault::Rail`] for either end of the range, beyond which it was.
    pub fn read_share(&mut self) -> Result<f64, SensorFault> {
        let [b2, b1, b0] = self.command_and_read(READ_DATA)?;
        // The sign bit of the upper byte is the sign of the number.
        let code = i32::from_be_bytes([b2, b1, b0, 0]) >> 8;
        if matches!(code, 0x7f_ffff | -0x80_0000) {
            return Err(SensorFault::Rail);
        }
        let gain = f64::from(1_u8 << (self.gain as u8));
        Ok(f64::from(code) / 8_388_608.0 / gain)
    }

    /// The temperature of a thermistor below a fixed resistor, both fed by the reference
    /// \[degC\].
    ///
    /// # Errors
    /// [`SensorFault::Open`] and [`SensorFault::Short`], also for a reading at the rail;
    /// [`SensorFault::Bus`].
    pub fn read_thermistor(
        &mut self,
        divider: &Divider,
        thermistor: &Thermistor,
    ) -> Result<f32, SensorFault> {
        let share = match self.read_share() {
            // The reference itself: nothing pulls the input down.
            Err(SensorFault::Rail) => return Err(SensorFault::Open),
            other => other?,
        };
        thermistor.temp_c(divider.thermistor_ohm(share)?)
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), SensorFault> {
        self.spi.write(bytes).map_err(|_| SensorFault::Bus)
    }

    fn command_and_read<const N: usize>(&mut self, command: u8) -> Result<[u8; N], SensorFault> {
        let mut bytes = [0; N];
        self.spi
            .transaction(&mut [Operation::Write(&[command]), Operation::Read(&mut bytes)])
            .map_err(|_| SensorFault::Bus)?;
        Ok(bytes)
    }
}
