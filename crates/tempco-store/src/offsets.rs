//! The constant biases found by re-zero, kept over resets.
//!
//! A journal with one key: an entry holds the biases of all axes and the CRC of the table that
//! they belong to. A power cut at any operation leaves all of them as they were or all as they
//! were to be.

use embedded_storage::nor_flash::NorFlash;
use tempco::MAX_AXES;

use crate::journal::Journal;
use crate::{Region, StoreError};

const MAGIC: u32 = u32::from_le_bytes(*b"TCO1");

/// The one key.
const KEY: u32 = 0;

/// Magic number, key, CRC, axes.
const WORDS: usize = 3 + MAX_AXES;

/// In place of the bias of an axis that there is not.
const NO_AXIS: u32 = u32::MAX;

/// Constant biases of up to six axes, taken out in addition to the table.
pub struct Offsets<const AXES: usize> {
    journal: Journal<WORDS>,
    /// CRC of the table, and the biases.
    latest: Option<(u32, [f32; AXES])>,
}

impl<const AXES: usize> Offsets<AXES> {
    /// Reads the offsets from a region; those of another number of axes are none.
    ///
    /// # Errors
    /// A region that is not made of two equal halves of whole sectors.
    pub fn open<F: NorFlash>(flash: &mut F, region: Region) -> Result<Self, StoreError> {
        const { assert!(AXES <= MAX_AXES, "up to six axes") };
        let journal = Journal::open(flash, region, MAGIC, 1)?;
        let latest = journal.entries(flash).last().and_then(from_words);
        Ok(Self { journal, latest })
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
        let words = to_words(table_crc, &offsets);
        if self.journal.append(flash, &words).is_err() {
            self.journal.turn(flash, [words])?;
        }
        self.latest = Some((table_crc, offsets));
        Ok(())
    }
}

fn to_words(table_crc: u32, offsets: &[f32]) -> [u32; WORDS] {
    let mut words = [NO_AXIS; WORDS];
    let offsets = offsets.iter().map(|offset| offset.to_bits());
    let used = [MAGIC, KEY, table_crc].into_iter().chain(offsets);
    for (place, word) in words.iter_mut().zip(used) {
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
