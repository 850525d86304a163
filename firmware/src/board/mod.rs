//! What differs between boards.
//!
//! Adding a board: a module here, a memory file in `firmware/boards`, and a feature, all of one
//! name. A board whose clocks or pins must be set up does that in a function of its module.

pub mod microbit;
pub mod mps2_an385;
pub mod mps2_an386;
pub mod mps2_an500;
pub mod mps2_an505;
pub mod stm32f405;

/// A board as the images see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Name, as in the feature and the memory file.
    pub name: &'static str,
    /// Rate at which SysTick counts on its processor clock source \[Hz\].
    pub systick_hz: u32,
}

#[cfg(all(feature = "board-mps2-an386", feature = "application"))]
pub use mps2_an386 as chosen;
#[cfg(all(feature = "board-mps2-an500", feature = "application"))]
pub use mps2_an500 as chosen;
#[cfg(all(feature = "board-stm32f405", feature = "application"))]
pub use stm32f405 as chosen;

/// The board this image is for.
pub const BOARD: Board = if cfg!(feature = "board-stm32f405") {
    stm32f405::BOARD
} else if cfg!(feature = "board-mps2-an500") {
    mps2_an500::BOARD
} else if cfg!(feature = "board-mps2-an505") {
    mps2_an505::BOARD
} else if cfg!(feature = "board-mps2-an385") {
    mps2_an385::BOARD
} else if cfg!(feature = "board-microbit") {
    microbit::BOARD
} else {
    mps2_an386::BOARD
};
