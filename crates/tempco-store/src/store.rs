//! The table in use: how it is found at boot, updated, selected and checked.

use embedded_storage::nor_flash::NorFlash;
use tempco_image::{CRC, Image, ImageError};

use crate::check::{Checked, Checker};
use crate::slot::{Record, Slot, Slots};
use crate::update::Update;
use crate::{Region, StoreError};

/// The table in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Active {
    /// Where it is.
    pub slot: Slot,
    /// Sequence number of its entry: how many selections there were.
    pub sequence: u32,
    /// Length of its image, which the buffer begins with \[bytes\].
    pub len: usize,
}

/// What boot found in a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SlotState {
    /// No entry: never used, or an update did not come to its end.
    Empty,
    /// It was loaded and accepted.
    Active,
    /// Older than the active one, and not looked at.
    Standby,
    /// Stored and never selected: not looked at.
    Stored,
    /// It should hold an image but is not good.
    Bad(StoreError),
}

/// What boot found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Boot {
    /// The table in use; without one the unit runs uncompensated and must say so.
    pub active: Option<Active>,
    /// Slots A and B.
    pub slots: [SlotState; 2],
}

/// Two slots of flash. The flash is given to each method, since it usually is shared.
pub struct Store {
    slots: Slots,
    /// What boot would choose, as far as is known.
    current: Option<Slot>,
    /// The current one was chosen after the last boot.
    is_new: bool,
    update: Option<Update>,
    checker: Checker,
}

impl Store {
    /// A store in two regions of a flash. [`boot`](Self::boot) comes next.
    ///
    /// # Errors
    /// Regions that overlap, are not made of whole sectors, or have no room for an image.
    pub fn new<F: NorFlash>(flash: &F, a: Region, b: Region) -> Result<Self, StoreError> {
        Ok(Self {
            slots: Slots::new(flash, a, b)?,
            current: None,
            is_new: false,
            update: None,
            checker: Checker::default(),
        })
    }

