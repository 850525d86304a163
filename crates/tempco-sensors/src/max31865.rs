//! MAX31865: platinum resistor to digital, with detection of wiring faults.

use embedded_hal::spi::{Operation, SpiDevice};

use crate::{Platinum, SensorFault};

const CONFIGURATION: u8 = 0x00;
const RESISTANCE: u8 = 0x01;
const THRESHOLDS: u8 = 0x03;
const FAULTS: u8 = 0x07;
const WRITE: u8 = 0x80;

/// Bias voltage on, automatic conversion.
const RUN: u8 = 0xc0;
const THREE_WIRES: u8 = 0x10;
const CLEAR_FAULTS: u8 = 0x02;
const FILTER_50_HZ: u8 = 0x01;

/// Faults that mean an open circuit: resistance above the upper threshold, and the three of the
/// inputs with respect to the bias voltage.
const OPEN: u8 = 0xb8;
/// Resistance below the lower threshold.
const SHORT: u8 = 0x40;

/// Wires to the resistor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Wires {
    /// Two or four.
    TwoOrFour,
    /// Three.
    Three,
}

/// Mains frequency that is filtered out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Filter {
    /// 50 Hz; a conversion takes 21 ms.
    Hz50,
    /// 60 Hz; a conversion takes 17.6 ms.
    Hz60,
}

/// The chip, on an SPI bus in mode 1 or 3 of up to 5 MHz.
pub struct Max31865<SPI> {
    spi: SPI,
    platinum: Platinum,
    reference_ohm: f64,
    configuration: u8,
}

impl<SPI: SpiDevice> Max31865<SPI> {
    /// The chip with a resistor and the reference resistor beside it (four times the resistance at
    /// 0 degC, usually) \[ohm\]. [`start`](Self::start) comes next.
    pub fn new(
        spi: SPI,
        platinum: Platinum,
        reference_ohm: f64,
        wires: Wires,
        filter: Filter,
    ) -> Self {
        let wires = match wires {
            Wires::TwoOrFour => 0,
            Wires::Three => THREE_WIRES,
        };
        let filter = match filter {
            Filter::Hz50 => FILTER_50_HZ,
            Filter::Hz60 => 0,
        };
        Self {
            spi,
            platinum,
            reference_ohm,
            configuration: RUN | wires | filter,
        }
    }

    /// Sets the thresholds of the fault detection to a range of temperatures \[degC\] and starts
    /// continuous conversion.
    ///
    /// # Errors
    /// [`SensorFault::Bus`], also where the chip does not keep what is written.
    pub fn start(&mut self, min_c: f64, max_c: f64) -> Result<(), SensorFault> {
        let [h1, h0] = self.threshold(max_c);
        let [l1, l0] = self.threshold(min_c);
        self.write(&[THRESHOLDS | WRITE, h1, h0, l1, l0])?;
        self.write(&[CONFIGURATION | WRITE, self.configuration | CLEAR_FAULTS])?;
        let [found] = self.read_registers(CONFIGURATION)?;
        // The chip has taken back the bit that clears faults.
        if found == self.configuration {
            Ok(())
        } else {
            Err(SensorFault::Bus)
        }
    }

    /// The code of a temperature's resistance, in the upper 15 bits.
    fn threshold(&self, temp_c: f64) -> [u8; 2] {
        let code = self.platinum.resistance_ohm(temp_c) / self.reference_ohm * 32_768.0;
        ((code as u16).min(0x7fff) << 1).to_be_bytes()
    }

    /// The temperature of the last conversion \[degC\]. After a fault the chip is told to look
    /// again.
    ///
    /// # Errors
    /// What the chip or the resistance says is wrong.
    pub fn read(&mut self) -> Result<f32, SensorFault> {
        let code = u16::from_be_bytes(self.read_registers(RESISTANCE)?);
        if code & 1 == 0 {
            let share = f64::from(code >> 1) / 32_768.0;
            return self.platinum.temp_c(share * self.reference_ohm);
        }
        let [faults] = self.read_registers(FAULTS)?;
        self.write(&[CONFIGURATION | WRITE, self.configuration | CLEAR_FAULTS])?;
        Err(match faults {
            // No chip reports everything, or nothing, at once.
            0xff | 0 => SensorFault::Bus,
            faults if faults & OPEN != 0 => SensorFault::Open,
            faults if faults & SHORT != 0 => SensorFault::Short,
            _ => SensorFault::Rail,
        })
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), SensorFault> {
        self.spi.write(bytes).map_err(|_| SensorFault::Bus)
    }

    fn read_registers<const N: usize>(&mut self, address: u8) -> Result<[u8; N], SensorFault> {
        let mut bytes = [0; N];
        self.spi
            .transaction(&mut [Operation::Write(&[address]), Operation::Read(&mut bytes)])
            .map_err(|_| SensorFault::Bus)?;
        Ok(bytes)
    }
}
