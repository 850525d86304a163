//! The constant biases found by re-zero, and the numbers of boots and sessions, kept over resets.
//!
//! A journal with two keys. An entry of the first holds the biases of all axes and the CRC of the
//! table that they belong to, an entry of the second the numbers. A power cut at any operation
//! leaves all of an entry as it was or all as it was to be.

use embedded_storage::nor_flash::NorFlash;
use tempco::MAX_AXES;

use crate::journal::Journal;
use crate::{Region, StoreError};

const MAGIC: u32 = u32::from_le_bytes(*b"TCO1");

/// Keys of the offsets and of the numbers.
const OFFSETS: u32 = 0;
const NUMBERS: u32 = 1;

/// Magic number, key, CRC, axes.
const WORDS: usize = 3 + MAX_AXES;

/// In place of the bias of an axis that there is not.
const NO_AXIS: u32 = u32::MAX;

/// Constant biases of up to six axes, taken out in addition to the table.
pub struct Offsets<const AXES: usize> {
    journal: Journal<WORDS>,
    /// CRC of the table, and the biases.
    latest: Option<(u32, [f32; AXES])>,
    numbers: Option<Numbers>,
}

/// Numbers that do not come again. They stand with the offsets, apart from the fault log, so that
/// damage in one of the two regions resets nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Numbers {
    /// The number of this boot, from 1 on.
    pub boot: u32,
    /// The first session that nobody has been promised.
    pub session: u32,
    /// Resets in a row that nobody wanted.
    pub resets: u32,
}

impl<const AXES: usize> Offsets<AXES> {
    /// Reads the offsets from a region; those of another number of axes are none.
    ///
    /// # Errors
    /// A region that is not made of two equal halves of whole sectors.
    pub fn open<F: NorFlash>(flash: &mut F, region: Region) -> Result<Self, StoreError> {
        const { assert!(AXES <= MAX_AXES, "up to six axes") };
        let journal = Journal::open(flash, region, MAGIC, 2)?;
        let mut of = |key| {
            journal
                .entries(flash)
                .filter(|words| words[1] == key)
                .last()
        };
        let latest = of(OFFSETS).and_then(from_words);
        let numbers = of(NUMBERS).map(|[_, _, boot, session, resets, ..]| Numbers {
            boot,
            session,
            resets,
        });
        Ok(Self {
            journal,
            latest,
            numbers,
        })
    }

    /// The offsets to take out of the outcomes of a table: 0 where the ones that were set belong to
    /// another table, or none were set \[unit of the axis\].
    ///
    /// `table_crc` is in the image's [`Info`](tempco_image::Info): re-zero finds what a
    /// table leaves, so its offsets are worth nothing with another table.
    pub fn of(&self, table_crc: u32) -> [f32; AXES] {
        match self.latest {
            Some((crc, offsets)) if crc == table_crc => offsets,
            _ => [0.0; AXES],
        }
    }

    /// The CRC of the table that the offsets belong to; none where none were set.
    pub fn table_crc(&self) -> Option<u32> {
        self.latest.map(|(table_crc, _)| table_crc)
    }

    /// Sets the offsets of a table, in place of all that were set before.
    ///
    /// # Errors
    /// [`StoreError::NotFinite`] for an offset that is not finite; a failing flash. The offsets are
    /// as before then.
    ///
    /// # Timing
    /// Programs one entry; once in a while erases half of the region before.
    pub fn set<F: NorFlash>(
        &mut self,
        flash: &mut F,
        table_crc: u32,
        offsets: [f32; AXES],
    ) -> Result<(), StoreError> {
        if !offsets.iter().all(|offset| offset.is_finite()) {
            return Err(StoreError::NotFinite);
        }
        let offsets = (table_crc, offsets);
        self.write(flash, of_offsets(&offsets), self.numbers.map(of_numbers))?;
        self.latest = Some(offsets);
        Ok(())
    }

    /// How often a half was erased, as far as its marks can be read.
    pub const fn erasures(&self) -> u32 {
        self.journal.erasures()
    }

    /// The numbers as they were set last, if they were.
    pub const fn numbers(&self) -> Option<Numbers> {
        self.numbers
    }

    /// Sets the numbers.
    ///
    /// # Errors
    /// A failing flash, in which case they are the numbers here all the same.
    ///
    /// # Timing
    /// As [`set`](Self::set).
    pub fn set_numbers<F: NorFlash>(
        &mut self,
        flash: &mut F,
        numbers: Numbers,
    ) -> Result<(), StoreError> {
        self.numbers = Some(numbers);
        let offsets = self.latest.as_ref().map(of_offsets);
        self.write(flash, of_numbers(numbers), offsets)
    }

    /// Writes an entry; `other` is the latest one of the other key.
    fn write<F: NorFlash>(
        &mut self,
        flash: &mut F,
        words: [u32; WORDS],
        other: Option<[u32; WORDS]>,
    ) -> Result<(), StoreError> {
        match self.journal.append(flash, &words) {
            Ok(()) => Ok(()),
            Err(_) => self.journal.turn(flash, other.into_iter().chain([words])),
        }
    }
}

fn of_offsets<const AXES: usize>((table_crc, offsets): &(u32, [f32; AXES])) -> [u32; WORDS] {
    let offsets = offsets.iter().map(|offset| offset.to_bits());
    to_words([OFFSETS, *table_crc].into_iter().chain(offsets))
}

fn of_numbers(numbers: Numbers) -> [u32; WORDS] {
    let Numbers {
        boot,
        session,
        resets,
    } = numbers;
    to_words([NUMBERS, boot, session, resets])
}

/// An entry, from its key on.
fn to_words(used: impl IntoIterator<Item = u32>) -> [u32; WORDS] {
    let mut words = [NO_AXIS; WORDS];
    for (place, word) in words.iter_mut().zip([MAGIC].into_iter().chain(used)) {
        *place = word;
    }
    words
}

/// Table and offsets of an entry, unless it is of another number of axes.
fn from_words<const AXES: usize>(words: [u32; WORDS]) -> Option<(u32, [f32; AXES])> {
    let [_, _, table_crc, axes @ ..] = words;
    let (used, unused) = axes.split_first_chunk::<AXES>()?;
    let offsets = used.map(f32::from_bits);
    let as_many = offsets.iter().all(|offset| offset.is_finite());
    let no_more = unused.iter().all(|&axis| axis == NO_AXIS);
    (as_many && no_more).then_some((table_crc, offsets))
}