    /// Finds the table in use: loads the slot selected last into `buffer`, checks lengths and CRCs
    /// and asks `accept`; if it is not good, the other slot. Ends an update that is under way.
    ///
    /// `buffer` must be aligned to 4 bytes. `accept` validates, for instance, for one channel of
    /// three axes: `|image| { image.expect_serial(serial)?; image.tables::<1, 3>().map(drop) }`.
    /// Afterwards, with an active table, `Image::read(&buffer[..active.len])` gives the same image
    /// again.
    ///
    /// # Timing
    /// Reads the entries of both slots and each image once at most.
    pub fn boot<F: NorFlash>(
        &mut self,
        flash: &mut F,
        buffer: &mut [u8],
        mut accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Boot {
        let records = Slot::ALL.map(|slot| self.slots.record(flash, slot));
        let sequence = |slot: Slot| slot.of(records).map_or(0, |record| record.sequence);
        let latest = if sequence(Slot::A) > sequence(Slot::B) {
            Slot::A
        } else {
            Slot::B
        };
        let mut active = None;
        let mut state_of = |slot: Slot| {
            let Some(record) = slot.of(records) else {
                return SlotState::Empty;
            };
            if record.sequence == 0 {
                return SlotState::Stored;
            }
            if active.is_some() {
                return SlotState::Standby;
            }
            let loaded = self.slots.load(flash, slot, record, buffer, &mut accept);
            match loaded {
                Ok(()) => {
                    active = Some(Active {
                        slot,
                        sequence: record.sequence,
                        len: record.len as usize,
                    });
                    SlotState::Active
                }
                Err(error) => SlotState::Bad(error),
            }
        };
        let (first, second) = (state_of(latest), state_of(!latest));
        self.current = active.map(|active| active.slot);
        self.is_new = false;
        self.end_update();
        Boot {
            active,
            slots: latest.of([[first, second], [second, first]]),
        }
    }

    /// Loads the table in use again, into another buffer, with the checks of [`boot`](Self::boot).
    /// Its slot is not written to as long as it is in use.
    ///
    /// # Errors
    /// Why it is not good, or [`StoreError::Different`] where it is not the one that was booted.
    ///
    /// # Timing
    /// Reads the entries of the slot and the image once.
    pub fn reload<F: NorFlash>(
        &self,
        flash: &mut F,
        active: Active,
        buffer: &mut [u8],
        mut accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        let record = self.slots.record(flash, active.slot);
        let record = record.ok_or(StoreError::Empty)?;
        if (record.sequence, record.len as usize) != (active.sequence, active.len) {
            return Err(StoreError::Different);
        }
        self.slots
            .load(flash, active.slot, record, buffer, &mut accept)
    }

    /// Makes a slot the one in use, once it has been loaded into `buffer` and accepted: an image that
    /// was stored, or the one before, which is the roll-back. It takes effect by [`boot`](Self::boot), without which no further update or
    /// selection is taken.
    ///
    /// # Errors
    /// [`StoreError::Empty`], or why the slot is not good; [`StoreError::Full`] after seven
    /// selections of a slot since its image was stored. Nothing has changed then.
    pub fn select<F: NorFlash>(
        &mut self,
        flash: &mut F,
        slot: Slot,
        buffer: &mut [u8],
        mut accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        self.expect_booted()?;
        if self.current == Some(slot) {
            return Ok(());
        }
        let record = self.slots.record(flash, slot).ok_or(StoreError::Empty)?;
        self.slots.load(flash, slot, record, buffer, &mut accept)?;
        self.slots.choose(flash, slot, record)?;
        self.current = Some(slot);
        self.is_new = true;
        self.end_update();
        Ok(())
    }

    /// The slot that is not in use, into which an update goes.
    pub fn spare<F: NorFlash>(&self, flash: &mut F) -> Slot {
        match self.current {
            Some(current) => !current,
            None => self.slots.older(flash),
        }
    }

    /// Begins an update with an image of `len` bytes in the slot that is not in use, and returns
    /// the slot. What was there is lost. An update under way is begun again.
    ///
    /// # Errors
    /// A length that is no multiple of 4 or does not fit, a table chosen since the last boot, or a failing flash.
    ///
    /// # Timing
    /// Erases one sector.
    pub fn begin<F: NorFlash>(&mut self, flash: &mut F, len: u32) -> Result<Slot, StoreError> {
        self.expect_booted()?;
        self.end_update();
        let slot = self.spare(flash);
        self.update = Some(Update::begin(&self.slots, flash, slot, len)?);
        Ok(slot)
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
        let Some(end) = update.new_end(&self.slots, flash, offset, chunk)? else {
            return Ok(update.written());
        };
        let programmed = update.program(&self.slots, flash, chunk, end);
        self.update = programmed.ok();
        programmed.map(|update| update.written())
    }

    /// How far the update under way has come: where the next chunk begins.
    pub fn expected(&self) -> Option<u32> {
        self.update.map(|update| update.written())
    }

    /// Ends the update: reads the image back into `buffer` (aligned to 4 bytes), compares length
    /// and CRC-32P4 of all its bytes with what the sender says, checks it, asks `accept`, and only
    /// then notes that it is stored. It is not used before it is [selected](Self::select).
    ///
    /// # Errors
    /// [`StoreError::Incomplete`] before the last chunk; why the image is not good. The table in
    /// use stays in use. After an image that is not good the update must begin again.
    pub fn commit<F: NorFlash>(
        &mut self,
        flash: &mut F,
        len: u32,
        crc: u32,
        buffer: &mut [u8],
        mut accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        let complete = |update: &Update| update.is_complete(len);
        let update = self.update.filter(complete).ok_or(StoreError::Incomplete)?;
        self.end_update();
        let record = Record {
            sequence: 0,
            len,
            crc,
        };
        let slot = update.slot();
        self.slots.load(flash, slot, record, buffer, &mut accept)?;
        self.slots.append(flash, slot, record)
    }

    /// The CRC-32P4 that [`commit`](Self::commit) expects, for senders.
    pub fn crc(image: &[u8]) -> u32 {
        CRC.checksum(image)
    }

    /// Reads on by up to `slices` times 64 bytes, at most to the end of a slot, and says what was
    /// found. Call it again and again: A and B take turns.
    ///
    /// # Timing
    /// At the start of a slot its entries are read besides.
    pub fn check<F: NorFlash>(&mut self, flash: &mut F, slices: u32) -> Checked {
        let updating = self.update.map(|update| update.slot());
        self.checker.check(&self.slots, flash, slices, updating)
    }

    /// The longest image of a slot \[bytes\].
    pub fn room<F: NorFlash>(&self, slot: Slot) -> u32 {
        self.slots.room::<F>(slot)
    }

    fn expect_booted(&self) -> Result<(), StoreError> {
        if self.is_new {
            Err(StoreError::NotBooted)
        } else {
            Ok(())
        }
    }

    /// No update is under way any more; what was being checked may be another image.
    fn end_update(&mut self) {
        self.update = None;
        self.checker = Checker::default();
    }
}
