//! ICM-42688-P: three gyros and three accelerometers with a clock and a FIFO of their own.
//!
//! The gyros' samples are read in blocks from the FIFO, each with a time stamp. The stamps show how
//! many samples are missing between two that were read, whatever the reason: a full FIFO, or a
//! torn read after which the FIFO was emptied.
//!
//! ```text
//! reset -- 1 ms -> configure -- 50 ms of samples that are left out -> read, read, ...
//!   ^                                                                  |
//!   +------------- bus, identity, settings, restart -------------------+
//! ```
//!
//! Nothing waits for the chip: who calls keeps the time between [`Icm42688::reset`] and
//! [`Icm42688::configure`]. Source: data sheet DS-000347.

mod registers;
mod settings;
#[cfg(feature = "simulated")]
pub mod simulated;

pub use settings::{AntiAlias, OutputRate, Range, Settings};

use core::fmt;

use embedded_hal::spi::{Operation, SpiDevice};

use settings::REGISTERS;

use registers::{
    DEVICE_CONFIG, FIFO_BYTES, FIFO_DATA, FIFO_FLUSH, FIFO_FULL, GYRO_CONFIG_STATIC3, HEADER,
    IDENTITY, INT_STATUS, PACKET, RATE_CHANGED, READ, REG_BANK_SEL, RESET_DONE, SIGNAL_PATH_RESET,
    SOFT_RESET, WHO_AM_I,
};

/// The count that marks an axis of a sample as not valid.
pub const INVALID: i16 = i16::MIN;

/// Samples that one call of [`Icm42688::read`] takes at most.
pub const BURST: usize = 8;

/// Part of a second for which samples are left out after a start: the gyros need 30 ms, and the
/// filters some more.
const SETTLING: u16 = 20;

/// Why the chip gives no samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ChipFault {
    /// The bus failed, or says what cannot be.
    Bus,
    /// There is another chip, or none.
    Identity,
    /// The chip does not hold the settings that were written.
    Settings,
    /// The chip was reset since it was configured.
    Restarted,
    /// A packet was not what it should be. The FIFO has been emptied.
    Torn,
}

impl fmt::Display for ChipFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bus => "the bus failed",
            Self::Identity => "there is no ICM-42688-P",
            Self::Settings => "the chip does not hold its settings",
            Self::Restarted => "the chip was reset",
            Self::Torn => "a packet was torn",
        })
    }
}

impl core::error::Error for ChipFault {}

/// What a read has found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Burst {
    /// Samples that were in the FIFO.
    pub waiting: u16,
    /// Samples that were found missing since the last burst. It is exact up to some 40 in a row, and
    /// to 2 % beyond. Where the FIFO was full it is at least 1.
    pub lost: u16,
}

/// The chip, on an SPI bus in mode 0 or 3 of up to 24 MHz, with a chip select that keeps
/// [`SELECT_NS`](Self::SELECT_NS): a [`ChipSelect`](crate::ChipSelect), for instance.
pub struct Icm42688<SPI> {
    spi: SPI,
    settings: Settings,
    /// Samples that are still to be left out after a start.
    settling: u16,
    /// Time stamp of the last sample.
    stamp: Option<u16>,
    /// Lost samples that were not yet handed out in a burst, and those among all of them that a full
    /// FIFO has shown before the time stamps do.
    lost: u16,
    foreseen: u16,
    /// Place of the register that is checked next.
    checked: usize,
}

impl<SPI: SpiDevice> Icm42688<SPI> {
    /// The least time from an edge of chip select to the next edge, of chip select or clock \[ns\].
    pub const SELECT_NS: u32 = 40;

    /// Registers that [`check`](Self::check) looks at.
    pub const REGISTERS: usize = REGISTERS;

    /// The chip. [`reset`](Self::reset) comes next.
    pub const fn new(spi: SPI, settings: Settings) -> Self {
        Self {
            spi,
            settings,
            settling: 0,
            stamp: None,
            lost: 0,
            foreseen: 0,
            checked: 0,
        }
    }

    /// Resets the chip, which takes no command for 1 ms.
    ///
    /// # Errors
    /// [`ChipFault::Bus`].
    pub fn reset(&mut self) -> Result<(), ChipFault> {
        // Whatever bank was selected before.
        self.write(&[REG_BANK_SEL, 0])?;
        self.write(&[DEVICE_CONFIG, SOFT_RESET])
    }

    /// Writes all settings, reads them back and lets the chip measure.
    ///
    /// # Errors
    /// [`ChipFault::Bus`], [`ChipFault::Identity`], [`ChipFault::Settings`].
    pub fn configure(&mut self) -> Result<(), ChipFault> {
        self.identify()?;
        let filter = self.settings.filter.registers();
        let [delta, squared, shift] = filter;
        self.write(&[REG_BANK_SEL, 1])?;
        self.write(&[GYRO_CONFIG_STATIC3, delta, squared, shift])?;
        let kept: [u8; 3] = self.registers(GYRO_CONFIG_STATIC3)?;
        self.write(&[REG_BANK_SEL, 0])?;
        if kept != filter {
            return Err(ChipFault::Settings);
        }
        for (register, value) in self.settings.registers() {
            self.write(&[register, value])?;
        }
        self.checked = 0;
        for _ in 0..Self::REGISTERS {
            self.check()?;
        }
        // Reading takes back that the chip was reset.
        let [_] = self.registers(INT_STATUS)?;
        self.settling = self.settings.rate.hz() / SETTLING;
        self.stamp = None;
        self.foreseen = 0;
        Ok(())
    }

