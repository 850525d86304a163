//! The independent watchdog, which runs from an oscillator of its own.

use core::cell::RefCell;

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog as hal;

use crate::unit::devices::Watchdog;

/// The erasure of a sector, bytes at a time, takes this long at most \[ms\].
const ERASURE_MS: u32 = 4000;

/// The oscillator may be this fast, and the timeouts are as of its nominal 32 kHz \[kHz\].
const FASTEST_KHZ: u32 = 47;
const NOMINAL_KHZ: u32 = 32;

/// The shortest timeout that is not shorter than an erasure \[ms\].
const MIN_TIMEOUT_MS: u32 = ERASURE_MS * FASTEST_KHZ / NOMINAL_KHZ + 125;

/// What the watchdog's divider can do \[ms\].
const MAX_TIMEOUT_MS: u32 = 32_767;

/// Puts the reset off, and does no more.
#[derive(Clone, Copy)]
pub(super) struct Feeder(&'static RefCell<hal::IndependentWatchdog>);

impl Feeder {
    /// Of a watchdog that stands while a debugger holds the processor. `None` where there is one.
    pub(super) fn new(iwdg: IWDG, debug: &DBGMCU) -> Option<Self> {
        let watchdog = hal::IndependentWatchdog::new(iwdg);
        watchdog.stop_on_debug(debug, true);
        let shared = cortex_m::singleton!(
            : RefCell<hal::IndependentWatchdog> = RefCell::new(watchdog)
        )?;
        Some(Self(shared))
    }

    pub(super) fn feed(self) {
        self.0.borrow_mut().feed();
    }
}

/// The watchdog. A timeout shorter than 6 s is raised to that, or an erasure would end in a reset;
/// with the spread of its oscillator the reset then comes after 4 to 11.3 s.
pub struct IndependentWatchdog(Feeder);

impl IndependentWatchdog {
    pub(super) const fn new(feeder: Feeder) -> Self {
        Self(feeder)
    }
}

impl Watchdog for IndependentWatchdog {
    fn start(&mut self, timeout_ms: u32) {
        let timeout_ms = timeout_ms.clamp(MIN_TIMEOUT_MS, MAX_TIMEOUT_MS);
        self.0.0.borrow_mut().start(timeout_ms.millis());
    }

    fn feed(&mut self) {
        self.0.feed();
    }
}
