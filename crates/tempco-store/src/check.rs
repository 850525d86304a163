//! The periodic check of both slots, in bounded slices.

use embedded_storage::nor_flash::NorFlash;
use tempco_image::{BLOCK_LEN, CRC, contents_len};

use crate::StoreError;
use crate::slot::{Slot, Slots};

/// How far the periodic check has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Checked {
    /// The slice was read; the slot is not yet through.
    Underway(Slot),
    /// The slot has no image, or is being updated.
    Passed(Slot),
    /// All CRCs of the slot's image are right.
    Good(Slot),
    /// The slot's image is damaged or cannot be read.
    Bad(Slot, StoreError),
}

/// Bytes read at once.
const SLICE: usize = 64;

/// The place of the check.
pub(crate) struct Checker {
    slot: Slot,
    /// Of the slot's image, set at its start.
    len: u32,
    offset: u32,
    digest: crc::Digest<'static, u32>,
}

impl Default for Checker {
    fn default() -> Self {
        Self::at(Slot::A)
    }
}

impl Checker {
    fn at(slot: Slot) -> Self {
        Self {
            slot,
            len: 0,
            offset: 0,
            digest: CRC.digest(),
        }
    }

    /// Reads on by up to `slices` slices, at most to the end of a slot; passes over one that is
    /// being updated.
    pub(crate) fn check<F: NorFlash>(
        &mut self,
        slots: &Slots,
        flash: &mut F,
        slices: u32,
        updating: Option<Slot>,
    ) -> Checked {
        let slot = self.slot;
        let has_image = match self.offset {
            0 if updating == Some(slot) => Ok(false),
            0 => self.start(slots, flash),
            _ => Ok(true),
        };
        let outcome = match has_image {
            Ok(false) => Checked::Passed(slot),
            Err(error) => Checked::Bad(slot, error),
            Ok(true) => {
                // Ends with the slot, however many slices are asked for.
                match (0..slices).find_map(|_| match self.check_slice(slots, flash) {
                    Ok(false) => None,
                    Ok(true) => Some(Checked::Good(slot)),
                    Err(error) => Some(Checked::Bad(slot, error)),
                }) {
                    Some(outcome) => outcome,
                    None => return Checked::Underway(slot),
                }
            }
        };
        *self = Self::at(!slot);
        outcome
    }

    /// Whether there is an image to check.
    fn start<F: NorFlash>(&mut self, slots: &Slots, flash: &mut F) -> Result<bool, StoreError> {
        let Some(record) = slots.record(flash, self.slot) else {
            return Ok(false);
        };
        if record.len > slots.room::<F>(self.slot) {
            return Err(StoreError::Length);
        }
        self.len = record.len;
        Ok(true)
    }

    /// Checks the next bytes of a block, or its CRC; `true` at the end of the image.
    fn check_slice<F: NorFlash>(
        &mut self,
        slots: &Slots,
        flash: &mut F,
    ) -> Result<bool, StoreError> {
        let region = slots.region(self.slot);
        let contents = contents_len(self.len as usize).ok_or(StoreError::Length)? as u32;
        let block = self.offset / BLOCK_LEN as u32;
        let end = block.saturating_add(1).saturating_mul(BLOCK_LEN as u32);
        let end = end.min(contents);
        let len = end.saturating_sub(self.offset).min(SLICE as u32);
        let mut bytes = [0; SLICE];
        let bytes = bytes.get_mut(..len as usize).ok_or(StoreError::Length)?;
        flash
            .read(region.at(self.offset), bytes)
            .map_err(StoreError::flash)?;
        self.digest.update(bytes);
        self.offset = self.offset.saturating_add(len);
        if self.offset < end {
            return Ok(false);
        }
        let mut expected = [0; 4];
        let crc_at = contents.saturating_add(block.saturating_mul(4));
        flash
            .read(region.at(crc_at), &mut expected)
            .map_err(StoreError::flash)?;
        let found = core::mem::replace(&mut self.digest, CRC.digest()).finalize();
        if found != u32::from_le_bytes(expected) {
            let block = block as usize;
            return Err(StoreError::Image(tempco_image::ImageError::Crc { block }));
        }
        Ok(self.offset == contents)
    }
}
