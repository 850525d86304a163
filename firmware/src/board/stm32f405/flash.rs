//! Sectors 6 to 11 of the program's flash, for tables and logs.
//!
//! Offsets count from the first of these sectors, so nothing here can touch the program. Sectors
//! are of 128 KiB, which is also what an erasure takes; the smaller ones of the chip are the
//! program's. What an erasure means for everything else is said at [`super`].
//!
//! The HAL programs and erases. It leaves two things undone, which are done here: error flags of an
//! operation stay set until they are cleared, and the data cache keeps what was erased.

use core::sync::atomic::{AtomicU8, Ordering};

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError as _, NorFlashErrorKind, ReadNorFlash, check_erase,
    check_read, check_write,
};
use stm32f4xx_hal::flash::{FlashExt as _, flash_sectors};
use stm32f4xx_hal::pac::FLASH;

use super::store::{SECTOR, SECTORS};
use super::watchdog::Feeder;

const LEN: usize = SECTORS * SECTOR as usize;

/// Where the flash begins, and its size, which the HAL would read from the chip.
const FLASH_START: usize = 0x0800_0000;
const FLASH_LEN: usize = 1024 * 1024;

// SAFETY: the memory file puts this symbol at the start of the store, which is of this length (it
// asserts both), and the linker puts nothing else there. Bytes in flash are always initialised;
// that they change when they are programmed is what atomics are for.
#[allow(unsafe_code)]
unsafe extern "C" {
    safe static tempco_store: [AtomicU8; LEN];
}

/// The sectors, with the right to program them.
pub struct Sectors {
    flash: FLASH,
    feeder: Feeder,
}

impl Sectors {
    pub(super) fn new(flash: FLASH, feeder: Feeder) -> Self {
        Self { flash, feeder }
    }

    /// Flags of the last operation; the debugger may have left some too.
    fn clear_errors(&self) {
        self.flash.sr().write(|w| {
            w.operr().clear().wrperr().clear();
            w.pgaerr().clear().pgperr().clear().pgserr().clear()
        });
    }

    /// The cache may be reset only while it is off.
    fn drop_cached(&self) {
        let acr = self.flash.acr();
        acr.modify(|_, w| w.dcen().disabled());
        acr.modify(|_, w| w.dcrst().reset());
        acr.modify(|_, w| w.dcrst().no_reset());
        acr.modify(|_, w| w.dcen().enabled());
    }

    fn erase_sector(&mut self, offset: u32) -> Result<(), NorFlashErrorKind> {
        let offset = in_flash(offset);
        let sector = flash_sectors(FLASH_LEN, false)
            .find(|sector| sector.offset == offset && sector.size == SECTOR as usize)
            .ok_or(NorFlashErrorKind::OutOfBounds)?;
        self.feeder.feed();
        self.clear_errors();
        let erased = self.flash.unlocked().erase(sector.number);
        self.drop_cached();
        erased.map_err(|error| error.kind())
    }
}

/// An offset in the chip's flash.
fn in_flash(offset: u32) -> usize {
    (&raw const tempco_store).addr() - FLASH_START + offset as usize
}

impl ErrorType for Sectors {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let stored = tempco_store.iter().skip(offset as usize);
        for (byte, stored) in bytes.iter_mut().zip(stored) {
            *byte = stored.load(Ordering::Relaxed);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        LEN
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    /// Stops the processor for up to 4 s per sector.
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        (from..to)
            .step_by(SECTOR as usize)
            .try_for_each(|offset| self.erase_sector(offset))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        self.clear_errors();
        self.flash
            .unlocked()
            .program(in_flash(offset), bytes.iter())
            .map_err(|error| error.kind())
    }
}
