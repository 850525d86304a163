//! Arm MPS2 with the AN385 FPGA image: a Cortex-M3 at 25 MHz, without floating point.

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "mps2-an385",
    systick_hz: 25_000_000,
};
