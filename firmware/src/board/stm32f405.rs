//! STM32F405, a Cortex-M4F with 1 MiB of flash and 128 KiB of RAM.
//!
//! In QEMU (`netduinoplus2`) it runs at 168 MHz. On silicon it starts from its 16 MHz internal
//! oscillator, and nothing here changes that: nothing depends on time but the counts of `bench`,
//! which only QEMU can make.

// Linked for the interrupt vectors.
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
use stm32f4xx_hal as _;

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "stm32f405",
    systick_hz: 168_000_000,
};
