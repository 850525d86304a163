//! Waiting for an interrupt on boards that are emulated.

use cortex_m::asm;
use cortex_m::peripheral::{SCB, SYST};

/// SysTick or an interrupt of a device is pending.
const PENDING: u32 = 1 << 26 | 1 << 22;

/// Counts before SysTick from which on it is waited for without pauses.
const NEAR: u32 = 256;

/// A pause, of 130 instructions: less than [`NEAR`] counts in any time that the emulator is run by.
const PAUSE: u32 = 64;

/// Waits until an interrupt is pending, without sleep: in QEMU the time of a processor that sleeps
/// is the host's, and jumps over interrupts of the timer.
pub fn stay_awake() {
    loop {
        // First the time, so that SysTick cannot come between the two.
        let left = SYST::get_current();
        if is_pending() {
            return;
        }
        // The emulator takes far longer to look at a register than to wait.
        if left > NEAR {
            asm::delay(PAUSE);
        }
    }
}

fn is_pending() -> bool {
    // SAFETY: reading the register changes nothing.
    #[allow(unsafe_code)]
    let state = unsafe { (*SCB::PTR).icsr.read() };
    state & PENDING != 0
}
