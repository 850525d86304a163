//! The devices' registers.

use core::sync::atomic::AtomicU32;

use volatile_register::RW;

use super::nor::WORDS;

/// Those of a UART, as in the technical reference manual of the Cortex-M System Design Kit.
#[repr(C)]
pub(super) struct UartRegisters {
    pub(super) data: RW<u32>,
    pub(super) state: RW<u32>,
    pub(super) control: RW<u32>,
    pub(super) interrupt: RW<u32>,
    pub(super) baud_divider: RW<u32>,
}

#[repr(C)]
struct WatchdogRegisters {
    load: RW<u32>,
    value: RW<u32>,
    control: RW<u32>,
    clear: RW<u32>,
}

#[repr(C)]
struct TimerRegisters {
    control: RW<u32>,
    value: RW<u32>,
    reload: RW<u32>,
    #[cfg(feature = "gyro-simulated")]
    interrupt: RW<u32>,
}

const TIMER_ENABLE: u32 = 1;
#[cfg(feature = "gyro-simulated")]
const TIMER_INTERRUPT: u32 = 8;
const WATCHDOG_ENABLE: u32 = 1;
const WATCHDOG_RESET: u32 = 2;

// SAFETY: the addresses are the devices' in Arm's Application Note AN386, mapped for
// ever, aligned to words, and of registers that are accessed by volatile words only. The PSRAM
// is RAM that the linker does not use; any bits are an `AtomicU32`.
#[allow(unsafe_code)]
mod at {
    use super::{AtomicU32, RW, TimerRegisters, UartRegisters, WORDS, WatchdogRegisters};

    pub(super) fn uart0() -> &'static UartRegisters {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4000_4000) }
    }
    pub(super) fn uart1() -> &'static UartRegisters {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4000_5000) }
    }
    #[cfg(feature = "gyro-simulated")]
    pub(super) fn timer0() -> &'static TimerRegisters {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4000_0000) }
    }
    pub(super) fn timer1() -> &'static TimerRegisters {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4000_1000) }
    }
    pub(super) fn watchdog() -> &'static WatchdogRegisters {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4000_8000) }
    }
    pub(super) fn lamps() -> &'static RW<u32> {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x4002_8000) }
    }
    pub(super) fn flash() -> &'static [AtomicU32; WORDS] {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x2100_0000) }
    }
    /// Words of the PSRAM far behind the flash.
    #[cfg(feature = "gyro-simulated")]
    pub(super) fn notes() -> &'static [AtomicU32; 2] {
        // SAFETY: as said of the module.
        unsafe { &*core::ptr::with_exposed_provenance(0x2110_0000) }
    }
    pub(super) fn write(register: &RW<u32>, value: u32) {
        // SAFETY: as said of the module.
        unsafe { register.write(value) }
    }
}

pub(super) fn flash() -> &'static [AtomicU32; WORDS] {
    at::flash()
}

/// Words behind the flash, for who looks at the memory from outside.
#[cfg(feature = "gyro-simulated")]
pub(super) fn notes() -> &'static [AtomicU32; 2] {
    at::notes()
}

pub(super) fn uart0() -> &'static UartRegisters {
    at::uart0()
}

pub(super) fn uart1() -> &'static UartRegisters {
    at::uart1()
}

pub(super) fn put_lamps(value: u32) {
    at::write(at::lamps(), value);
}

pub(super) fn start_timer() {
    at::write(&at::timer1().reload, u32::MAX);
    at::write(&at::timer1().value, u32::MAX);
    at::write(&at::timer1().control, TIMER_ENABLE);
}

/// It counts down.
pub(super) fn timer_counts() -> u32 {
    u32::MAX - at::timer1().value.read()
}

/// Lets timer 0 interrupt every so many counts.
#[cfg(feature = "gyro-simulated")]
pub(super) fn start_data_ready(counts: u32) {
    at::write(&at::timer0().reload, counts - 1);
    at::write(&at::timer0().value, counts - 1);
    at::write(&at::timer0().control, TIMER_ENABLE | TIMER_INTERRUPT);
}

/// Whether timer 0 has interrupted; it then has not any more.
#[cfg(feature = "gyro-simulated")]
pub(super) fn take_data_ready() -> bool {
    let has_come = at::timer0().interrupt.read() != 0;
    at::write(&at::timer0().interrupt, 1);
    has_come
}

pub(super) fn start_watchdog(counts: u32) {
    at::write(&at::watchdog().load, counts);
    at::write(&at::watchdog().control, WATCHDOG_ENABLE | WATCHDOG_RESET);
}

pub(super) fn feed_watchdog() {
    at::write(&at::watchdog().clear, 1);
}
