//! Arm MPS2 with the AN500 FPGA image: a Cortex-M7 with a double-precision FPU, at 25 MHz.
//!
//! Here to show that a core with another FPU computes the same bits.

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "mps2-an500",
    systick_hz: 25_000_000,
};
