//! Arm MPS2 with the AN500 FPGA image: a Cortex-M7 with a double-precision FPU, at 25 MHz.
//!
//! Here to show that a core with another FPU computes the same bits, and as the least that a board
//! of the application is: `docs/port-in-an-hour.md` shows both files of it to be copied.

#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an500",
    feature = "application"
))]
mod application;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an500",
    feature = "application"
))]
pub use application::*;

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "mps2-an500",
    systick_hz: 25_000_000,
};
