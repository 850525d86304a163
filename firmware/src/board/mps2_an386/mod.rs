//! Arm MPS2 with the AN386 FPGA image: a Cortex-M4F at 25 MHz. The reference board.
//!
//! In QEMU (`mps2-an386`) one SysTick count is 40 ns, and with `-icount shift=0` an instruction
//! takes 1 ns: 40 calls of a function take one count per instruction of the function.
//!
//! For the application: the link is UART0. The board has neither a flash of its own for data nor
//! sensors nor a gyro. A stretch of RAM stands in for the flash, with its rules ([`nor`]). For the
//! others there is a test bench on UART1 (`bench`), which a message sets once, or with the feature
//! `world` a host that plays them all the time (`world`). With the feature `gyro-simulated` there is
//! a simulated chip for the bench's gyro (`imu`).

#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application"
))]
mod application;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application",
    not(feature = "world")
))]
mod bench;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application",
    feature = "gyro-simulated"
))]
mod imu;
pub mod nor;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application"
))]
mod played;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application"
))]
mod registers;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application"
))]
mod uart;
#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application",
    feature = "world"
))]
mod world;

#[cfg(all(
    target_os = "none",
    feature = "board-mps2-an386",
    feature = "application"
))]
pub use application::*;

#[cfg(all(target_os = "none", feature = "board-mps2-an386"))]
pub mod interrupts;

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "mps2-an386",
    systick_hz: 25_000_000,
};
