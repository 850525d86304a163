//! SysTick as the sampling timer: every Cortex-M with a clock has it.

use cortex_m::asm;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};

use crate::board::BOARD;
use crate::unit::SCHEDULE;
use crate::unit::devices::SampleClock;

/// Counts of a period.
const PERIOD: u32 = BOARD.systick_hz / SCHEDULE.sample_rate_hz as u32;

const _: () = assert!(
    PERIOD * SCHEDULE.sample_rate_hz as u32 == BOARD.systick_hz && PERIOD <= 1 << 24,
    "SysTick cannot count the sampling period"
);

/// SysTick, for both sides.
#[derive(Clone, Copy, Debug)]
pub struct SysTick;

impl SysTick {
    /// Starts the interrupt.
    pub fn start(timer: &mut SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(PERIOD - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Self
    }
}

impl SampleClock for SysTick {
    const COUNT_NS: u32 = 1_000_000_000 / BOARD.systick_hz;

    fn since_interrupt(&self) -> u32 {
        PERIOD - 1 - SYST::get_current()
    }

    fn period(&self) -> u32 {
        PERIOD
    }

    fn sleep(&self) -> u32 {
        // With interrupts held back, so that their time does not count as asleep.
        cortex_m::interrupt::free(|_| {
            let before = SYST::get_current();
            asm::wfi();
            let after = SYST::get_current();
            // It counts down, and at most once to zero.
            if after <= before {
                before - after
            } else {
                before + PERIOD - after
            }
        })
    }

    fn interrupt_now(&self) {
        SCB::set_pendst();
        asm::dsb();
        asm::isb();
    }
}