    /// Whether the next of the chip's registers holds its setting. So many calls in a row as
    /// [`REGISTERS`](Self::REGISTERS) look at all of bank 0.
    ///
    /// # Errors
    /// [`ChipFault::Bus`], [`ChipFault::Settings`].
    pub fn check(&mut self) -> Result<(), ChipFault> {
        let place = self.checked % Self::REGISTERS;
        self.checked = place + 1;
        let (register, value) = self.settings.registers()[place];
        match self.registers(register)? {
            [kept] if kept == value => Ok(()),
            _ => Err(ChipFault::Settings),
        }
    }

    /// Takes up to [`BURST`] samples from the FIFO, x, y and z of the gyros: the oldest first. An axis
    /// that is [`INVALID`] has no value.
    ///
    /// # Errors
    /// [`ChipFault::Restarted`], [`ChipFault::Bus`]: the chip must be started again.
    /// [`ChipFault::Torn`]: what was taken before is good, and a later burst says what was lost.
    pub fn read(&mut self, mut each: impl FnMut([i16; 3])) -> Result<Burst, ChipFault> {
        let [status, high, low] = self.registers(INT_STATUS)?;
        let count = u16::from_be_bytes([high, low]);
        if count > FIFO_BYTES {
            return Err(ChipFault::Bus);
        }
        if status & RESET_DONE != 0 {
            return Err(ChipFault::Restarted);
        }
        if status & FIFO_FULL != 0 && self.foreseen == 0 {
            self.foreseen = 1;
            self.lost = self.lost.saturating_add(1);
        }
        if !usize::from(count).is_multiple_of(PACKET) {
            return self.torn();
        }
        let mut bytes = [0; BURST * PACKET];
        let length = usize::from(count).min(bytes.len());
        let bytes = bytes.get_mut(..length).unwrap_or_default();
        if !bytes.is_empty() {
            self.read_into(FIFO_DATA, bytes)?;
        }
        for packet in bytes.as_chunks().0 {
            let Some((counts, stamp)) = unpack(packet) else {
                return self.torn();
            };
            let lost = self.missing_before(stamp);
            if self.settling > 0 {
                self.settling -= 1;
            } else {
                self.lost = self.lost.saturating_add(lost);
                each(counts);
            }
        }
        Ok(Burst {
            waiting: count / PACKET as u16,
            lost: core::mem::take(&mut self.lost),
        })
    }

    /// Whether the samples that are left out after a start have passed.
    pub const fn is_settled(&self) -> bool {
        self.settling == 0
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }

    /// Samples that are missing before one, beyond those that were foreseen.
    fn missing_before(&mut self, stamp: u16) -> u16 {
        let Some(before) = self.stamp.replace(stamp) else {
            return 0;
        };
        let step = self.settings.rate.step_16ths();
        let since = 16 * u32::from(stamp.wrapping_sub(before));
        let steps = (since + step.get() / 2) / step;
        // Fewer than 65536 counts at one sample in 117 of them or more.
        match (steps as u16).saturating_sub(1) {
            0 => 0,
            missing => missing.saturating_sub(core::mem::take(&mut self.foreseen)),
        }
    }

    /// Empties the FIFO, so that the next read begins with a whole packet.
    fn torn<T>(&mut self) -> Result<T, ChipFault> {
        self.write(&[SIGNAL_PATH_RESET, FIFO_FLUSH])?;
        Err(ChipFault::Torn)
    }

    fn identify(&mut self) -> Result<(), ChipFault> {
        match self.registers(WHO_AM_I)? {
            [IDENTITY] => Ok(()),
            _ => Err(ChipFault::Identity),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), ChipFault> {
        self.spi.write(bytes).map_err(|_| ChipFault::Bus)
    }

    fn registers<const N: usize>(&mut self, address: u8) -> Result<[u8; N], ChipFault> {
        let mut bytes = [0; N];
        self.read_into(address, &mut bytes)?;
        Ok(bytes)
    }

    fn read_into(&mut self, address: u8, bytes: &mut [u8]) -> Result<(), ChipFault> {
        self.spi
            .transaction(&mut [Operation::Write(&[address | READ]), Operation::Read(bytes)])
            .map_err(|_| ChipFault::Bus)
    }
}

/// The gyros' counts and the time stamp of a packet, if it is one.
fn unpack(packet: &[u8; PACKET]) -> Option<([i16; 3], u16)> {
    let [header, _, _, _, _, _, _, x1, x0, y1, y0, z1, z0, _, t1, t0] = *packet;
    let counts = [[x1, x0], [y1, y0], [z1, z0]].map(i16::from_be_bytes);
    let stamp = u16::from_be_bytes([t1, t0]);
    (header & !RATE_CHANGED == HEADER).then_some((counts, stamp))
}
