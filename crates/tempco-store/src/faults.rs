//! The fault log: for each fault how often and when it last occurred, kept over resets.
//!
//! Entries are appended to one half of a region. When it is full, the other half is erased and
//! gets one entry per fault and then a mark that it is complete; only a half with its mark counts,
//! and of two the later one. So a power cut at any operation loses the entry that was being
//! written, and nothing older.

use embedded_storage::nor_flash::NorFlash;

use crate::entry::{Strip, Words, stride};
use crate::{Region, StoreError};

const MAGIC: u32 = u32::from_le_bytes(*b"TCF1");

/// In place of a code: the half is complete.
const MARK: u32 = u32::MAX;

/// What is known of one fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// How often it occurred.
    pub count: u32,
    /// In which boot it last occurred, counted from 1.
    pub boot: u32,
    /// When, after that boot \[s\].
    pub uptime_s: u32,
    /// What the caller adds, such as an address or a channel.
    pub detail: u32,
    /// Order of the last occurrence among all faults.
    pub sequence: u32,
}

/// A log of faults with codes from 0 to below `CODES`.
pub struct FaultLog<const CODES: usize> {
    region: Region,
    /// The half in use and its first free place; none before the first entry ever.
    current: Option<(Half, u32)>,
    faults: [Fault; CODES],
    /// Occurrences since boot, which decide what is written.
    since_boot: [u32; CODES],
    written: [u32; CODES],
    sequence: u32,
    boot: u32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Half {
    First,
    Second,
}

impl<const CODES: usize> FaultLog<CODES> {
    /// Reads the log from a region; what cannot be read is left out.
    ///
    /// # Errors
    /// A region that is not made of two equal halves of whole sectors with room for two entries
    /// per code.
    pub fn open<F: NorFlash>(flash: &mut F, region: Region) -> Result<Self, StoreError> {
        region.check(flash)?;
        let mut log = Self {
            region,
            current: None,
            faults: [Fault::default(); CODES],
            since_boot: [0; CODES],
            written: [0; CODES],
            sequence: 0,
            boot: 1,
        };
        let halves = (region.len / F::ERASE_SIZE as u32).is_multiple_of(2);
        if !halves || (log.strip::<F>(Half::First).count as usize) < 2 * CODES + 1 {
            return Err(StoreError::Region);
        }
        let marks = [Half::First, Half::Second].map(|half| (log.mark(flash, half), half));
        let [first, second] = marks;
        let latest = if second.0 > first.0 { second } else { first };
        if let (Some(_), half) = latest {
            log.read(flash, half);
        }
        log.written = log.faults.map(|fault| fault.count);
        Ok(log)
    }

    /// Sequence number of the mark of a half.
    fn mark<F: NorFlash>(&self, flash: &mut F, half: Half) -> Option<u32> {
        let mut entries = self.strip::<F>(half).entries(flash);
        entries.find_map(|words| match words {
            [MAGIC, sequence, MARK, ..] => Some(sequence),
            _ => None,
        })
    }

    /// Takes over what a half says, which is all that counts.
    fn read<F: NorFlash>(&mut self, flash: &mut F, half: Half) {
        let strip = self.strip::<F>(half);
        for words in strip.entries(flash) {
            let [MAGIC, sequence, code, count, boot, uptime_s, detail] = words else {
                continue;
            };
            self.sequence = self.sequence.max(sequence);
            self.boot = self.boot.max(boot.saturating_add(1));
            if let Some(fault) = self.faults.get_mut(code as usize) {
                *fault = Fault {
                    count,
                    boot,
                    uptime_s,
                    detail,
                    sequence,
                };
            }
        }
        self.current = Some((half, strip.free(flash)));
    }

    /// Notes an occurrence, `uptime_s` after boot.
    ///
    /// It is written where it is the first, second, fourth, eighth, ... since boot, so that a fault
    /// that comes every second does not wear out the flash; a reset loses less than half of the
    /// occurrences since boot, and never the fault itself. [`flush`](Self::flush) writes the rest.
    ///
    /// # Errors
    /// A code beyond `CODES`; a failing flash, in which case it is counted here all the same.
    pub fn record<F: NorFlash>(
        &mut self,
        flash: &mut F,
        code: usize,
        uptime_s: u32,
        detail: u32,
    ) -> Result<(), StoreError> {
        self.sequence = self.sequence.saturating_add(1);
        let fault = self.faults.get_mut(code).ok_or(StoreError::Code)?;
        *fault = Fault {
            count: fault.count.saturating_add(1),
            boot: self.boot,
            uptime_s,
            detail,
            sequence: self.sequence,
        };
        let since_boot = self.since_boot.get_mut(code).ok_or(StoreError::Code)?;
        *since_boot = since_boot.saturating_add(1);
        if since_boot.is_power_of_two() {
            self.write(flash, code)?;
        }
        Ok(())
    }

    /// Writes what has been counted but not written, for instance before a planned reset.
    ///
    /// # Errors
    /// A failing flash.
    pub fn flush<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), StoreError> {
        for code in 0..CODES {
            let of = |counts: Option<&u32>| counts.copied().unwrap_or(0);
            let count = self.faults.get(code).map(|fault| &fault.count);
            if of(count) != of(self.written.get(code)) {
                self.write(flash, code)?;
            }
        }
        Ok(())
    }

    /// The faults by code.
    pub const fn faults(&self) -> &[Fault; CODES] {
        &self.faults
    }

    /// The number of this boot, from 1 on; boots without a fault count once.
    pub const fn boot(&self) -> u32 {
        self.boot
    }

    fn write<F: NorFlash>(&mut self, flash: &mut F, code: usize) -> Result<(), StoreError> {
        let fault = *self.faults.get(code).ok_or(StoreError::Code)?;
        let appended = self.current.and_then(|(half, free)| {
            let words = words(code as u32, &fault);
            let next = self.strip::<F>(half).append(flash, free, &words).ok()?;
            Some((half, next))
        });
        match appended {
            Some(current) => {
                self.current = Some(current);
                if let Some(written) = self.written.get_mut(code) {
                    *written = fault.count;
                }
                Ok(())
            }
            None => self.turn(flash),
        }
    }

    /// Goes on in the other half, with one entry per fault.
    fn turn<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), StoreError> {
        let half = match self.current {
            Some((Half::First, _)) => Half::Second,
            _ => Half::First,
        };
        let strip = self.strip::<F>(half);
        flash
            .erase(strip.start, strip.start + self.region.len / 2)
            .map_err(StoreError::flash)?;
        let mut free = 0;
        for (code, fault) in self.faults.iter().enumerate() {
            if fault.count > 0 {
                free = strip.append(flash, free, &words(code as u32, fault))?;
            }
        }
        self.sequence = self.sequence.saturating_add(1);
        let mark = [MAGIC, self.sequence, MARK, 0, self.boot, 0, 0];
        free = strip.append(flash, free, &mark)?;
        self.current = Some((half, free));
        self.written = self.faults.map(|fault| fault.count);
        Ok(())
    }

    fn strip<F: NorFlash>(&self, half: Half) -> Strip {
        let len = self.region.len / 2;
        let start = match half {
            Half::First => self.region.start,
            Half::Second => self.region.start + len,
        };
        Strip {
            start,
            count: len / stride::<F>(),
        }
    }
}

const fn words(code: u32, fault: &Fault) -> Words {
    [
        MAGIC,
        fault.sequence,
        code,
        fault.count,
        fault.boot,
        fault.uptime_s,
        fault.detail,
    ]
}
