//! The board's set-up for the application.

use cortex_m_rt::exception;
use tempco_link::FaultSet;

#[cfg(not(feature = "world"))]
use super::bench::BenchThermometers as BoardThermometers;
use super::interrupts::Interrupt;
use super::nor::Nor;
pub use super::nor::REGIONS;
use super::registers;
use super::uart::Uart;
#[cfg(feature = "world")]
use super::world::WorldThermometers as BoardThermometers;
use crate::reset;
use crate::unit::devices::{Devices, ResetCause, Watchdog};

#[cfg(not(any(feature = "world", feature = "gyro-simulated")))]
pub use super::bench::BenchGyro as BoardGyro;
// The output of the simulated gyro is the bench's.
#[cfg(feature = "world")]
pub use super::world::WorldGyro as BoardGyro;
#[cfg(feature = "gyro-simulated")]
pub use super::{bench::BenchGyro, imu::Imu as BoardGyro};

/// The flash that holds the store.
pub type BoardFlash = Nor<'static>;

pub use crate::idle::stay_awake as idle;

/// Rate of [`free_running`], the processor's \[Hz\].
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
    Devices<Uart, BoardThermometers, BoardWatchdog>,
    BoardFlash,
    BoardGyro,
)> {
    let flash = Nor(registers::flash());
    registers::start_timer();
    let devices = Devices {
        link: Uart::link()?,
        thermometers: BoardThermometers::new(Uart::bench()?),
        watchdog: BoardWatchdog(()),
        // The board does not say; the watchdog's warning does.
        reset_cause: ResetCause::PowerOn,
        faults: FaultSet::NONE,
    };
    #[cfg(not(feature = "gyro-simulated"))]
    let gyro = BoardGyro::new();
    #[cfg(feature = "gyro-simulated")]
    let gyro = BoardGyro::start()?;
    // Timer 0 runs with the simulated gyro only.
    for interrupt in [Interrupt::UARTRX0, Interrupt::UARTRX1, Interrupt::TIMER0] {
        // SAFETY: the handlers have what they need, and nothing relies on their being masked.
        #[allow(unsafe_code)]
        unsafe {
            core.NVIC.set_priority(interrupt, DEVICE_PRIORITY);
            cortex_m::peripheral::NVIC::unmask(interrupt);
        }
    }
    Some((devices, flash, gyro))
}

/// Below the sampling interrupt, which has the highest there is.
const DEVICE_PRIORITY: u8 = 0x80;

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
