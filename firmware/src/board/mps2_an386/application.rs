//! The board's set-up for the application.

use cortex_m_rt::exception;
use tempco_link::FaultSet;

use super::bench::{BenchGyro, BenchThermometers};
use super::interrupts::Interrupt;
use super::nor::Nor;
pub use super::nor::REGIONS;
use super::uart::Uart;
use crate::reset;
use crate::unit::devices::{Devices, ResetCause, Watchdog};

/// The gyro.
pub type BoardGyro = BenchGyro;
/// The flash that holds the store.
pub type BoardFlash = Nor<'static>;

pub use crate::idle::stay_awake as idle;

/// Rate of [`free_running`], which is that of the processor \[Hz\].
pub const FREE_RUNNING_HZ: u32 = 25_000_000;
/// Its largest value.
pub const FREE_RUNNING_MAX: u32 = u32::MAX;

/// A counter that nothing stops: timer 1.
pub fn free_running() -> u32 {
    registers::timer_counts()
}

/// Sets the board up. Once.
pub fn take(
    core: &mut cortex_m::Peripherals,
) -> Option<(
    Devices<Uart, BenchThermometers, BoardWatchdog>,
    BoardFlash,
    BoardGyro,
)> {
    let flash = Nor(registers::flash());
    registers::start_timer();
    let devices = Devices {
        link: Uart::link()?,
        thermometers: BenchThermometers::new(Uart::bench()?),
        watchdog: BoardWatchdog(()),
        // The board does not tell; the watchdog's warning does.
        reset_cause: ResetCause::PowerOn,
        faults: FaultSet::NONE,
    };
    for interrupt in [Interrupt::UARTRX0, Interrupt::UARTRX1] {
        // SAFETY: the handlers have what they need, and nothing relies on their being masked.
        #[allow(unsafe_code)]
        unsafe {
            core.NVIC.set_priority(interrupt, RECEIVE_PRIORITY);
            cortex_m::peripheral::NVIC::unmask(interrupt);
        }
    }
    Some((devices, flash, BenchGyro::new()))
}

/// Below the sampling interrupt, which has the highest there is.
const RECEIVE_PRIORITY: u8 = 0x80;

/// The CMSDK APB watchdog: at its first timeout a non-maskable interrupt, which resets.
pub struct BoardWatchdog(());

impl Watchdog for BoardWatchdog {
    fn start(&mut self, timeout_ms: u32) {
        registers::start_watchdog(timeout_ms * 25_000);
    }

    fn feed(&mut self) {
        registers::feed_watchdog();
    }
}

// SAFETY: the handler writes atomics and resets the processor; it returns to nothing.
#[allow(unsafe_code)]
#[exception]
unsafe fn NonMaskableInt() -> ! {
    reset::because(reset::Reason::Watchdog)
}

/// The devices' registers.
pub(super) mod registers {
    use core::sync::atomic::AtomicU32;

    use volatile_register::RW;

    use super::super::nor::WORDS;
    use super::super::uart;

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
    }

    const TIMER_ENABLE: u32 = 1;
    const WATCHDOG_ENABLE: u32 = 1;
    const WATCHDOG_RESET: u32 = 2;

    // SAFETY: the addresses are those of the devices in Arm's Application Note AN386, mapped for
    // ever, aligned to words, and of registers that are accessed by volatile words only. The PSRAM
    // is RAM that the linker does not use; any bits are an `AtomicU32`.
    #[allow(unsafe_code)]
    mod at {
        use super::{AtomicU32, RW, TimerRegisters, WORDS, WatchdogRegisters, uart};

        pub(super) fn uart0() -> &'static uart::Registers {
            // SAFETY: as said of the module.
            unsafe { &*core::ptr::with_exposed_provenance(0x4000_4000) }
        }
        pub(super) fn uart1() -> &'static uart::Registers {
            // SAFETY: as said of the module.
            unsafe { &*core::ptr::with_exposed_provenance(0x4000_5000) }
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
        pub(super) fn write(register: &RW<u32>, value: u32) {
            // SAFETY: as said of the module.
            unsafe { register.write(value) }
        }
    }

    pub(super) fn flash() -> &'static [AtomicU32; WORDS] {
        at::flash()
    }

    pub(in super::super) fn uart0() -> &'static uart::Registers {
        at::uart0()
    }

    pub(in super::super) fn uart1() -> &'static uart::Registers {
        at::uart1()
    }

    pub(in super::super) fn put_lamps(value: u32) {
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

    pub(super) fn start_watchdog(counts: u32) {
        at::write(&at::watchdog().load, counts);
        at::write(&at::watchdog().control, WATCHDOG_ENABLE | WATCHDOG_RESET);
    }

    pub(super) fn feed_watchdog() {
        at::write(&at::watchdog().clear, 1);
    }
}
