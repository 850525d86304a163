//! BBC micro:bit: a Cortex-M0 (nRF51822), without floating point and conditional instructions.
//!
//! The chip has no SysTick. QEMU's has one, at 16 MHz; only the counts of the bench images use it.

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "microbit",
    systick_hz: 16_000_000,
};
