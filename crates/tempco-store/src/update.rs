//! The update: chunks into the slot that is not in use, then the commit.

use embedded_storage::nor_flash::NorFlash;
use tempco_image::{CRC, Image, ImageError};

use crate::entry::MAX_WRITE_SIZE;
use crate::store::Record;
use crate::{Slot, Store, StoreError};

/// An update under way; all offsets from the start of the slot \[bytes\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Update {
    slot: Slot,
    len: u32,
    written: u32,
    /// How far the sectors were erased, apart from the last one, which was erased first.
    erased: u32,
}

impl Store {
    /// Begins an update with an image of `len` bytes in the slot that is not in use, and returns
    /// the slot. What was there is lost. One that is under way is begun anew.
    ///
    /// # Errors
    /// A length that is no multiple of 4 or does not fit, a table chosen since the last boot, or a failing flash.
    ///
    /// # Timing
    /// Erases one sector.
    pub fn begin<F: NorFlash>(&mut self, flash: &mut F, len: u32) -> Result<Slot, StoreError> {
        self.expect_booted()?;
        self.end_update();
        let slot = match self.current {
            Some(current) => !current,
            None => self.least(flash),
        };
        if len == 0 || !len.is_multiple_of(4) || len > self.room::<F>(slot) {
            return Err(StoreError::Length);
        }
        // The entries go first, so that the slot is never taken for whole with another image.
        let end = self.region(slot).end();
        flash
            .erase(end.saturating_sub(F::ERASE_SIZE as u32), end)
            .map_err(StoreError::flash)?;
        self.update = Some(Update {
            slot,
            len,
            written: 0,
            erased: 0,
        });
        Ok(slot)
    }

    /// Without a good slot: the one that was chosen longer ago.
    fn least<F: NorFlash>(&self, flash: &mut F) -> Slot {
        let [a, b] = Slot::ALL.map(|slot| self.record(flash, slot).map_or(0, |r| r.sequence));
        if b < a { Slot::B } else { Slot::A }
    }

    /// Takes a chunk and returns where the next one begins. One that was taken before is compared
    /// and otherwise passed over, so that a chunk may come twice.
    ///
    /// # Errors
    /// [`StoreError::Offset`] for a chunk that comes too early, [`StoreError::Different`] for one
    /// that came before with other contents, [`StoreError::Unaligned`] for one, not being the
    /// last, that is not made of whole words of the flash (and of 4 bytes); nothing has changed then. A failing
    /// flash ends the update.
    ///
    /// # Timing
    /// Erases the sectors that are begun: one, for chunks up to its size, or two.
    pub fn write<F: NorFlash>(
        &mut self,
        flash: &mut F,
        offset: u32,
        chunk: &[u8],
    ) -> Result<u32, StoreError> {
        let update = self.update.ok_or(StoreError::Incomplete)?;
        let end = u32::try_from(chunk.len())
            .ok()
            .and_then(|len| offset.checked_add(len))
            .filter(|&end| end <= update.len)
            .ok_or(StoreError::Length)?;
        if end <= update.written {
            self.compare(flash, update.slot, offset, chunk)?;
            return Ok(update.written);
        }
        if offset != update.written {
            return Err(StoreError::Offset {
                expected: update.written,
            });
        }
        if end != update.len && !chunk.len().is_multiple_of(F::WRITE_SIZE.max(4)) {
            return Err(StoreError::Unaligned);
        }
        let programmed = self.program(flash, update, chunk, end);
        self.update = programmed.ok();
        programmed.map(|update| update.written)
    }

    fn program<F: NorFlash>(
        &self,
        flash: &mut F,
        mut update: Update,
        chunk: &[u8],
        end: u32,
    ) -> Result<Update, StoreError> {
        let region = self.region(update.slot);
        let sector = F::ERASE_SIZE as u32;
        while update.erased < end {
            let next = update.erased.saturating_add(sector);
            if next < region.len {
                flash
                    .erase(region.at(update.erased), region.at(next))
                    .map_err(StoreError::flash)?;
            }
            update.erased = next;
        }
        let whole = chunk.len() - chunk.len() % F::WRITE_SIZE;
        let (words, rest) = chunk.split_at_checked(whole).ok_or(StoreError::Length)?;
        flash
            .write(region.at(update.written), words)
            .map_err(StoreError::flash)?;
        if !rest.is_empty() {
            let mut last = [0xff; MAX_WRITE_SIZE];
            for (place, byte) in last.iter_mut().zip(rest) {
                *place = *byte;
            }
            let last = last.get(..F::WRITE_SIZE).ok_or(StoreError::Length)?;
            let at = update.written.saturating_add(whole as u32);
            flash
                .write(region.at(at), last)
                .map_err(StoreError::flash)?;
        }
        update.written = end;
        Ok(update)
    }

    /// Compares a stretch of a slot with what it should hold.
    fn compare<F: NorFlash>(
        &self,
        flash: &mut F,
        slot: Slot,
        offset: u32,
        chunk: &[u8],
    ) -> Result<(), StoreError> {
        let mut at = self.region(slot).at(offset);
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

    /// How far the update under way has come: where the next chunk begins.
    pub fn expected(&self) -> Option<u32> {
        self.update.map(|update| update.written)
    }

    /// Ends the update: reads the image back into `buffer` (aligned to 4 bytes), compares length
    /// and CRC-32P4 of all its bytes with what the sender says, checks it, asks `accept`, and only
    /// then chooses it. It takes effect by [`boot`](Self::boot).
    ///
    /// # Errors
    /// [`StoreError::Incomplete`] before the last chunk; why the image is not good. The table in
    /// use stays in use. After an image that is not good the update must begin anew.
    pub fn commit<F: NorFlash>(
        &mut self,
        flash: &mut F,
        len: u32,
        crc: u32,
        buffer: &mut [u8],
        accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        let complete = |update: &Update| update.written == update.len && len == update.len;
        let update = self.update.filter(complete).ok_or(StoreError::Incomplete)?;
        self.end_update();
        let record = Record {
            sequence: 0,
            len,
            crc,
        };
        self.load(flash, update.slot, record, buffer, accept)?;
        self.choose(flash, update.slot, len, crc)
    }

    /// The CRC-32P4 that [`commit`](Self::commit) expects, for senders.
    pub fn crc(image: &[u8]) -> u32 {
        CRC.checksum(image)
    }

    /// No update is under way any more; what was being checked may be another image.
    pub(crate) fn end_update(&mut self) {
        self.update = None;
        self.checker = Default::default();
    }

    /// The slot that an update under way is changing.
    pub(crate) fn updating(&self) -> Option<Slot> {
        self.update.map(|update| update.slot)
    }
}
