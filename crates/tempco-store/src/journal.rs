//! A journal: words by key, of which the latest entry counts, kept over resets and power cuts.
//!
//! Entries are appended to one half of a region. When it is full, the other half is erased and
//! gets one entry per key and then a mark that it is complete; only a half with its mark counts,
//! and of two the later one. So a power cut at any operation loses the entry that was being
//! written, and nothing older; and since an entry counts only with its CRC, it is there wholly or
//! not at all.

use embedded_storage::nor_flash::NorFlash;

use crate::entry::Strip;
use crate::{Region, StoreError};

/// In place of a key: the half is complete.
const MARK: u32 = u32::MAX;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Half {
    First,
    Second,
}

/// A journal of entries of `N` words. The first one is the magic number, which distinguishes journals
/// apart, the second one the key, and the others are free.
pub(crate) struct Journal<const N: usize> {
    magic: u32,
    region: Region,
    /// The half in use and its first free place; none before the first entry ever.
    current: Option<(Half, u32)>,
    /// How often the halves were changed.
    turns: u32,
}

impl<const N: usize> Journal<N> {
    /// Finds the half in use.
    ///
    /// # Errors
    /// A region that is not made of two equal halves of whole sectors with room for two entries
    /// per key.
    pub(crate) fn open<F: NorFlash>(
        flash: &mut F,
        region: Region,
        magic: u32,
        keys: usize,
    ) -> Result<Self, StoreError> {
        region.check(flash)?;
        let mut journal = Self {
            magic,
            region,
            current: None,
            turns: 0,
        };
        let halves = (region.len / F::ERASE_SIZE as u32).is_multiple_of(2);
        if !halves || (journal.strip::<F>(Half::First).count as usize) <= keys.saturating_mul(2) {
            return Err(StoreError::Region);
        }
        let marks = [Half::First, Half::Second].map(|half| (journal.mark(flash, half), half));
        let [first, second] = marks;
        let latest = if second.0 > first.0 { second } else { first };
        if let (Some(turns), half) = latest {
            journal.turns = turns;
            journal.current = Some((half, journal.strip::<F>(half).free(flash)));
        }
        Ok(journal)
    }

    /// How often the half that was erased more often was erased.
    pub(crate) const fn erasures(&self) -> u32 {
        self.turns.div_ceil(2)
    }

    /// The number of the turn by which a half was completed.
    fn mark<F: NorFlash>(&self, flash: &mut F, half: Half) -> Option<u32> {
        let mut entries = self.strip::<F>(half).entries(flash);
        entries.find_map(|words| match words.as_slice() {
            [magic, MARK, turns, ..] if *magic == self.magic => Some(*turns),
            _ => None,
        })
    }

    /// The entries of the half in use that can be read, of a key the latest one last.
    pub(crate) fn entries<F: NorFlash>(&self, flash: &mut F) -> impl Iterator<Item = [u32; N]> {
        let strip = match self.current {
            Some((half, _)) => self.strip::<F>(half),
            None => Strip { start: 0, count: 0 },
        };
        let own = |words: &[u32; N]| match words.as_slice() {
            [magic, key, ..] => *magic == self.magic && *key != MARK,
            _ => false,
        };
        strip.entries(flash).filter(own)
    }

    /// Appends an entry.
    ///
    /// # Errors
    /// [`StoreError::Full`]: it is time for a [turn](Self::turn).
    pub(crate) fn append<F: NorFlash>(
        &mut self,
        flash: &mut F,
        words: &[u32; N],
    ) -> Result<(), StoreError> {
        let (half, free) = self.current.ok_or(StoreError::Full)?;
        let free = self.strip::<F>(half).append(flash, free, words)?;
        self.current = Some((half, free));
        Ok(())
    }

    /// Goes on in the other half, with the latest entry of every key.
    ///
    /// # Errors
    /// A failing flash; the half in use stays in use.
    pub(crate) fn turn<F: NorFlash>(
        &mut self,
        flash: &mut F,
        latest: impl IntoIterator<Item = [u32; N]>,
    ) -> Result<(), StoreError> {
        let half = match self.current {
            Some((Half::First, _)) => Half::Second,
            _ => Half::First,
        };
        let strip = self.strip::<F>(half);
        let end = strip.start.saturating_add(self.region.len / 2);
        flash.erase(strip.start, end).map_err(StoreError::flash)?;
        let turns = self.turns.saturating_add(1);
        let mut mark = [0; N];
        for (place, word) in mark.iter_mut().zip([self.magic, MARK, turns]) {
            *place = word;
        }
        let mut free = 0;
        for words in latest.into_iter().chain([mark]) {
            free = strip.append(flash, free, &words)?;
        }
        self.turns = turns;
        self.current = Some((half, free));
        Ok(())
    }

    fn strip<F: NorFlash>(&self, half: Half) -> Strip<N> {
        let len = self.region.len / 2;
        let offset = match half {
            Half::First => 0,
            Half::Second => len,
        };
        Strip {
            start: self.region.at(offset),
            count: len / Strip::<N>::stride::<F>(),
        }
    }
}
