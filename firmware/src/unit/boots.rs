//! What is kept from boot to boot: numbers of sessions, so that none comes again, and how many
//! resets there were in a row, which make a boot wait so that they do not wear out the flash.

use tempco_link::Fault;

use super::devices::{Flash, SampleClock, Thermometers};
use super::service::Service;

/// Numbers of sessions that are promised at once.
const SESSIONS: u32 = 256;

/// From so few sessions left on, more are promised. A pass opens fewer.
const FEW_SESSIONS: u32 = 16;

/// Resets in a row after which a boot does not wait yet.
const PATIENCE: u32 = 2;

/// The longest wait is 2 to the power of this \[s\].
const LONGEST: u32 = 6;

/// A boot that has run for so long ends the row \[s\].
const IS_WELL_S: u32 = 600;

/// How long a boot waits after so many unwanted resets in a row \[s\].
const fn wait_s(resets: u32) -> u32 {
    match resets.checked_sub(PATIENCE + 1) {
        Some(beyond) if beyond < LONGEST => 1 << beyond,
        Some(_) => 1 << LONGEST,
        None => 0,
    }
}

impl<F, T, K, const C: usize, const A: usize> Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    /// Counts the last reset, promises the first sessions, and returns the number of the first one.
    pub(super) fn note_boot(&mut self, was_unwanted: bool) -> u32 {
        let resets = if was_unwanted {
            self.storage.resets().saturating_add(1)
        } else {
            0
        };
        let first_session = self.storage.promised_sessions();
        self.keep_numbers(first_session.wrapping_add(SESSIONS), resets);
        first_session
    }

    /// Waits if there were many resets in a row. The interrupt takes samples meanwhile, which are
    /// marked as invalid.
    pub(super) fn hold_off(&mut self) {
        let wait_ms = 1000 * wait_s(self.storage.resets());
        while self.time.now_ms() < wait_ms {
            self.clock.sleep();
            self.drain();
        }
    }

    /// Ends the row of resets once the unit has run for long enough.
    pub(super) fn note_well(&mut self) {
        if self.storage.resets() > 0 && self.time.uptime_s() >= IS_WELL_S {
            self.keep_numbers(self.storage.promised_sessions(), 0);
        }
    }

    /// Promises more sessions before they are used up; `next` is the number of the next one.
    pub(super) fn promise_sessions(&mut self, next: u32) {
        let promised = self.storage.promised_sessions();
        if promised.wrapping_sub(next) <= FEW_SESSIONS {
            self.keep_numbers(promised.wrapping_add(SESSIONS), self.storage.resets());
        }
    }

    #[inline(never)]
    fn keep_numbers(&mut self, session: u32, resets: u32) {
        if self.storage.keep_numbers(session, resets).is_err() {
            self.record_fault(Fault::Flash, 0);
        }
    }
}
