//! The update: chunks into a slot.

use embedded_storage::nor_flash::NorFlash;

use crate::StoreError;
use crate::entry::MAX_WRITE_SIZE;
use crate::slot::{Slot, Slots};

/// An update under way; all offsets from the start of the slot \[bytes\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Update {
    slot: Slot,
    len: u32,
    written: u32,
    /// How far the sectors were erased, apart from the last one, which was erased first.
    erased: u32,
}

impl Update {
    /// Begins with an image of `len` bytes.
    pub(crate) fn begin<F: NorFlash>(
        slots: &Slots,
        flash: &mut F,
        slot: Slot,
        len: u32,
    ) -> Result<Self, StoreError> {
        if len == 0 || !len.is_multiple_of(4) || len > slots.room::<F>(slot) {
            return Err(StoreError::Length);
        }
        // The entries go first, so that the slot is never taken for whole with another image.
        let end = slots.region(slot).end();
        flash
            .erase(end.saturating_sub(F::ERASE_SIZE as u32), end)
            .map_err(StoreError::flash)?;
        Ok(Self {
            slot,
            len,
            written: 0,
            erased: 0,
        })
    }

    /// The slot that it changes.
    pub(crate) const fn slot(&self) -> Slot {
        self.slot
    }

    /// Where the next chunk begins.
    pub(crate) const fn written(&self) -> u32 {
        self.written
    }

    /// Whether the whole image was written, and is as long as the sender says.
    pub(crate) const fn is_complete(&self, len: u32) -> bool {
        self.written == self.len && len == self.len
    }

    /// Checks a chunk; where it ends if it is new, and nothing if it was taken before.
    pub(crate) fn new_end<F: NorFlash>(
        &self,
        slots: &Slots,
        flash: &mut F,
        offset: u32,
        chunk: &[u8],
    ) -> Result<Option<u32>, StoreError> {
        let end = u32::try_from(chunk.len())
            .ok()
            .and_then(|len| offset.checked_add(len))
            .filter(|&end| end <= self.len)
            .ok_or(StoreError::Length)?;
        if end <= self.written {
            return self.compare(slots, flash, offset, chunk).map(|()| None);
        }
        if offset != self.written {
            return Err(StoreError::Offset {
                expected: self.written,
            });
        }
        if end != self.len && !chunk.len().is_multiple_of(F::WRITE_SIZE.max(4)) {
            return Err(StoreError::Unaligned);
        }
        Ok(Some(end))
    }

    /// Programs a new chunk, up to `end`.
    pub(crate) fn program<F: NorFlash>(
        mut self,
        slots: &Slots,
        flash: &mut F,
        chunk: &[u8],
        end: u32,
    ) -> Result<Self, StoreError> {
        let region = slots.region(self.slot);
        let sector = F::ERASE_SIZE as u32;
        while self.erased < end {
            let next = self.erased.saturating_add(sector);
            if next < region.len {
                flash
                    .erase(region.at(self.erased), region.at(next))
                    .map_err(StoreError::flash)?;
            }
            self.erased = next;
        }
        let whole = chunk.len() - chunk.len() % F::WRITE_SIZE;
        let (words, rest) = chunk.split_at_checked(whole).ok_or(StoreError::Length)?;
        flash
            .write(region.at(self.written), words)
            .map_err(StoreError::flash)?;
        if !rest.is_empty() {
            let mut last = [0xff; MAX_WRITE_SIZE];
            for (place, byte) in last.iter_mut().zip(rest) {
                *place = *byte;
            }
            let last = last.get(..F::WRITE_SIZE).ok_or(StoreError::Length)?;
            let at = self.written.saturating_add(whole as u32);
            flash
                .write(region.at(at), last)
                .map_err(StoreError::flash)?;
        }
        self.written = end;
        Ok(self)
    }

    /// Compares a stretch of the slot with what it should hold.
    fn compare<F: NorFlash>(
        &self,
        slots: &Slots,
        flash: &mut F,
        offset: u32,
        chunk: &[u8],
    ) -> Result<(), StoreError> {
        let mut at = slots.region(self.slot).at(offset);
        for expected in chunk.chunks(MAX_WRITE_SIZE) {
            let mut found = [0; MAX_WRITE_SIZE];
            let found = found.get_mut(..expected.len()).ok_or(StoreError::Length)?;
            flash.read(at, found).map_err(StoreError::flash)?;
            if found != expected {
                return Err(StoreError::Different);
            }
            at = at.saturating_add(expected.len() as u32);
        }
        Ok(())
    }
}
