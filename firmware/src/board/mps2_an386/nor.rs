//! A NOR flash made of RAM: words of 8 bytes that can be programmed once, and sectors of 4 KiB
//! that are erased as a whole. A reset in the middle leaves it as a real one would be.

use core::sync::atomic::{AtomicU32, Ordering};

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use tempco_store::Region;

use crate::unit::devices::Regions;

/// Words of 32 bits.
pub const WORDS: usize = 0x1_4000 / 4;

/// Where the store is in it.
pub const REGIONS: Regions = Regions {
    slots: [
        Region {
            start: 0,
            len: 0x8000,
        },
        Region {
            start: 0x8000,
            len: 0x8000,
        },
    ],
    faults: Region {
        start: 0x1_0000,
        len: 0x2000,
    },
    offsets: Region {
        start: 0x1_2000,
        len: 0x2000,
    },
};

const SECTOR: usize = 4096;
const WORD: usize = 8;
const ERASED: u32 = u32::MAX;

/// The flash. Its cells are atomic since others may reach them, such as the host of an emulator;
/// accesses are single loads and stores.
#[derive(Clone, Copy, Debug)]
pub struct Nor<'a>(pub &'a [AtomicU32]);

impl Nor<'_> {
    /// The cells of a stretch that begins and ends at words.
    fn cells(&self, offset: u32, len: usize) -> &[AtomicU32] {
        let start = offset as usize / 4;
        self.0.get(start..start + len / 4).unwrap_or_default()
    }
}

impl ErrorType for Nor<'_> {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Nor<'_> {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        let cells = self.cells(offset, bytes.len());
        for (bytes, cell) in bytes.chunks_exact_mut(4).zip(cells) {
            bytes.copy_from_slice(&cell.load(Ordering::Relaxed).to_le_bytes());
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        4 * self.0.len()
    }
}

impl NorFlash for Nor<'_> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        for cell in self.cells(from, (to - from) as usize) {
            cell.store(ERASED, Ordering::Relaxed);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let cells = self.cells(offset, bytes.len());
        if cells
            .iter()
            .any(|cell| cell.load(Ordering::Relaxed) != ERASED)
        {
            return Err(NorFlashErrorKind::Other);
        }
        for (cell, bytes) in cells.iter().zip(bytes.as_chunks().0) {
            cell.store(u32::from_le_bytes(*bytes), Ordering::Relaxed);
        }
        Ok(())
    }
}
