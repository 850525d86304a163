//! Executed instructions of a function, from the time that passes in QEMU.
//!
//! Needs `-icount shift=0`, where an instruction takes 1 ns of the time that SysTick counts.

use core::hint::black_box;

use cortex_m::peripheral::{SYST, syst::SystClkSource};

use tempco_firmware::board::BOARD;

const NANOSECONDS: u32 = 1_000_000_000;

/// Calls per measurement, 4 counts per instruction: the counter's phase, which is worth one count,
/// cannot change the rounded result.
const CALLS: u32 = 4 * (NANOSECONDS / BOARD.systick_hz);

const RELOAD: u32 = 0x00ff_ffff;

/// SysTick, running.
pub struct Stopwatch(());

impl Stopwatch {
    /// Lets SysTick run.
    pub fn start(mut clock: SYST) -> Self {
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(RELOAD);
        clock.clear_current();
        clock.enable_counter();
        Self(())
    }

    /// SysTick counts of many calls, each from the same state.
    #[inline(never)]
    pub fn counts<S: Clone>(&self, state: &S, call: impl Fn(&mut S)) -> u32 {
        let mut present = state.clone();
        let start = SYST::get_current();
        for _ in 0..CALLS {
            present.clone_from(black_box(state));
            call(black_box(&mut present));
        }
        // SysTick counts down.
        start.wrapping_sub(SYST::get_current()) & RELOAD
    }
}

/// Least and most instructions of a call.
#[derive(Clone, Copy)]
pub struct Span {
    /// Least.
    pub min: u32,
    /// Most.
    pub max: u32,
}

impl Span {
    /// Nothing was measured.
    pub const NONE: Self = Self {
        min: u32::MAX,
        max: 0,
    };

    /// Takes in a measurement, given what the same calls of an empty function took.
    pub fn add(&mut self, counts: u32, of_empty: u32) {
        let divisor = u64::from(BOARD.systick_hz) * u64::from(CALLS);
        let time = u64::from(counts - of_empty) * u64::from(NANOSECONDS);
        let instructions = ((time + divisor / 2) / divisor) as u32;
        self.min = self.min.min(instructions);
        self.max = self.max.max(instructions);
    }

    /// Something was measured.
    pub const fn is_some(&self) -> bool {
        self.min > 0 && self.min <= self.max
    }
}
