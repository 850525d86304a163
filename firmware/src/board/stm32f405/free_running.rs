//! A counter that nothing stops: timer 7.
//!
//! The cycle counter of the processor would be finer, but stands while the processor sleeps.

use stm32f4xx_hal::pac::{TIM7, tim7};
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// Rate of [`free_running`] \[Hz\]: in its 16 bits it comes round after 6.5 s, later than the
/// erasure of a sector ends.
pub const FREE_RUNNING_HZ: u32 = 10_000;
/// Its largest value.
pub const FREE_RUNNING_MAX: u32 = 0xffff;

/// The counter.
pub fn free_running() -> u32 {
    registers().cnt().read().bits()
}

/// Starts it.
pub(super) fn start(timer: TIM7, rcc: &mut Rcc) {
    TIM7::enable(rcc);
    TIM7::reset(rcc);
    let prescaler = TIM7::timer_clock(&rcc.clocks).raw() / FREE_RUNNING_HZ - 1;
    timer.psc().write(|w| w.psc().set(prescaler as u16));
    timer.arr().reset();
    // The prescaler counts from the next update on, which is now.
    timer.egr().write(|w| w.ug().update());
    timer.cr1().write(|w| w.cen().enabled());
}

fn registers() -> &'static tim7::RegisterBlock {
    // SAFETY: the registers are mapped for ever, and only their counter is read.
    #[allow(unsafe_code)]
    unsafe {
        &*TIM7::ptr()
    }
}
