//! SysTick as the sampling timer: every Cortex-M with a clock has it.

use cortex_m::asm;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};

use crate::board::{BOARD, chosen};
use crate::unit::SCHEDULE;
use crate::unit::devices::SampleClock;

/// Counts of a period.
const PERIOD: u32 = BOARD.systick_hz / SCHEDULE.sample_rate_hz as u32;

const _: () = assert!(
    PERIOD * SCHEDULE.sample_rate_hz as u32 == BOARD.systick_hz && PERIOD <= 1 << 24,
    "SysTick cannot count the sampling period"
);

/// Counts per period of the board's free-running counter.
const FREE_PER_PERIOD: u32 = chosen::FREE_RUNNING_HZ / SCHEDULE.sample_rate_hz as u32;

const _: () = assert!(
    FREE_PER_PERIOD * SCHEDULE.sample_rate_hz as u32 == chosen::FREE_RUNNING_HZ
        && FREE_PER_PERIOD >= 5
        // The product of a period's counts of both is formed in 32 bits.
        && FREE_PER_PERIOD as u64 * PERIOD as u64 <= u32::MAX as u64
        && (chosen::FREE_RUNNING_MAX & chosen::FREE_RUNNING_MAX.wrapping_add(1)) == 0,
    "the free-running counter cannot count sampling periods"
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
    const FREE_PER_PERIOD: u32 = FREE_PER_PERIOD;
    const FREE_MAX: u32 = chosen::FREE_RUNNING_MAX;

    fn since_interrupt(&self) -> u32 {
        PERIOD - 1 - SYST::get_current()
    }

    fn period(&self) -> u32 {
        PERIOD
    }

    fn sleep(&self) -> u32 {
        // With interrupts held back, so that their time does not count as asleep.
        let (before, after) = cortex_m::interrupt::free(|_| {
            let before = SYST::get_current();
            chosen::idle();
            (before, SYST::get_current())
        });
        // It counts down, and at most once to zero.
        if after <= before {
            before - after
        } else {
            before + PERIOD - after
        }
    }

    fn free_running(&self) -> u32 {
        chosen::free_running()
    }

    fn interrupt_now(&self) {
        SCB::set_pendst();
        asm::dsb();
        asm::isb();
    }
}
