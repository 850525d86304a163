//! The two slots: an image each, and behind it the entries that say whether it counts.

use core::ops::Not;

use embedded_storage::nor_flash::NorFlash;
use tempco_image::{CRC, Image, ImageError};

use crate::entry::Strip;
use crate::{Region, StoreError};

/// Places for entries in a slot: one of the image that was stored, the others for selections.
const ENTRIES: u32 = 8;

const MAGIC: u32 = u32::from_le_bytes(*b"TCS1");

/// Words of an entry.
const WORDS: usize = 7;

/// Bytes of the places for entries.
const fn entries_len<F: NorFlash>() -> u32 {
    ENTRIES * Strip::<WORDS>::stride::<F>()
}

/// One of the two copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slot {
    /// The first one.
    A,
    /// The second one.
    B,
}

impl Slot {
    /// Both.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// One of two things.
    pub(crate) fn of<T>(self, [a, b]: [T; 2]) -> T {
        match self {
            Self::A => a,
            Self::B => b,
        }
    }
}

impl Not for Slot {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// The latest entry of a slot: what the slot should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Record {
    /// 0 where the image was stored and never chosen.
    pub(crate) sequence: u32,
    pub(crate) len: u32,
    pub(crate) crc: u32,
}

impl Record {
    const fn words(self) -> [u32; WORDS] {
        let blank = u32::MAX;
        [
            MAGIC,
            self.sequence,
            self.len,
            self.crc,
            blank,
            blank,
            blank,
        ]
    }

    fn from_words(words: [u32; WORDS]) -> Option<Self> {
        let [magic, sequence, len, crc, ..] = words;
        (magic == MAGIC).then_some(Self { sequence, len, crc })
    }
}

/// Where both are in the flash.
pub(crate) struct Slots([Region; 2]);

impl Slots {
    /// Checks that the slots fit the flash, and an image each slot.
    pub(crate) fn new<F: NorFlash>(flash: &F, a: Region, b: Region) -> Result<Self, StoreError> {
        a.check(flash)?;
        b.check(flash)?;
        let least = 2 * entries_len::<F>();
        let entries_fit = entries_len::<F>() <= F::ERASE_SIZE as u32;
        if a.overlaps(b) || a.len < least || b.len < least || !entries_fit {
            return Err(StoreError::Region);
        }
        Ok(Self([a, b]))
    }

    pub(crate) fn region(&self, slot: Slot) -> Region {
        slot.of(self.0)
    }

    /// The longest image of a slot \[bytes\].
    pub(crate) fn room<F: NorFlash>(&self, slot: Slot) -> u32 {
        self.region(slot).len.saturating_sub(entries_len::<F>())
    }

    /// The latest entry of a slot.
    pub(crate) fn record<F: NorFlash>(&self, flash: &mut F, slot: Slot) -> Option<Record> {
        let records = self.strip::<F>(slot).entries(flash);
        let records = records.filter_map(Record::from_words);
        records.max_by_key(|record| record.sequence)
    }

    /// Without a slot in use: the one that was chosen longer ago.
    pub(crate) fn older<F: NorFlash>(&self, flash: &mut F) -> Slot {
        let [a, b] = Slot::ALL.map(|slot| self.record(flash, slot).map_or(0, |r| r.sequence));
        if b < a { Slot::B } else { Slot::A }
    }

    /// Programs the entry by which a slot becomes the one in use.
    pub(crate) fn choose<F: NorFlash>(
        &self,
        flash: &mut F,
        slot: Slot,
        record: Record,
    ) -> Result<(), StoreError> {
        let records = Slot::ALL.map(|slot| self.record(flash, slot));
        let sequences = records.into_iter().flatten().map(|record| record.sequence);
        let sequence = sequences.max().unwrap_or(0).checked_add(1);
        let sequence = sequence.ok_or(StoreError::Full)?;
        self.append(flash, slot, Record { sequence, ..record })
    }

    /// Programs an entry.
    pub(crate) fn append<F: NorFlash>(
        &self,
        flash: &mut F,
        slot: Slot,
        record: Record,
    ) -> Result<(), StoreError> {
        let strip = self.strip::<F>(slot);
        let free = strip.free(flash);
        strip.append(flash, free, &record.words()).map(drop)
    }

    /// Loads the image that a slot should hold, and checks it.
    pub(crate) fn load<F: NorFlash>(
        &self,
        flash: &mut F,
        slot: Slot,
        record: Record,
        buffer: &mut [u8],
        accept: &mut impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        let len = record.len as usize;
        let buffer = buffer.get_mut(..len).ok_or(StoreError::Length)?;
        if record.len > self.room::<F>(slot) {
            return Err(StoreError::Length);
        }
        flash
            .read(self.region(slot).start, buffer)
            .map_err(StoreError::flash)?;
        if CRC.checksum(buffer) != record.crc {
            return Err(StoreError::Different);
        }
        let image = Image::read(buffer).map_err(StoreError::Image)?;
        if image.bytes().len() != len {
            return Err(StoreError::Length);
        }
        accept(&image).map_err(StoreError::Image)
    }

    fn strip<F: NorFlash>(&self, slot: Slot) -> Strip<WORDS> {
        Strip {
            start: self.region(slot).at(self.room::<F>(slot)),
            count: ENTRIES,
        }
    }
}
