//! How an ICM-42688-P is to measure.

use core::num::NonZeroU32;

use super::registers::{
    ACCEL_CONFIG0, ALL_ON, FIFO_CONFIG, FIFO_CONFIG1, FIFO_CONFIG2, FIFO_CONFIG3,
    GYRO_ACCEL_CONFIG0, GYRO_CONFIG0, INT_CONFIG, INT_CONFIG1, INT_SOURCE0, INTF_CONFIG0,
    INTF_CONFIG1, PACKET, PWR_MGMT0, STOP_ON_FULL, TMST_CONFIG,
};

/// Registers of bank 0 that are set.
pub(super) const REGISTERS: usize = 14;

/// Largest rate of rotation that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Range {
    /// 2000 deg/s
    Dps2000 = 0,
    /// 1000 deg/s
    Dps1000 = 1,
    /// 500 deg/s
    Dps500 = 2,
    /// 250 deg/s
    Dps250 = 3,
    /// 125 deg/s
    Dps125 = 4,
    /// 62.5 deg/s
    Dps62 = 5,
    /// 31.25 deg/s
    Dps31 = 6,
    /// 15.625 deg/s
    Dps15 = 7,
}

impl Range {
    /// What a count is \[deg/s\].
    pub const fn deg_per_s(self) -> f32 {
        let ranges = 1_u32 << self as u8;
        2000.0 / ranges as f32 / 32_768.0
    }
}

/// Samples per second, by the clock of the chip: within 1 % of this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum OutputRate {
    /// 8000 Hz
    Hz8000 = 3,
    /// 4000 Hz
    Hz4000 = 4,
    /// 2000 Hz
    Hz2000 = 5,
    /// 1000 Hz
    Hz1000 = 6,
}

impl OutputRate {
    /// Samples per second \[Hz\].
    pub const fn hz(self) -> u16 {
        match self {
            Self::Hz8000 => 8000,
            Self::Hz4000 => 4000,
            Self::Hz2000 => 2000,
            Self::Hz1000 => 1000,
        }
    }

    /// From one sample to the next in sixteenths of a count of the time stamps. A count is 32/30 us.
    pub(super) const fn step_16ths(self) -> NonZeroU32 {
        match NonZeroU32::new(15_000_000 / self.hz() as u32) {
            Some(step) => step,
            None => NonZeroU32::MIN,
        }
    }
}

/// Anti-alias filter of the gyro, of second order, before it is sampled at the output rate. Half the
/// rate of the samples is the most that makes sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AntiAlias {
    /// 258 Hz
    Hz258,
    /// 536 Hz
    Hz536,
    /// 997 Hz
    Hz997,
    /// 1962 Hz
    Hz1962,
}

impl AntiAlias {
    /// The three registers, by the table of the data sheet: `DELT`, `DELTSQR` and `BITSHIFT`.
    pub(super) const fn registers(self) -> [u8; 3] {
        let (delta, squared, shift): (u8, u16, u8) = match self {
            Self::Hz258 => (6, 36, 10),
            Self::Hz536 => (12, 144, 8),
            Self::Hz997 => (21, 440, 6),
            Self::Hz1962 => (37, 1376, 4),
        };
        let [high, low] = squared.to_be_bytes();
        [delta, low, shift << 4 | high]
    }
}

/// How the chip is to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Largest rate of rotation.
    pub range: Range,
    /// Samples per second.
    pub rate: OutputRate,
    /// Anti-alias filter.
    pub filter: AntiAlias,
    /// Samples in the FIFO from which on INT1 says that data are ready, 1 to 100.
    pub block: u8,
}

impl Settings {
    /// Registers of bank 0 in the order in which they are written, with what they must hold. The
    /// sensors are switched on last: nothing may be written for 200 us from then on.
    pub(super) const fn registers(&self) -> [(u8, u8); REGISTERS] {
        let rate = self.rate as u8;
        let [high, low] = (self.block as u16 * PACKET as u16).to_be_bytes();
        [
            // INT1: a pulse, push-pull, active high.
            (INT_CONFIG, 0x03),
            // Big-endian; an invalid sample is -32768; no I2C.
            (INTF_CONFIG0, 0x33),
            // The PLL's clock where there is one. The upper bits keep the gyro at one range: as
            // delivered it changes over at 100 deg/s, and then repeats samples for 1 to 2 ms.
            (INTF_CONFIG1, 0x51),
            (GYRO_CONFIG0, (self.range as u8) << 5 | rate),
            // 16 g. Packets with a time stamp have both sensors.
            (ACCEL_CONFIG0, rate),
            // The filters behind the anti-alias filter as wide as they go: half the output rate.
            (GYRO_ACCEL_CONFIG0, 0x00),
            // Time stamps of each sample, in counts of 32/30 us.
            (TMST_CONFIG, 0x21),
            // INT1 with every packet from the block on; time, temperature, gyro, accelerometer.
            (FIFO_CONFIG1, 0x2f),
            (FIFO_CONFIG2, low),
            (FIFO_CONFIG3, high),
            // Pulses of 8 us without a dead time, as rates from 4 kHz on need; and bit 4 at 0,
            // without which the pin does not work as it should.
            (INT_CONFIG1, 0x60),
            // Only the FIFO's block is said on INT1.
            (INT_SOURCE0, 0x04),
            (FIFO_CONFIG, STOP_ON_FULL),
            (PWR_MGMT0, ALL_ON),
        ]
    }
}
