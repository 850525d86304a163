//! NOR flash in RAM, so that the store has something to work on.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// Bytes of a sector.
pub(super) const SECTOR: u32 = 512;

const SECTORS: u32 = 8;
const LEN: usize = (SECTORS * SECTOR) as usize;

pub(super) struct RamFlash([u8; LEN]);

impl RamFlash {
    pub(super) const fn new() -> Self {
        Self([0xff; LEN])
    }

    fn stretch(&mut self, from: u32, len: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let rest = self.0.get_mut(from as usize..);
        let stretch = rest.and_then(|rest| rest.get_mut(..len));
        stretch.ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl ErrorType for RamFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let stretch = self.stretch(offset, bytes.len())?;
        for (byte, stored) in bytes.iter_mut().zip(stretch) {
            *byte = *stored;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        LEN
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        let len = to.checked_sub(from).ok_or(NorFlashErrorKind::OutOfBounds)?;
        self.stretch(from, len as usize)?.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let stretch = self.stretch(offset, bytes.len())?;
        for (stored, byte) in stretch.iter_mut().zip(bytes) {
            *stored &= byte;
        }
        Ok(())
    }
}
