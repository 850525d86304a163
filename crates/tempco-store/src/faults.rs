//! The fault log: for each fault how often and when it last occurred, kept over resets.
//!
//! A journal with the code as the key. A power cut at any operation loses the entry that was being
//! written, and nothing older.

use embedded_storage::nor_flash::NorFlash;

use crate::journal::Journal;
use crate::{Region, StoreError};

const MAGIC: u32 = u32::from_le_bytes(*b"TCF3");

/// Erasures of a half after which the log is worn: what data sheets promise of most flashes.
const MOST_ERASURES: u32 = 10_000;

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
    journal: Journal<7>,
    faults: [Fault; CODES],
    /// Occurrences since boot, which decide what is written.
    since_boot: [u32; CODES],
    written: [u32; CODES],
    sequence: u32,
    boot: u32,
}

impl<const CODES: usize> FaultLog<CODES> {
    /// Reads the log from a region; what cannot be read is left out.
    ///
    /// # Errors
    /// A region that is not made of two equal halves of whole sectors with room for two entries
    /// per code.
    pub fn open<F: NorFlash>(flash: &mut F, region: Region) -> Result<Self, StoreError> {
        let mut log = Self {
            journal: Journal::open(flash, region, MAGIC, CODES)?,
            faults: [Fault::default(); CODES],
            since_boot: [0; CODES],
            written: [0; CODES],
            sequence: 0,
            boot: 1,
        };
        for words in log.journal.entries(flash) {
            let [_, code, sequence, count, boot, uptime_s, detail] = words;
            log.sequence = log.sequence.max(sequence);
            log.boot = log.boot.max(boot.saturating_add(1));
            if let Some(fault) = log.faults.get_mut(code as usize) {
                *fault = Fault {
                    count,
                    boot,
                    uptime_s,
                    detail,
                    sequence,
                };
            }
        }
        log.written = log.faults.map(|fault| fault.count);
        Ok(log)
    }

    /// Records an occurrence, `uptime_s` after boot.
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

    /// Numbers this boot as a record elsewhere does, if that is further.
    pub fn at_least_boot(&mut self, boot: u32) {
        self.boot = self.boot.max(boot);
    }

    /// How often a half was erased, as far as its marks can be read.
    pub const fn erasures(&self) -> u32 {
        self.journal.erasures()
    }

    /// Whether the log has had its 10,000 erasures. When its half is full, nothing more is written;
    /// faults are counted here all the same.
    pub const fn is_worn(&self) -> bool {
        self.erasures() >= MOST_ERASURES
    }

    /// The number of this boot, from 1 on; boots without a fault count once.
    pub const fn boot(&self) -> u32 {
        self.boot
    }

    fn write<F: NorFlash>(&mut self, flash: &mut F, code: usize) -> Result<(), StoreError> {
        let fault = self.faults.get(code).ok_or(StoreError::Code)?;
        if self.journal.append(flash, &words(code, fault)).is_ok() {
            if let Some(written) = self.written.get_mut(code) {
                *written = fault.count;
            }
            return Ok(());
        }
        if self.is_worn() {
            return Ok(());
        }
        let faults = (0..CODES).zip(&self.faults);
        let occurred = faults.filter(|(_, fault)| fault.count > 0);
        let latest = occurred.map(|(code, fault)| words(code, fault));
        self.journal.turn(flash, latest)?;
        self.written = self.faults.map(|fault| fault.count);
        Ok(())
    }
}

const fn words(code: usize, fault: &Fault) -> [u32; 7] {
    [
        MAGIC,
        code as u32,
        fault.sequence,
        fault.count,
        fault.boot,
        fault.uptime_s,
        fault.detail,
    ]
}
