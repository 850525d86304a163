//! Entries: a few words with a CRC, appended to a strip of flash and never changed.

use embedded_storage::nor_flash::NorFlash;
use tempco_image::CRC;

use crate::StoreError;

/// The longest word of a flash that is supported, and the longest entry \[bytes\].
pub const MAX_WRITE_SIZE: usize = 64;

/// What is found at the place of an entry.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found<const N: usize> {
    /// Erased.
    Blank,
    /// An entry.
    Entry([u32; N]),
    /// Something else, or it cannot be read: a torn entry, or one that was damaged.
    Spoilt,
}

/// A strip of `count` places for entries of `N` words and their CRC.
#[derive(Clone, Copy)]
pub(crate) struct Strip<const N: usize> {
    pub(crate) start: u32,
    pub(crate) count: u32,
}

impl<const N: usize> Strip<N> {
    /// Bytes from one entry to the next: as many words of the flash as an entry takes.
    pub(crate) const fn stride<F: NorFlash>() -> u32 {
        const { (4 * (N + 1)).next_multiple_of(F::WRITE_SIZE) as u32 }
    }

    pub(crate) fn read<F: NorFlash>(self, flash: &mut F, index: u32) -> Found<N> {
        let mut bytes = [0; MAX_WRITE_SIZE];
        let Some(bytes) = bytes.get_mut(..Self::stride::<F>() as usize) else {
            return Found::Spoilt;
        };
        if flash.read(self.place::<F>(index), bytes).is_err() {
            return Found::Spoilt;
        }
        if bytes.iter().all(|&byte| byte == 0xff) {
            return Found::Blank;
        }
        decode(bytes).map_or(Found::Spoilt, Found::Entry)
    }

    /// The entries that can be read, first to last.
    pub(crate) fn entries<F: NorFlash>(self, flash: &mut F) -> impl Iterator<Item = [u32; N]> {
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
        words: &[u32; N],
    ) -> Result<u32, StoreError> {
        let mut bytes = [0xff; MAX_WRITE_SIZE];
        encode(words, &mut bytes);
        let bytes = bytes
            .get(..Self::stride::<F>() as usize)
            .ok_or(StoreError::Full)?;
        for index in index..self.count {
            // Reading it says whether it was programmed, not what the driver returns.
            let _ = flash.write(self.place::<F>(index), bytes);
            if self.read(flash, index) == Found::Entry(*words) {
                return Ok(index + 1);
            }
        }
        Err(StoreError::Full)
    }

    const fn place<F: NorFlash>(self, index: u32) -> u32 {
        let offset = index.saturating_mul(Self::stride::<F>());
        self.start.saturating_add(offset)
    }
}

fn encode<const N: usize>(words: &[u32; N], bytes: &mut [u8; MAX_WRITE_SIZE]) {
    const { assert!(4 * (N + 1) <= MAX_WRITE_SIZE) };
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

fn decode<const N: usize>(bytes: &[u8]) -> Option<[u32; N]> {
    let (covered, rest) = bytes.split_at_checked(4 * N)?;
    let crc = u32::from_le_bytes(*rest.first_chunk()?);
    if CRC.checksum(covered) != crc {
        return None;
    }
    let mut words = [0; N];
    for (word, bytes) in words.iter_mut().zip(covered.as_chunks().0) {
        *word = u32::from_le_bytes(*bytes);
    }
    Some(words)
}
