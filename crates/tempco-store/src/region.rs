//! A stretch of flash.

use embedded_storage::nor_flash::NorFlash;

use crate::StoreError;
use crate::entry::MAX_WRITE_SIZE;

/// A stretch of whole sectors \[bytes from the start of the flash\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Region {
    /// Where it begins.
    pub start: u32,
    /// How long it is.
    pub len: u32,
}

impl Region {
    /// Checks that the region consists of whole sectors of a flash that this crate can use.
    pub(crate) fn check<F: NorFlash>(self, flash: &F) -> Result<(), StoreError> {
        const {
            assert!(F::WRITE_SIZE <= MAX_WRITE_SIZE, "words of up to 64 bytes");
            assert!(
                F::WRITE_SIZE.is_power_of_two(),
                "words of 1, 2, 4, ... bytes"
            );
            assert!(F::READ_SIZE == 1 || F::READ_SIZE == 2 || F::READ_SIZE == 4);
            assert!(F::ERASE_SIZE.is_multiple_of(MAX_WRITE_SIZE));
        }
        let sector = F::ERASE_SIZE as u32;
        let end = self.start.checked_add(self.len);
        let fits = end.is_some_and(|end| end as usize <= flash.capacity());
        if fits
            && self.len > 0
            && [self.start, self.len]
                .iter()
                .all(|n| n.is_multiple_of(sector))
        {
            Ok(())
        } else {
            Err(StoreError::Region)
        }
    }

    /// The address of an offset. Saturating, here and wherever addresses are reckoned: what lies
    /// beyond every flash is refused by this one.
    pub(crate) const fn at(self, offset: u32) -> u32 {
        self.start.saturating_add(offset)
    }

    pub(crate) const fn end(self) -> u32 {
        self.at(self.len)
    }

    pub(crate) const fn overlaps(self, other: Self) -> bool {
        self.start < other.end() && other.start < self.end()
    }
}
