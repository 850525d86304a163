//! The two slots: which one is in use, and how it is found.

use core::ops::Not;

use embedded_storage::nor_flash::NorFlash;
use tempco_image::{CRC, Image, ImageError};

use crate::check::Checker;
use crate::entry::Strip;
use crate::update::Update;
use crate::{Region, StoreError};

/// Places for entries in a slot: one for the update, the others for selections.
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
    pub(crate) sequence: u32,
    pub(crate) len: u32,
    pub(crate) crc: u32,
}

impl Record {
    pub(crate) const fn words(self) -> [u32; WORDS] {
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

/// The table in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Active {
    /// Where it is.
    pub slot: Slot,
    /// Sequence number of its entry: how many updates and selections there were.
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
    regions: [Region; 2],
    /// What boot would choose, as far as is known.
    pub(crate) current: Option<Slot>,
    /// The current one was chosen after the last boot.
    pub(crate) is_new: bool,
    pub(crate) update: Option<Update>,
    pub(crate) checker: Checker,
}

impl Store {
    /// A store in two regions of a flash. [`boot`](Self::boot) comes next.
    ///
    /// # Errors
    /// Regions that overlap, are not made of whole sectors, or have no room for an image.
    pub fn new<F: NorFlash>(flash: &F, a: Region, b: Region) -> Result<Self, StoreError> {
        a.check(flash)?;
        b.check(flash)?;
        let least = 2 * entries_len::<F>();
        let entries_fit = entries_len::<F>() <= F::ERASE_SIZE as u32;
        if a.overlaps(b) || a.len < least || b.len < least || !entries_fit {
            return Err(StoreError::Region);
        }
        Ok(Self {
            regions: [a, b],
            current: None,
            is_new: false,
            update: None,
            checker: Checker::default(),
        })
    }

    /// Finds the table in use: loads the slot chosen last into `buffer`, checks lengths and CRCs
    /// and asks `accept`; if it is not good, the other slot. Ends an update that is under way.
    ///
    /// `buffer` must be aligned to 4 bytes. `accept` validates, for instance, for one channel of
    /// three axes, two plays and a slow part:
    /// `|image| { image.expect_serial(serial)?; image.tables::<1, 3, 2, 1>().map(drop) }`.
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
        let records = Slot::ALL.map(|slot| self.record(flash, slot));
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
            if active.is_some() {
                return SlotState::Standby;
            }
            match self.load(flash, slot, record, buffer, &mut accept) {
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

    /// Makes a slot the one in use, once it has been loaded into `buffer` and accepted; with the
    /// other slot, the roll-back. It takes effect by [`boot`](Self::boot), without which no further update or
    /// selection is taken.
    ///
    /// # Errors
    /// [`StoreError::Empty`], or why the slot is not good; [`StoreError::Full`] after seven
    /// selections of a slot. Nothing has changed then.
    pub fn select<F: NorFlash>(
        &mut self,
        flash: &mut F,
        slot: Slot,
        buffer: &mut [u8],
        accept: impl FnMut(&Image) -> Result<(), ImageError>,
    ) -> Result<(), StoreError> {
        self.expect_booted()?;
        if self.current == Some(slot) {
            return Ok(());
        }
        let record = self.record(flash, slot).ok_or(StoreError::Empty)?;
        self.load(flash, slot, record, buffer, accept)?;
        self.choose(flash, slot, record.len, record.crc)
    }

    pub(crate) fn expect_booted(&self) -> Result<(), StoreError> {
        if self.is_new {
            Err(StoreError::NotBooted)
        } else {
            Ok(())
        }
    }

    /// Programs the entry by which a slot becomes the one in use.
    pub(crate) fn choose<F: NorFlash>(
        &mut self,
        flash: &mut F,
        slot: Slot,
        len: u32,
        crc: u32,
    ) -> Result<(), StoreError> {
        let records = Slot::ALL.map(|slot| self.record(flash, slot));
        let sequences = records.into_iter().flatten().map(|record| record.sequence);
        let sequence = sequences.max().unwrap_or(0).checked_add(1);
        let record = Record {
            sequence: sequence.ok_or(StoreError::Full)?,
            len,
            crc,
        };
        let strip = self.strip::<F>(slot);
        let free = strip.free(flash);
        strip.append(flash, free, &record.words())?;
        self.current = Some(slot);
        self.is_new = true;
        self.end_update();
        Ok(())
    }

    /// Loads a slot's image and checks it.
    pub(crate) fn load<F: NorFlash>(
        &self,
        flash: &mut F,
        slot: Slot,
        record: Record,
        buffer: &mut [u8],
        mut accept: impl FnMut(&Image) -> Result<(), ImageError>,
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

    /// The latest entry of a slot.
    pub(crate) fn record<F: NorFlash>(&self, flash: &mut F, slot: Slot) -> Option<Record> {
        let records = self.strip::<F>(slot).entries(flash);
        let records = records.filter_map(Record::from_words);
        records.max_by_key(|record| record.sequence)
    }

    pub(crate) fn region(&self, slot: Slot) -> Region {
        slot.of(self.regions)
    }

    fn strip<F: NorFlash>(&self, slot: Slot) -> Strip<WORDS> {
        Strip {
            start: self.region(slot).at(self.room::<F>(slot)),
            count: ENTRIES,
        }
    }

    /// The longest image of a slot \[bytes\].
    pub fn room<F: NorFlash>(&self, slot: Slot) -> u32 {
        self.region(slot).len.saturating_sub(entries_len::<F>())
    }
}
