//! Arm MPS2 with the AN505 FPGA image: a Cortex-M33 (Armv8-M) in its secure state, at 20 MHz.
//!
//! Here to show that the other architecture, with instructions of its own for selecting between
//! floats, computes the same bits.

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "mps2-an505",
    systick_hz: 20_000_000,
};
