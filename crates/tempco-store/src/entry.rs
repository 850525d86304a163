//! Entries: seven words with a CRC, appended to a strip of flash and never changed.

use embedded_storage::nor_flash::NorFlash;
use tempco_image::CRC;

use crate::StoreError;

/// The longest word of a flash that is supported \[bytes\].
pub const MAX_WRITE_SIZE: usize = 64;

/// Bytes of an entry; in the flash it takes [`stride`] bytes.
const LEN: usize = 32;

/// The content of an entry.
pub(crate) type Words = [u32; 7];

/// Bytes from one entry to the next.
pub(crate) const fn stride<F: NorFlash>() -> u32 {
    if F::WRITE_SIZE > LEN {
        F::WRITE_SIZE as u32
    } else {
        LEN as u32
    }
}

/// What is found at the place of an entry.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// Erased.
    Blank,
    /// An entry.
    Entry(Words),
    /// Something else, or it cannot be read: a torn entry, or one that was damaged.
    Spoilt,
}

/// A strip of `count` places for entries.
#[derive(Clone, Copy)]
pub(crate) struct Strip {
    pub(crate) start: u32,
    pub(crate) count: u32,
}

impl Strip {
    pub(crate) fn read<F: NorFlash>(self, flash: &mut F, index: u32) -> Found {
        let mut bytes = [0; MAX_WRITE_SIZE];
        let Some(bytes) = bytes.get_mut(..stride::<F>() as usize) else {
            return Found::Spoilt;
        };
        if flash
            .read(self.start + index * stride::<F>(), bytes)
            .is_err()
        {
            return Found::Spoilt;
        }
        if bytes.iter().all(|&byte| byte == 0xff) {
            return Found::Blank;
        }
        decode(bytes).map_or(Found::Spoilt, Found::Entry)
    }

    /// The entries that can be read, first to last.
    pub(crate) fn entries<F: NorFlash>(self, flash: &mut F) -> impl Iterator<Item = Words> {
        (0..self.count).filter_map(move |index| match self.read(flash, index) {
            Found::Entry(words) => Some(words),
            _ => None,
        })
    }

    /// The first place behind all that is not blank.
    pub(crate) fn free<F: NorFlash>(self, flash: &mut F) -> u32 {
        let used = (0..self.count).rev();
        let mut used = used.skip_while(|&index| self.read(flash, index) == Found::Blank);
        used.next().map_or(0, |index| index + 1)
    }

    /// Programs an entry at the first place from `index` on that takes it, and returns the place
    /// behind it. A place can look blank and not take it, if power failed during its erase.
    pub(crate) fn append<F: NorFlash>(
        self,
        flash: &mut F,
        index: u32,
        words: &Words,
    ) -> Result<u32, StoreError> {
        let mut bytes = [0xff; MAX_WRITE_SIZE];
        encode(words, &mut bytes);
        let bytes = bytes
            .get(..stride::<F>() as usize)
            .ok_or(StoreError::Full)?;
        for index in index..self.count {
            // Whether it was programmed is told by reading it, not by what the driver thinks.
            let _ = flash.write(self.start + index * stride::<F>(), bytes);
            if self.read(flash, index) == Found::Entry(*words) {
                return Ok(index + 1);
            }
        }
        Err(StoreError::Full)
    }
}

fn encode(words: &Words, bytes: &mut [u8; MAX_WRITE_SIZE]) {
    let (places, _) = bytes.as_chunks_mut::<4>();
    let mut digest = CRC.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    let words = words.iter().copied().chain([digest.finalize()]);
    for (place, word) in places.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
}

fn decode(bytes: &[u8]) -> Option<Words> {
    let (covered, rest) = bytes.split_at_checked(LEN - 4)?;
    let crc = u32::from_le_bytes(*rest.first_chunk()?);
    if CRC.checksum(covered) != crc {
        return None;
    }
    let mut words = [0; 7];
    for (word, bytes) in words.iter_mut().zip(covered.as_chunks().0) {
        *word = u32::from_le_bytes(*bytes);
    }
    Some(words)
}
