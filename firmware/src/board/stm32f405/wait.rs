//! Waits of microseconds and less, by cycles of the processor.

use cortex_m::asm;
use embedded_hal::delay::DelayNs;

use super::BOARD;

/// Duration of a cycle, rounded down \[ns\].
const CYCLE_NS: u32 = 1_000_000_000 / BOARD.systick_hz;

/// Waits at least as long as it is told; interrupts make it longer.
#[derive(Clone, Copy)]
pub(super) struct Cycles;

impl DelayNs for Cycles {
    fn delay_ns(&mut self, ns: u32) {
        asm::delay(ns.div_ceil(CYCLE_NS));
    }
}
