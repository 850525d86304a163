//! MAX31865: platinum resistor to digital, with detection of wiring faults.

use embedded_hal::spi::{Operation, SpiDevice};

use crate::{Platinum, SensorFault};

/// The resistance follows it.
const CONFIGURATION: u8 = 0x00;
const THRESHOLDS: u8 = 0x03;
const FAULTS: u8 = 0x07;
const WRITE: u8 = 0x80;

/// Bias voltage on.
const BIAS: u8 = 0x80;
/// Automatic conversion.
const CONVERT: u8 = 0x40;
const THREE_WIRES: u8 = 0x10;
/// A fault-detection cycle with the chip's own waits; the chip takes the bit back at its end.
const DETECT_FAULTS: u8 = 0x04;
const CLEAR_FAULTS: u8 = 0x02;
const FILTER_50_HZ: u8 = 0x01;

/// Faults that mean an open circuit: resistance above the upper threshold; REFIN- near the bias
/// voltage, so no current flows.
const OPEN: u8 = 0xa0;
/// Faults that mean a short circuit: resistance below the lower threshold; REFIN- or RTDIN- away
/// from the bias voltage although FORCE- is off, so current flows elsewhere.
const SHORT: u8 = 0x58;

/// Readings from one fault-detection cycle to the next: 3 s at ten a second.
const READINGS_PER_CHECK: u8 = 30;

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

/// The chip, on an SPI bus in mode 1 or 3 of up to 5 MHz, with a chip select that keeps
/// [`SELECT_NS`](Self::SELECT_NS): a [`ChipSelect`](crate::ChipSelect), for instance.
///
/// # Wiring faults
/// The chip compares every conversion with the thresholds, which finds an open or a short-circuited
/// resistor. A single wire that is open or touches ground may leave a resistance that looks good;
/// it is found by a fault-detection cycle, which runs before the first reading and in place of a
/// conversion at every 30th. The cycle waits 100 us for the inputs, so the time constant of a
/// filter at them must be shorter. An open wire to RTDIN+ alone is not found with three or four
/// wires: 10 Mohm from RTDIN+ to BIAS turn it into a resistance above the upper threshold.
pub struct Max31865<SPI> {
    spi: SPI,
    platinum: Platinum,
    reference_ohm: f64,
    /// Bias, wires and filter.
    idle: u8,
    /// What the last fault-detection cycle found; not ready before the first has ended.
    wires: Result<(), SensorFault>,
    /// A fault-detection cycle was begun.
    is_checking: bool,
    /// Readings until the next fault-detection cycle.
    until_check: u8,
}

impl<SPI: SpiDevice> Max31865<SPI> {
    /// The least time from an edge of chip select to the next edge, of chip select or clock \[ns\].
    pub const SELECT_NS: u32 = 400;

    /// The chip with a resistor and the reference resistor next to it (four times the resistance at
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
            idle: BIAS | wires | filter,
            wires: Err(SensorFault::NotReady),
            is_checking: false,
            until_check: 0,
        }
    }

    /// Sets the thresholds of the fault detection to a range of temperatures \[degC\] and starts
    /// continuous conversion. The first reading is due 70 ms later.
    ///
    /// # Errors
    /// [`SensorFault::Bus`], also where the chip does not keep what is written.
    pub fn start(&mut self, min_c: f64, max_c: f64) -> Result<(), SensorFault> {
        let [h1, h0] = self.threshold(max_c);
        let [l1, l0] = self.threshold(min_c);
        self.write(&[THRESHOLDS | WRITE, h1, h0, l1, l0])?;
        self.configure(CONVERT | CLEAR_FAULTS)?;
        self.wires = Err(SensorFault::NotReady);
        self.is_checking = false;
        self.until_check = 0;
        let [found] = self.read_registers(CONFIGURATION)?;
        // The chip has taken back the bit that clears faults.
        if found == self.idle | CONVERT {
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

    /// The temperature of the last conversion \[degC\]. After a fault the chip is made to look
    /// again.
    ///
    /// # Errors
    /// What the chip or the resistance says is wrong; [`SensorFault::NotReady`] while the first
    /// fault-detection cycle runs; [`SensorFault::Bus`] also where the chip has lost its
    /// configuration, which [`start`](Self::start) restores.
    pub fn read(&mut self) -> Result<f32, SensorFault> {
        if self.is_checking {
            return self.end_check();
        }
        let reading = self.conversion();
        if reading == Err(SensorFault::Bus) {
            return reading;
        }
        self.until_check = self.until_check.saturating_sub(1);
        if self.until_check == 0 {
            self.configure(DETECT_FAULTS)?;
            self.is_checking = true;
        }
        self.wires.and(reading)
    }

    fn conversion(&mut self) -> Result<f32, SensorFault> {
        let [found, high, low] = self.read_registers(CONFIGURATION)?;
        if found != self.idle | CONVERT {
            return Err(SensorFault::Bus);
        }
        if low & 1 == 0 {
            return self.temp_c([high, low]);
        }
        let [faults] = self.read_registers(FAULTS)?;
        self.configure(CONVERT | CLEAR_FAULTS)?;
        // The chip has said that there is one.
        named(faults).and(Err(SensorFault::Bus))
    }

    /// Takes what a fault-detection cycle found, and the conversion before it.
    fn end_check(&mut self) -> Result<f32, SensorFault> {
        let [found, high, low, .., faults] = self.read_registers::<8>(CONFIGURATION)?;
        if found == self.idle | DETECT_FAULTS {
            return Err(SensorFault::NotReady);
        }
        self.configure(CONVERT | CLEAR_FAULTS)?;
        self.is_checking = false;
        self.wires = if found == self.idle {
            named(faults)
        } else {
            Err(SensorFault::Bus)
        };
        self.wires?;
        self.until_check = READINGS_PER_CHECK;
        self.temp_c([high, low])
    }

    fn temp_c(&self, code: [u8; 2]) -> Result<f32, SensorFault> {
        let share = f64::from(u16::from_be_bytes(code) >> 1) / 32_768.0;
        self.platinum.temp_c(share * self.reference_ohm)
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }

    /// Writes the configuration with some bits more.
    fn configure(&mut self, bits: u8) -> Result<(), SensorFault> {
        self.write(&[CONFIGURATION | WRITE, self.idle | bits])
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

/// What the fault register says.
fn named(faults: u8) -> Result<(), SensorFault> {
    match faults {
        0 => Ok(()),
        // No chip reports everything at once.
        0xff => Err(SensorFault::Bus),
        faults if faults & OPEN != 0 => Err(SensorFault::Open),
        faults if faults & SHORT != 0 => Err(SensorFault::Short),
        _ => Err(SensorFault::Rail),
    }
}
